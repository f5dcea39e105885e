//! Files that take the place of others when they are whole, and not before.

use anyhow::{Context, Result, ensure};
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::process;

/// A file in the making. What stands at its path stays there until [`finish`](Self::finish), whatever happens in between; if
/// it is never called nothing is left.
pub(crate) enum Replacement {
    /// A temporary file beside the path, which it takes in the end.
    Beside { part: Part, path: PathBuf },
    /// What is no file on a disk, such as a pipe, has no contents that could be kept, and cannot be replaced.
    Direct(File),
}

impl Replacement {
    /// Begins a file for `path`. A link there stays, and what it leads to is replaced.
    ///
    /// # Errors
    /// A path at which no file can be made, or one that must not be written.
    pub(crate) fn begin(path: &Path) -> io::Result<Self> {
        let (path, old) = match fs::canonicalize(path) {
            Ok(path) => {
                // Replacing asks nothing of the old file, but one that is protected is so for a reason.
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
        Ok(Replacement::Beside { part, path })
    }

    /// What to write to.
    pub(crate) fn file(&self) -> io::Result<File> {
        match self {
            Replacement::Beside { part, .. } => part.file.try_clone(),
            Replacement::Direct(file) => file.try_clone(),
        }
    }

    /// Where it is written, if that is a file on a disk.
    #[cfg(feature = "render")]
    pub(crate) fn path(&self) -> Option<&Path> {
        match self {
            Replacement::Beside { part, .. } => Some(&part.path),
            Replacement::Direct(_) => None,
        }
    }

    /// Puts the file in its place, once all of it is on the disk.
    ///
    /// # Errors
    /// A disk that cannot take it; the old file is then as it was.
    pub(crate) fn finish(self) -> io::Result<()> {
        match self {
            Replacement::Direct(_) => Ok(()),
            Replacement::Beside { part, path } => {
                part.file.sync_all()?;
                part.rename(&path)
            }
        }
    }
}

/// A file that goes away with this, or when the next one is made for its path if the program is killed: it is locked as long as its
/// program runs.
pub(crate) struct Part {
    file: File,
    /// Empty once there is nothing to remove.
    path: PathBuf,
}

impl Part {
    /// An empty file of a name that no other has, with the permissions of ordinary files.
    fn create(folder: &Path, name: &OsStr) -> io::Result<Self> {
        let start = format!(".{}.", name.to_string_lossy());
        remove_abandoned(folder, &start);
        let process = process::id();
        let mut attempt = 0_u32;
        loop {
            let path = folder.join(format!("{start}{process}-{attempt}{PART}"));
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                // Another program may have taken it for abandoned before it was locked.
                Ok(file) => match file.try_lock() {
                    Err(TryLockError::WouldBlock) => attempt += 1,
                    // There are disks that know no locks.
                    _ if path.exists() => return Ok(Part { file, path }),
                    _ => attempt += 1,
                },
                Err(error) if error.kind() == ErrorKind::AlreadyExists => attempt += 1,
                Err(error) => return Err(error),
            }
        }
    }

    /// Gives it another name, at which it stays.
    fn rename(mut self, path: &Path) -> io::Result<()> {
        fs::rename(&self.path, path)?;
        self.path.clear();
        Ok(())
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        // Where it cannot be removed it stays, under a name that tells what it is.
        let _ = fs::remove_file(&self.path);
    }
}

/// What the names of parts end with.
const PART: &str = ".part";

/// Removes parts whose names start so and whose programs were killed: nobody locks them.
fn remove_abandoned(folder: &Path, start: &str) {
    // What cannot be looked at or removed stays.
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_part = name.starts_with(start) && name.ends_with(PART);
        if is_part && File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Refuses an output that is one of the inputs, be it through links; each path with what gives it.
///
/// # Errors
/// The first input that is the output.
pub(crate) fn require_other(output: (&str, &Path), inputs: &[(&str, Option<&Path>)]) -> Result<()> {
    let (flag, path) = output;
    // An output that does not exist yet is no input.
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
