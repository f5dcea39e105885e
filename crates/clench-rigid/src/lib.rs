//! clench-rigid
