//! NumPy files.

use crate::files;
use clench_cli::limits::MemoryLimit;
use clench_cli::npy::read_rows;

/// Reads controls of several widths from a file.
pub fn npy(data: &[u8]) -> bool {
    let path = files::write("ctrl.npy", data);
    let mut accepted = false;
    for width in [0, 3] {
        if let Ok(rows) = read_rows("--ctrl", &path, width, MemoryLimit::default()) {
            assert_eq!(rows.values().len(), rows.count() * width);
            assert!(rows.values().iter().all(|x| x.is_finite()));
            accepted = true;
        }
    }
    accepted
}
