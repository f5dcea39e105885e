//! `clench render`: images and videos of a model, without a window.

#[cfg(feature = "render")]
mod draw;

use crate::limits::MemoryArguments;
use crate::options::ModelArguments;
use crate::simulate::StartArguments;
use clap::Args;
use std::path::PathBuf;

/// Draws a model without a window: a picture (`.png`) of its initial state, or a film (`.gif`, or `.mp4` by the program
/// ffmpeg) of its motion. Cameras of the file are honoured; without one all that moves is seen.
#[derive(Args)]
pub(crate) struct Arguments {
    /// File to write: `.png`, `.gif` or `.mp4`
    #[arg(long, value_name = "OUT")]
    pub(super) out: PathBuf,
    /// Pixels in a row
    #[arg(long, default_value_t = 640, value_name = "PIXELS")]
    pub(super) width: u32,
    /// Rows of pixels
    #[arg(long, default_value_t = 480, value_name = "PIXELS")]
    pub(super) height: u32,
    /// A camera of the model, by name or index
    #[arg(long, value_name = "C")]
    pub(super) camera: Option<String>,
    /// Seconds to simulate before a picture is taken, or for which a film lasts [default: 0, or 2 of a film]
    #[arg(long, value_name = "SECONDS")]
    pub(super) time: Option<f64>,

    #[command(flatten)]
    pub(super) start: StartArguments,

    #[command(flatten)]
    pub(super) memory: MemoryArguments,

    // Last, because its help heading applies to all following arguments.
    #[command(flatten)]
    pub(super) model: ModelArguments,
}

#[cfg(feature = "render")]
pub(crate) use draw::run;

/// Returns an error that explains how to build with rendering.
#[cfg(not(feature = "render"))]
pub(crate) fn run(_: &Arguments) -> anyhow::Result<std::process::ExitCode> {
    Err(crate::without("render", "draws pictures and films"))
}
