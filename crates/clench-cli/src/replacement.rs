//! Files that take the place of others when they are whole, and not before.

use anyhow::{Context, Result, ensure};
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// A file in the making. What stands at its path stays there until [`finish`](Self::finish), whatever happens in between; if
/// it is never called nothing is left.
pub(crate) enum Replacement {
    /// A temporary file beside the path, which it takes in the end.
    Beside { file: NamedTempFile, path: PathBuf },
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
        let prefix = format!(".{}.", name.to_string_lossy());
        let mut builder = Builder::new();
        builder.prefix(&prefix).suffix(".part");
        let file = readable(&mut builder).tempfile_in(folder)?;
        if let Some(permissions) = old {
            file.as_file().set_permissions(permissions)?;
        }
        Ok(Replacement::Beside { file, path })
    }

    /// What to write to.
    pub(crate) fn file(&self) -> io::Result<File> {
        match self {
            Replacement::Beside { file, .. } => file.as_file().try_clone(),
            Replacement::Direct(file) => file.try_clone(),
        }
    }

    /// Where it is written, if that is a file on a disk.
    #[cfg(feature = "render")]
    pub(crate) fn path(&self) -> Option<&Path> {
        match self {
            Replacement::Beside { file, .. } => Some(file.path()),
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
            Replacement::Beside { file, path } => {
                file.as_file().sync_all()?;
                file.persist(path)?;
                Ok(())
            }
        }
    }
}

/// Permissions of ordinary files, where temporary ones are their owner's alone.
#[cfg(unix)]
fn readable<'a, 'b, 'c>(builder: &'a mut Builder<'b, 'c>) -> &'a mut Builder<'b, 'c> {
    use std::os::unix::fs::PermissionsExt;
    // The process's mask takes away from this.
    builder.permissions(fs::Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn readable<'a, 'b, 'c>(builder: &'a mut Builder<'b, 'c>) -> &'a mut Builder<'b, 'c> {
    builder
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
