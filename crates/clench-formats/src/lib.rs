//! clench-formats
