//! Pictures and films from a program that can draw. Without a device that draws, these tests print that and check
//! nothing else.
#![cfg(all(feature = "render", unix))]

#[path = "suite/program/mod.rs"]
mod program;

use program::{code, command, errors, folder};
use std::fs::{self, File};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

/// A red ball that falls through the picture of a static camera.
const BALL: &str =
    "<mujoco><worldbody><camera name='front' pos='0 -3 0' xyaxes='1 0 0 0 0 1' fovy='40'/>
    <body pos='0 0 .8'><freejoint/><geom size='.2' rgba='1 0 0 1'/></body></worldbody>
    <keyframe><key name='late' time='50'/></keyframe></mujoco>";

fn draw(folder: &Path, words: &str) -> Command {
    let model = folder.join("ball.xml");
    fs::write(&model, BALL).unwrap();
    let mut command = command("render");
    command.arg(model).current_dir(folder);
    command.args("--width 60 --height 48 --camera front".split(' '));
    command.args(words.split(' '));
    command
}

/// Returns the output, or `None` if nothing can draw here.
fn output(mut command: Command) -> Option<Output> {
    let wish = std::env::var("CLENCH_GPU").unwrap_or_default();
    if wish == "skip" {
        return None;
    }
    let done = command.output().unwrap();
    if wish != "require" && errors(&done).contains("no device to render on") {
        eprintln!("skipped: {}", errors(&done));
        return None;
    }
    Some(done)
}

/// Returns the mean row of the red pixels in a picture of 60 pixels per row.
fn height(rgb: &[u8]) -> f64 {
    let pixels = rgb.as_chunks::<3>().0.iter().enumerate();
    let red = pixels.filter(|(_, pixel)| pixel[0] > 90 && pixel[1] < 60);
    let rows: Vec<f64> = red.map(|(k, _)| (k / 60) as f64).collect();
    rows.iter().sum::<f64>() / rows.len() as f64
}

/// Returns the row of the ball, which has fallen 4.905 t² metres at time t.
fn expected(time: f64) -> f64 {
    let z = 0.8 - 4.905 * time * time;
    24.0 - 24.0 * z / (3.0 * 20f64.to_radians().tan())
}

/// Returns the mean row of the red pixels of a picture in a file.
fn height_in(path: &Path) -> f64 {
    let decoder = png::Decoder::new(std::io::BufReader::new(File::open(path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((frame.width, frame.height), (60, 48));
    height(&pixels)
}

/// Also holds if the simulation time starts later.
#[test]
fn an_image_is_taken_after_the_requested_time() {
    let folder = folder();
    for start in ["", " --keyframe late"] {
        let words = format!("--time 0.4 --out ball.png{start}");
        let Some(done) = output(draw(folder.path(), &words)) else {
            return;
        };
        assert_eq!(code(&done), 0, "{}", errors(&done));
        let found = height_in(&folder.path().join("ball.png"));
        assert!(
            (found - expected(0.4)).abs() < 1.0,
            "{found}, not {}",
            expected(0.4)
        );
    }
}

#[test]
fn a_gif_shows_the_motion_in_real_time() {
    let folder = folder();
    let Some(done) = output(draw(folder.path(), "--time 0.4 --out ball.gif")) else {
        return;
    };
    assert_eq!(code(&done), 0, "{}", errors(&done));
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut film = options
        .read_info(File::open(folder.path().join("ball.gif")).unwrap())
        .unwrap();
    assert_eq!((film.width(), film.height()), (60, 48));
    let mut time = 0.0;
    let mut frames = 0;
    while let Some(frame) = film.read_next_frame().unwrap() {
        let pixels = frame.buffer.as_chunks::<4>().0.iter();
        let rgb: Vec<u8> = pixels.flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        let found = height(&rgb);
        assert!(
            (found - expected(time)).abs() < 1.5,
            "{time} s: {found}, not {}",
            expected(time)
        );
        time += 0.01 * f64::from(frame.delay);
        frames += 1;
    }
    assert_eq!(frames, 11);
}

/// Writes a substitute for ffmpeg that stores its arguments and its input instead of making a film.
fn stand_in(folder: &Path, script: &str) -> String {
    let path = folder.join("ffmpeg");
    fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    let others = std::env::var("PATH").unwrap_or_default();
    format!("{}:{others}", folder.display())
}

#[test]
fn an_encoder_receives_the_images_of_a_video() {
    let folder = folder();
    let script = "echo \"$@\" > arguments; for last; do :; done; cat > \"$last\"";
    let mut film = draw(folder.path(), "--time 0.2 --out ball.mp4");
    film.env("PATH", stand_in(folder.path(), script));
    let Some(done) = output(film) else { return };
    assert_eq!(code(&done), 0, "{}", errors(&done));
    let arguments = fs::read_to_string(folder.path().join("arguments")).unwrap();
    for words in ["-f rawvideo", "-pix_fmt rgb24", "-s 60x48", "-r 30", "-i -"] {
        assert!(arguments.contains(words), "{arguments}");
    }
    let pictures = fs::read(folder.path().join("ball.mp4")).unwrap();
    let pictures: Vec<&[u8]> = pictures.chunks(3 * 60 * 48).collect();
    assert_eq!(pictures.len(), 7);
    for (k, picture) in pictures.iter().enumerate() {
        let time = k as f64 / 30.0;
        let found = height(picture);
        assert!((found - expected(time)).abs() < 1.0, "{time} s: {found}");
    }
}

#[test]
fn errors_of_an_encoder_are_reported_and_the_old_video_stays() {
    let folder = folder();
    fs::write(folder.path().join("ball.mp4"), "old").unwrap();
    let mut film = draw(folder.path(), "--time 0.2 --out ball.mp4");
    let script = "echo 'no such encoder' >&2; exit 1";
    film.env("PATH", stand_in(folder.path(), script));
    let Some(done) = output(film) else { return };
    assert_ne!(code(&done), 0);
    let said = errors(&done);
    assert!(
        said.contains("ball.mp4") && said.contains("no such encoder"),
        "{said}"
    );
    assert_eq!(fs::read(folder.path().join("ball.mp4")).unwrap(), b"old");
    // Without ffmpeg the message names the package to install.
    let mut film = draw(folder.path(), "--time 0.2 --out ball.mp4");
    film.env("PATH", "/nowhere");
    let done = output(film).unwrap();
    assert!(
        errors(&done).contains("apt-get install ffmpeg"),
        "{}",
        errors(&done)
    );
}

/// The simulation resets whenever it diverges, after a second.
#[test]
fn a_video_of_a_simulation_with_autoreset_ends() {
    let folder = folder();
    let command = draw(folder.path(), "--time 3 --out ball.gif");
    let option = "<option gravity='0 0 -9e9'><flag autoreset='enable'/></option>";
    let falls_fast = BALL.replace("<mujoco>", &format!("<mujoco>{option}"));
    fs::write(folder.path().join("ball.xml"), falls_fast).unwrap();
    let Some(done) = output(command) else {
        return;
    };
    assert_eq!(code(&done), 0, "{}", errors(&done));
}
