//! A directory of files for one test, which is removed at its end. The model is called `main.xml`.

use clench_formats::{LoadError, read};
use clench_rigid::builder::ModelBuilder;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

pub struct Files(PathBuf);

impl Files {
    /// Writes files with these names, which may contain directories, and contents.
    pub fn new(files: &[(&str, &str)]) -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let root =
            std::env::temp_dir().join(format!("clench-files-{}-{number}", std::process::id()));
        for (name, content) in files {
            let path = root.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, content).unwrap();
        }
        Files(root)
    }

    pub fn read(&self) -> Result<ModelBuilder, LoadError> {
        read(self.0.join("main.xml"))
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
