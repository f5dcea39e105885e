//! Runs on a GPU, for programs built with the `gpu` feature.
#![cfg(feature = "gpu")]

use std::path::Path;
use std::process::{Command, Output};

fn clench(arguments: &[&str]) -> Output {
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/rolling_sphere.xml");
    let mut program = Command::new(env!("CARGO_BIN_EXE_clench"));
    program.args(["simulate"]).arg(model).args(arguments);
    program.output().expect("the program starts")
}

#[test]
fn a_run_on_a_device_is_reported_as_one_on_the_processor() {
    if std::env::var("CLENCH_GPU").as_deref() != Ok("require") {
        return;
    }
    let run = |more: &[&str]| -> serde_json::Value {
        let output = clench(&[&["--envs", "3", "--steps", "20", "--json"], more].concat());
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        let text = String::from_utf8_lossy(&output.stdout);
        serde_json::from_str(text.lines().last().expect("a line")).expect("JSON")
    };
    for (on_device, bits) in [(&[][..], "32"), (&["--precision", "64"], "64")] {
        let device = run(&[&["--device", "gpu"], on_device].concat());
        let processor = run(&["--precision", bits]);
        assert_eq!(device["status"], "ok");
        for same in ["steps", "envs", "nv", "precision", "simulated_time"] {
            assert_eq!(device[same], processor[same], "{same}");
        }
    }
}

#[test]
fn a_run_on_a_device_is_recorded() {
    if std::env::var("CLENCH_GPU").as_deref() != Ok("require") {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.npz");
    let record = path.to_string_lossy();
    let output = clench(&[
        "--envs", "3", "--steps", "20", "--device", "gpu", "--every", "5", "--record", &record,
    ]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(told.contains("4 rows are recorded"), "{told}");
    assert!(path.metadata().expect("a record").len() > 0);
}

/// Both list the same devices, or report in the same words that there are none.
#[test]
fn devices_are_listed_by_command_and_by_flag() {
    let list = |argument: &str| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_clench"));
        let output = program.arg(argument).output().expect("the program starts");
        let (told, said) = (output.stdout, output.stderr);
        let text = [told, said].map(|text| String::from_utf8_lossy(&text).into_owned());
        (output.status.code(), text)
    };
    let (code, text) = list("devices");
    let [told, said] = &text;
    match code {
        Some(0) => assert!(!told.trim().is_empty(), "{said}"),
        Some(_) => assert!(said.contains("mesa-vulkan-drivers"), "{said}"),
        None => panic!("it ended by a signal: {said}"),
    }
    assert_eq!(list("--list-devices"), (code, text));
}
