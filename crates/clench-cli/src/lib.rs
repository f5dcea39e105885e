//! What the `clench` program reads and writes besides models: NumPy's files and the JSON of states and results. A library, so
//! that the fuzz targets reach its readers; with the bounds that they keep to.

#![deny(unreachable_pub)]

pub mod limits;
pub mod npy;
pub mod protocol;
mod zip;
