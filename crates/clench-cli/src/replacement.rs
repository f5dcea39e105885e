//! Files that replace existing ones atomically when they are complete.

use anyhow::{Context, Result, ensure};
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::process;

/// A file under construction. An existing file at its path stays until [`finish`](Self::finish); without that call
/// nothing is left behind.
pub(crate) enum Replacement {
    /// A temporary file in the folder of the path, to which it is renamed at the end.
    Temporary { part: Part, path: PathBuf },
    /// A destination that is not a regular file, such as a pipe, and cannot be replaced.
    Direct(File),
}

impl Replacement {
    /// Begins a file for `path`. A symbolic link stays, and its target is replaced.
    ///
    /// # Errors
    /// Returns an error if no file can be created at the path, or the existing one is write-protected.
    pub(crate) fn begin(path: &Path) -> io::Result<Self> {
        let (path, old) = match fs::canonicalize(path) {
            Ok(path) => {
                // Renaming would ignore the write protection of the old file, so check it here.
                let file = OpenOptions::new().write(true).open(&path)?;
                let metadata = file.metadata()?;
                if !metadata.is_file() {
                    return Ok(Replacement::Direct(file));
                }
                (path, Some(metadata.permissions()))
            }
            Err(error) if error.kind() == ErrorKind::NotFound => (path.to_path_buf(), None),
            Err(error) => return Err(error),
        };
        let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else {
            return Err(ErrorKind::IsADirectory.into());
        };
        let here = Path::new(".");
        let folder = if folder.as_os_str().is_empty() {
            here
        } else {
            folder
        };
        let part = Part::create(folder, name)?;
        if let Some(permissions) = old {
            part.file.set_permissions(permissions)?;
        }
        Ok(Replacement::Temporary { part, path })
    }

    /// Returns the file to write to.
    pub(crate) fn file(&self) -> io::Result<File> {
        match self {
            Replacement::Temporary { part, .. } => part.file.try_clone(),
            Replacement::Direct(file) => file.try_clone(),
        }
    }

    /// Returns the path that is written to, if it is a regular file.
    #[cfg(feature = "render")]
    pub(crate) fn path(&self) -> Option<&Path> {
        match self {
            Replacement::Temporary { part, .. } => Some(&part.path),
            Replacement::Direct(_) => None,
        }
    }

    /// Renames the file to its path after all data are on the disk.
    ///
    /// # Errors
    /// Returns an error if writing fails; the old file is then unchanged.
    pub(crate) fn finish(self) -> io::Result<()> {
        match self {
            Replacement::Direct(_) => Ok(()),
            Replacement::Temporary { part, path } => {
                part.file.sync_all()?;
                part.rename(&path)
            }
        }
    }
}

/// A temporary file that is removed on drop or, if the program is killed, when the next one is created for its path: it
/// is locked while its program runs.
pub(crate) struct Part {
    file: File,
    /// The path; empty if there is nothing to remove.
    path: PathBuf,
}

impl Part {
    /// Creates an empty file with a unique name and the permissions of ordinary files.
    fn create(folder: &Path, name: &OsStr) -> io::Result<Self> {
        // The end of a long name is omitted, because file systems limit names to 255 bytes.
        let name: String = name.to_string_lossy().chars().take(MAX_START).collect();
        let start = format!(".{name}.");
        remove_abandoned(folder, &start);
        let process = process::id();
        let mut attempt = 0_u32;
        loop {
            let path = folder.join(format!("{start}{process}-{attempt}{PART}"));
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                // Another program may have removed it as abandoned before it was locked.
                Ok(file) => match file.try_lock() {
                    Err(TryLockError::WouldBlock) => attempt += 1,
                    // Some file systems do not support locks.
                    _ if path.exists() => return Ok(Part { file, path }),
                    _ => attempt += 1,
                },
                Err(error) if error.kind() == ErrorKind::AlreadyExists => attempt += 1,
                Err(error) => return Err(error),
            }
        }
    }

    /// Renames the file and keeps it on drop.
    fn rename(mut self, path: &Path) -> io::Result<()> {
        fs::rename(&self.path, path)?;
        self.path.clear();
        Ok(())
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        // If it cannot be removed, its name identifies it as temporary.
        let _ = fs::remove_file(&self.path);
    }
}

/// The number of characters of a name with which the name of its temporary file starts.
const MAX_START: usize = 50;
/// The suffix of temporary files.
const PART: &str = ".part";

/// Removes unlocked temporary files with this prefix, whose programs were killed.
fn remove_abandoned(folder: &Path, start: &str) {
    // Skips files that cannot be opened or removed.
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_part = name.starts_with(start) && name.ends_with(PART);
        if is_part && File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Rejects an output that is also an input, possibly through links; each path comes with its flag.
///
/// # Errors
/// Returns an error that names the first input that is the output.
pub(crate) fn require_other(output: (&str, &Path), inputs: &[(&str, Option<&Path>)]) -> Result<()> {
    let (flag, path) = output;
    // An output that does not exist yet cannot be an input.
    let Ok(place) = fs::canonicalize(path) else {
        return Ok(());
    };
    for &(input, from) in inputs {
        let Some(from) = from else { continue };
        let found =
            fs::canonicalize(from).with_context(|| format!("{input} {}", from.display()))?;
        ensure!(
            found != place,
            "{flag} {}: this is the file that {input} reads",
            path.display()
        );
    }
    Ok(())
}
