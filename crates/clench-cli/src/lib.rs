//! What the `clench` program reads and writes besides models: NumPy's files and the JSON of states and results. A library, so
//! that the fuzz targets reach its readers.

pub mod npy;
pub mod protocol;
