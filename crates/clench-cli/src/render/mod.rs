//! `clench render`: images and videos of a model, without a window.

#[cfg(feature = "render")]
mod draw;

use crate::limits::MemoryArguments;
use crate::options::ModelArguments;
use crate::simulate::StartArguments;
use clap::Args;
use std::path::PathBuf;

/// Renders a model without a window: an image (`.png`) of its initial state, or a video (`.gif`, or `.mp4` by the
/// program ffmpeg) of its motion. Without `--camera`, the view covers all bodies that move.
#[derive(Args)]
pub(crate) struct Arguments {
    /// File to write: `.png`, `.gif` or `.mp4`
    #[arg(long, value_name = "OUT")]
    pub(super) out: PathBuf,
    /// Width of the image
    #[arg(long, default_value_t = 640, value_name = "PIXELS")]
    pub(super) width: u32,
    /// Height of the image
    #[arg(long, default_value_t = 480, value_name = "PIXELS")]
    pub(super) height: u32,
    /// A camera of the model, by name or index
    #[arg(long, value_name = "C")]
    pub(super) camera: Option<String>,
    /// Seconds to simulate before an image, or duration of a video [default: 0, or 2 for a video]
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
    Err(crate::without("render", "renders images and videos"))
}
