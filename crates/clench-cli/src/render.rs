//! `clench render`: pictures and films of a model, without a window.

use crate::limits::MemoryArguments;
use crate::message::tell;
use crate::options::ModelArguments;
use crate::replacement::{Replacement, require_other};
use crate::simulate::StartArguments;
use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use clench::{Model, Sim};
use clench_render::{Image, Picture, Renderer, View};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// Pictures a second of a film.
const RATE: f64 = 25.0;

/// Draws a model without a window: a picture (`.png`) of its initial state, or a film (`.gif`) of its motion. Cameras of the file are
/// honoured; without one all that moves is seen.
#[derive(Args)]
pub struct Arguments {
    /// Where to: `.png` or `.gif`
    #[arg(long, value_name = "OUT")]
    out: PathBuf,
    /// Pixels in a row
    #[arg(long, default_value_t = 640, value_name = "PIXELS")]
    width: u32,
    /// Rows of pixels
    #[arg(long, default_value_t = 480, value_name = "PIXELS")]
    height: u32,
    /// A camera of the model, by name or index
    #[arg(long, value_name = "C")]
    camera: Option<String>,
    /// Seconds to simulate before a picture is taken, or for which a film lasts [default: 0, or 2 of a film]
    #[arg(long, value_name = "SECONDS")]
    time: Option<f64>,

    #[command(flatten)]
    start: StartArguments,

    #[command(flatten)]
    memory: MemoryArguments,

    // Last, because its heading in the help holds for all that follows.
    #[command(flatten)]
    model: ModelArguments,
}

/// Draws what is asked for.
pub fn run(arguments: &Arguments) -> Result<ExitCode> {
    let (model, options) = arguments.model.load()?;
    let inputs = [
        ("the model", Some(arguments.model.file.model.as_path())),
        ("--states", arguments.start.states()),
    ];
    require_other(("--out", &arguments.out), &inputs)?;
    let starts = (arguments.start).starts(&model, 1, arguments.memory.limit())?;
    let mut sim = Sim::<f64>::with_options(Arc::clone(&model), options)?;
    starts.start(&mut sim)?;
    let camera = arguments
        .camera
        .as_ref()
        .map(|key| find_camera(&model, key));
    let picture = Picture {
        view: camera.transpose()?.map(View::Camera),
        ..Picture::new(arguments.width, arguments.height)
    };
    let film = match arguments.out.extension().and_then(|end| end.to_str()) {
        Some("png") => false,
        Some("gif") => true,
        _ => bail!(
            "--out {}: the name must end in .png or .gif",
            arguments.out.display()
        ),
    };
    let time = arguments.time.unwrap_or(if film { 2.0 } else { 0.0 });
    ensure!(
        (0.0..=3600.0).contains(&time),
        "--time: {time} is not between 0 and 3600 s"
    );
    let file = Replacement::begin(&arguments.out).with_context(|| context(&arguments.out))?;
    let mut renderer = Renderer::new(&model)?;
    let mut camera = Camera {
        renderer: &mut renderer,
        picture,
    };
    let written = match film {
        false => {
            advance(&mut sim, time)?;
            let image = camera.take(&mut sim)?;
            write_png(file.file()?, &image)
        }
        true => write_gif(file.file()?, &mut sim, &mut camera, time),
    };
    written.with_context(|| context(&arguments.out))?;
    file.finish().with_context(|| context(&arguments.out))?;
    tell(format_args!("drawn by {}", renderer.device()));
    Ok(ExitCode::SUCCESS)
}

fn context(path: &Path) -> String {
    format!("--out {}", path.display())
}

/// A renderer that takes pictures of one kind.
struct Camera<'a> {
    renderer: &'a mut Renderer,
    picture: Picture,
}

impl Camera<'_> {
    fn take(&mut self, sim: &mut Sim<f64>) -> Result<Image> {
        Ok(self.renderer.draw(sim, &self.picture)?)
    }
}

/// Steps up to a time.
fn advance(sim: &mut Sim<f64>, time: f64) -> Result<()> {
    let timestep = sim.params().timestep;
    while sim.state.time + 0.5 * timestep < time {
        sim.step()?;
    }
    Ok(())
}

fn write_png(to: impl Write, image: &Image) -> Result<()> {
    let mut encoder =
        png::Encoder::new(BufWriter::new(to), image.width as u32, image.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&image.rgb)?;
    writer.finish()?;
    Ok(())
}

/// Writes a film that repeats; each of its pictures has colours of its own.
fn write_gif(to: impl Write, sim: &mut Sim<f64>, camera: &mut Camera, time: f64) -> Result<()> {
    let side =
        |pixels: u32| u16::try_from(pixels).context("a film has at most 65535 pixels a side");
    let (width, height) = (side(camera.picture.width)?, side(camera.picture.height)?);
    let mut encoder = gif::Encoder::new(BufWriter::new(to), width, height, &[])?;
    encoder.set_repeat(gif::Repeat::Infinite)?;
    for k in 0..=(time * RATE) as usize {
        advance(sim, k as f64 / RATE)?;
        let image = camera.take(sim)?;
        let mut frame = gif::Frame::from_rgb_speed(width, height, &image.rgb, 10);
        frame.delay = (100.0 / RATE) as u16;
        encoder.write_frame(&frame)?;
    }
    encoder.into_inner()?.flush()?;
    Ok(())
}

/// The camera of a name or an index.
fn find_camera(model: &Model, key: &str) -> Result<usize> {
    let cameras = &model.cameras;
    if let Some(index) = cameras.iter().position(|camera| camera.name == key) {
        return Ok(index);
    }
    match key.parse() {
        Ok(index) if index < cameras.len() => Ok(index),
        _ => {
            let names: Vec<_> = cameras.iter().map(|camera| camera.name.as_str()).collect();
            let count = names.len();
            bail!(
                "--camera {key}: not a name or an index of the model's {count} cameras ({})",
                names.join(", ")
            )
        }
    }
}
