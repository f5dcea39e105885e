//! Small files and short arguments that request too much: a message names the limit and the excess.

use crate::program::{code, driven, errors, folder, header, model, npy, refused, simulate};
use std::fs::File;
use std::path::Path;
use std::time::Instant;

fn with_ctrl(path: &Path, words: &str) -> std::process::Output {
    let model = driven(path.parent().expect("it is in a folder"));
    simulate(&model, words, &[("--ctrl", path)])
}

#[test]
fn a_header_of_four_gigabytes_is_not_read() {
    let folder = folder();
    let path = folder.path().join("long.npy");
    npy(&path, 2, &header(1, 1), Some(u32::MAX), &[0.0]);
    refused(
        &with_ctrl(&path, ""),
        &["long.npy", "header", "4294967295", "10000"],
    );
}

#[test]
fn nested_brackets_are_rejected() {
    let folder = folder();
    let path = folder.path().join("deep.npy");
    let begin = Instant::now();
    let nested = format!("{{'shape': {}1{}}}", "(".repeat(30), ")".repeat(30));
    for (header, complaint) in [("[".repeat(40), "dictionary"), (nested, "tuple")] {
        npy(&path, 1, &header, None, &[]);
        refused(&with_ctrl(&path, ""), &["deep.npy", complaint]);
    }
    assert!(begin.elapsed().as_secs() < 10);
}

#[test]
fn an_array_is_as_large_as_memory_may_be() {
    let folder = folder();
    let path = folder.path().join("large.npy");
    npy(&path, 1, &header(10_000_000_000, 1), None, &[]);
    let file = File::options().write(true).open(&path).unwrap();
    file.set_len(80_000_000_200).unwrap(); // A hole, not bytes on the disk.
    refused(
        &with_ctrl(&path, ""),
        &["large.npy", "80.000 GB", "4 GB", "--max-memory"],
    );
    npy(&path, 1, &header(1000, 1), None, &[0.0; 1000]);
    refused(
        &with_ctrl(&path, "--max-memory 1e-6"),
        &["8.00e-6 GB", "0.000001 GB", "--max-memory"],
    );
    let done = with_ctrl(&path, "--steps 3");
    assert_eq!(code(&done), 0, "{}", errors(&done));
}

#[test]
fn a_record_is_as_large_as_memory_may_be() {
    let folder = folder();
    let path = folder.path().join("out.npz");
    for words in [
        "--steps 1000000000000",
        "--steps 1000000000000 --envs 2",
        "--steps 100000 --max-memory 1e-5",
    ] {
        let done = simulate(&model("pendulum"), words, &[("--record", &path)]);
        refused(
            &done,
            &[
                "--record",
                "out.npz",
                "rows",
                "GB",
                "--max-memory",
                "--every",
            ],
        );
        assert!(!path.exists());
    }
}

#[test]
fn a_billion_steps_need_an_explicit_flag() {
    let done = simulate(&model("pendulum"), "--timestep 1e-300", &[]);
    refused(&done, &["1e-300", "1.000e300 steps", "--steps", "--time"]);
    let done = simulate(&model("pendulum"), "--timestep 1e-300 --time 1", &[]);
    refused(&done, &["--time", "steps", "1e15"]);
    let done = simulate(&model("pendulum"), "--time 1e300", &[]);
    refused(&done, &["--time: 1e300 s in steps of 2e-3 s"]);
    let done = simulate(&model("pendulum"), "--timestep 1e-300 --steps 2", &[]);
    assert_eq!(code(&done), 0, "{}", errors(&done));
}
