//! The `clench` program.
fn main() {}
