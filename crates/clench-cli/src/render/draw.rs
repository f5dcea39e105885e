//! Rendering of images and videos.

use super::Arguments;
use crate::interrupt::Interrupt;
use crate::limits::steps_in;
use crate::message::print_message;
use crate::replacement::{Replacement, require_other};
use anyhow::{Context, Result, anyhow, bail, ensure};
use clench::{Model, Sim};
use clench_render::{Image, Picture, Renderer, View};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};
use std::sync::Arc;

/// Renders the requested image or video.
pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
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
        views: vec![camera.transpose()?.map_or(View::All, View::Camera)],
        ..Picture::new(arguments.width, arguments.height)
    };
    let form = match arguments.out.extension().and_then(|end| end.to_str()) {
        Some("png") => Form::Png,
        Some("gif") => Form::Gif,
        Some("mp4") => Form::Mp4,
        _ => bail!(
            "--out {}: the name must end in .png, .gif or .mp4",
            arguments.out.display()
        ),
    };
    let time = match (arguments.time, form) {
        (Some(time), _) => time,
        (None, Form::Png) => 0.0,
        (None, Form::Gif | Form::Mp4) => 2.0,
    };
    ensure!(
        (0.0..=3600.0).contains(&time),
        "--time: {time} is not between 0 and 3600 s"
    );
    steps_in(time, sim.params().timestep)?;
    let mut motion = Motion {
        sim,
        steps: 0,
        interrupt: Interrupt::listen()?,
    };
    let file = Replacement::begin(&arguments.out).with_context(|| context(&arguments.out))?;
    let mut renderer = Renderer::new(&model)?;
    let mut camera = Camera {
        renderer: &mut renderer,
        picture,
    };
    let written = match form {
        Form::Png => {
            motion.advance(time)?;
            let image = camera.draw(&mut motion.sim)?;
            write_png(file.file()?, &image)
        }
        Form::Gif => write_gif(file.file()?, &mut motion, &mut camera, time),
        Form::Mp4 => write_mp4(&file, &mut motion, &mut camera, time),
    };
    written.with_context(|| context(&arguments.out))?;
    file.finish().with_context(|| context(&arguments.out))?;
    print_message(format_args!("drawn by {}", renderer.device()));
    Ok(ExitCode::SUCCESS)
}

/// The format of a file.
#[derive(Clone, Copy)]
enum Form {
    Png,
    Gif,
    Mp4,
}

fn context(path: &Path) -> String {
    format!("--out {}", path.display())
}

/// A renderer with fixed image settings.
struct Camera<'a> {
    renderer: &'a mut Renderer,
    picture: Picture,
}

impl Camera<'_> {
    fn draw(&mut self, sim: &mut Sim<f64>) -> Result<Image> {
        Ok(self.renderer.draw(sim, &self.picture)?)
    }
}

/// A simulation with a counter of its steps: its own time may start at another value, and restart.
struct Motion {
    sim: Sim<f64>,
    steps: usize,
    interrupt: Interrupt,
}

impl Motion {
    /// Steps until `time` seconds have passed since the start.
    ///
    /// # Errors
    /// Returns an error if a step fails or a signal requests termination.
    fn advance(&mut self, time: f64) -> Result<()> {
        let steps = steps_in(time, self.sim.params().timestep)?;
        while self.steps < steps {
            self.sim.step()?;
            self.steps += 1;
            if let Some(signal) = self.interrupt.signal() {
                bail!("interrupted by {}", signal.name);
            }
        }
        Ok(())
    }
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

/// Renders a motion at `rate` images per second.
fn render_frames(
    motion: &mut Motion,
    camera: &mut Camera,
    time: f64,
    rate: f64,
    mut show: impl FnMut(Image) -> Result<()>,
) -> Result<()> {
    for k in 0..=(time * rate) as usize {
        motion.advance(k as f64 / rate)?;
        show(camera.draw(&mut motion.sim)?)?;
    }
    Ok(())
}

/// The frame rate of a GIF, which counts hundredths of a second.
const GIF_RATE: f64 = 25.0;

/// Writes a video that repeats; each of its images has its own palette.
fn write_gif(to: impl Write, motion: &mut Motion, camera: &mut Camera, time: f64) -> Result<()> {
    let side =
        |pixels: u32| u16::try_from(pixels).context("a GIF has at most 65535 pixels per side");
    let (width, height) = (side(camera.picture.width)?, side(camera.picture.height)?);
    let mut encoder = gif::Encoder::new(BufWriter::new(to), width, height, &[])?;
    encoder.set_repeat(gif::Repeat::Infinite)?;
    render_frames(motion, camera, time, GIF_RATE, |image| {
        let mut frame = gif::Frame::from_rgb_speed(width, height, &image.rgb, 10);
        frame.delay = (100.0 / GIF_RATE) as u16;
        Ok(encoder.write_frame(&frame)?)
    })?;
    encoder.into_inner()?.flush()?;
    Ok(())
}

/// The frame rate of an MP4.
const MP4_RATE: f64 = 30.0;

/// Writes a video by ffmpeg, which receives the raw images and selects the encoder.
fn write_mp4(to: &Replacement, motion: &mut Motion, camera: &mut Camera, time: f64) -> Result<()> {
    let Some(path) = to.path() else {
        bail!("an .mp4 must be a regular file");
    };
    let Picture { width, height, .. } = camera.picture;
    let mut encoder = Command::new("ffmpeg")
        .args(["-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24"])
        .args(["-s", &format!("{width}x{height}"), "-r", &MP4_RATE.to_string(), "-i", "-"])
        // Common players require sides of even length and subsampled colours.
        .args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"])
        .args(["-movflags", "+faststart", "-f", "mp4"])
        .arg(path)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| match error.kind() {
            ErrorKind::NotFound => anyhow!(
                "an .mp4 is encoded by the program ffmpeg, which is not installed: install it, on Debian with \
                 `apt-get install ffmpeg`, or write a .gif"
            ),
            _ => anyhow!("ffmpeg: {error}"),
        })?;
    let mut pictures = encoder.stdin.take();
    let shown = render_frames(motion, camera, time, MP4_RATE, |image| {
        let written = pictures.as_mut().map(|to| to.write_all(&image.rgb));
        Ok(written.transpose().map(drop)?)
    });
    drop(pictures);
    let done = encoder.wait_with_output()?;
    let said = String::from_utf8_lossy(&done.stderr).trim().to_owned();
    ensure!(done.status.success(), "ffmpeg: {said}");
    shown
}

/// Finds a camera by name or index.
fn find_camera(model: &Model, key: &str) -> Result<usize> {
    let cameras = &model.cameras;
    if let Some(index) = cameras.iter().position(|camera| camera.name == key) {
        return Ok(index);
    }
    match key.parse() {
        Ok(index) if index < cameras.len() => Ok(index),
        _ if cameras.is_empty() => bail!("--camera {key}: the model has no cameras"),
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
