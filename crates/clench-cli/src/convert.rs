//! `clench convert`: a model as MJCF.

use crate::options::ModelFile;
use crate::replacement::{Replacement, require_other};
use anyhow::{Context, Result, ensure};
use clap::Args;
use clench::SaveModel;
use std::io::Write;
use std::path::PathBuf;

/// Writes a model as a self-contained MJCF file: every number resolved, explicit inertials, meshes and height
/// fields in the file. It loads to the same model, here and in MuJoCo.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    model: ModelFile,
    /// The file to write
    output: PathBuf,
}

/// Reads one file and writes the other.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let path = &arguments.output;
    ensure!(
        !path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("urdf")),
        "OUTPUT {}: convert writes MJCF, not URDF; name a file such as robot.xml",
        path.display()
    );
    require_other(("OUTPUT", path), &[("MODEL", Some(&arguments.model.model))])?;
    let text = arguments.model.load()?.to_mjcf()?;
    let cannot = || format!("cannot write {}", path.display());
    let replacement = Replacement::begin(path).with_context(cannot)?;
    let mut file = replacement.file().with_context(cannot)?;
    file.write_all(text.as_bytes()).with_context(cannot)?;
    replacement.finish().with_context(cannot)
}
