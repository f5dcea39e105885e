//! `clench simulate --record` killed by `kill -9` at any moment: either the previous recording or the new one is
//! complete.
//!
//! The short form is an ordinary test; `cargo xtask soak --only recordings` runs the long one.

use crate::program::{folder, model, simulation};
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;
use std::process::{Child, Stdio};
use std::thread;
use std::time::Instant;

/// The number of rows of the previous recording.
const OLD: u64 = 10;

fn record(path: &Path, steps: u64) -> Child {
    let words = format!("--steps {steps}");
    simulation(&model("pendulum"), &words, &[("--record", path)])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program can be run")
}

fn record_all(path: &Path, steps: u64) {
    let status = record(path, steps).wait().expect("the run ends");
    assert!(status.success());
    assert_eq!(rows(path), steps);
}

/// Returns the rows of a recording; all arrays must be readable.
fn rows(path: &Path) -> u64 {
    let file = File::open(path).expect("the record is there");
    let mut archive = zip::ZipArchive::new(file).expect("a whole archive");
    let mut rows = Vec::new();
    for index in 0..archive.len() {
        let mut bytes = Vec::new();
        let mut entry = archive.by_index(index).expect("an array");
        entry
            .read_to_end(&mut bytes)
            .expect("its checksum is right");
        let array = npyz::NpyFile::new(&bytes[..]).expect("an array");
        rows.push(array.shape()[0]);
    }
    let first = *rows.first().expect("arrays");
    assert!(rows.iter().all(|&count| count == first), "{rows:?}");
    first
}

/// Kills `times` runs of `steps` steps, at moments spread over the duration of a complete one.
fn kill(times: u32, steps: u64) {
    let folder = folder();
    let path = folder.path().join("run.npz");
    let begin = Instant::now();
    record_all(&path, steps);
    let whole = begin.elapsed();
    record_all(&path, OLD);
    let (mut kept, mut replaced) = (0, 0);
    for time in 0..times {
        let mut child = record(&path, steps);
        thread::sleep(whole * time / times);
        // An error means that it has ended already.
        let _ = child.kill();
        child.wait().expect("the run ends");
        match rows(&path) {
            OLD => kept += 1,
            found => {
                assert_eq!(found, steps, "neither the old record nor the new one");
                replaced += 1;
                record_all(&path, OLD);
            }
        }
    }
    println!(
        "{times} runs of {whole:?} killed: {kept} times the old record is there, {replaced} times the new one"
    );
    assert!(kept > 0, "none was ended before its end");
    record_all(&path, OLD);
    let files = fs::read_dir(folder.path()).expect("the folder is there");
    let names = Vec::from_iter(files.map(|file| file.expect("it can be read").file_name()));
    assert_eq!(names, ["run.npz"], "a killed run left something");
}

#[test]
fn a_killed_recording_leaves_the_old_file_or_the_new_one_whole() {
    kill(8, 20_000);
}

#[test]
#[ignore = "takes minutes: cargo xtask soak --only recordings"]
fn long() {
    let scale = std::env::var("SOAK_SCALE").unwrap_or("1".into());
    let scale: u32 = scale.parse().expect("SOAK_SCALE is a whole number");
    kill(1_000 / scale, 200_000);
}
