//! clench-solver
