//! Recordings: the previous file stays until the new one is complete, and an interrupt loses nothing.

use crate::program::{
    array, code, driven, errors, folder, header, model, npy, refused, simulate, simulation, start,
    summary,
};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::thread::sleep;
use std::time::Duration;

/// A run that lasts until it is stopped, with a row for every thousandth step.
const ENDLESS: &str = "--steps 2000000000 --every 1000 --json";

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder is there");
    let names = entries.map(|entry| entry.expect("it can be read").file_name());
    let mut names = Vec::from_iter(names.map(|name| name.to_string_lossy().into_owned()));
    names.sort();
    names
}

/// Starts an endless run, sends it a signal, and waits for its end.
fn end_by(signal: &str, words: &str, record: &Path) -> Output {
    let run = start(simulation(
        &model("pendulum"),
        words,
        &[("--record", record)],
    ));
    sleep(Duration::from_millis(1500));
    let sent = Command::new("kill")
        .args([signal, &run.id().to_string()])
        .status();
    assert!(
        sent.expect("kill can be run").success(),
        "the run is still there"
    );
    run.wait_with_output().expect("the run ends")
}

#[test]
fn a_record_replaces_an_old_one() {
    let folder = folder();
    let path = folder.path().join("out.npz");
    fs::write(&path, "old").unwrap();
    let done = simulate(
        &model("pendulum"),
        "--steps 10 --every 3 --json",
        &[("--record", &path)],
    );
    assert_eq!(code(&done), 0, "{}", errors(&done));
    assert_eq!(summary(&done)["recorded_rows"], 3);
    let (shape, times) = array(&path, "time");
    assert_eq!(shape, [3]);
    assert!(times.is_sorted());
    assert_eq!(names(folder.path()), ["out.npz"]);
}

#[test]
fn a_record_may_have_the_longest_name_of_the_file_system() {
    let folder = folder();
    let path = folder.path().join(format!("{}.npz", "é".repeat(125)));
    let done = simulate(&model("pendulum"), "--steps 3", &[("--record", &path)]);
    assert_eq!(code(&done), 0, "{}", errors(&done));
    assert!(path.is_file());
}

#[test]
fn a_run_that_is_refused_leaves_the_old_record() {
    let folder = folder();
    let path = folder.path().join("out.npz");
    fs::write(&path, "old").unwrap();
    let words = "--steps 10 --envs 2 --max-memory 1e-9";
    let refused = simulate(&model("pendulum"), words, &[("--record", &path)]);
    assert_eq!(code(&refused), 2);
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["out.npz"]);
}

#[test]
#[cfg(unix)]
fn an_interrupt_keeps_what_was_recorded() {
    for (signal, name, exit) in [("-INT", "SIGINT", 130), ("-TERM", "SIGTERM", 143)] {
        for envs in ["", "--envs 3"] {
            let folder = folder();
            let path = folder.path().join("out.npz");
            fs::write(&path, "old").unwrap();
            let done = end_by(signal, &format!("{ENDLESS} {envs}"), &path);
            let message = errors(&done);
            assert_eq!(code(&done), exit, "{message}");
            let (shape, times) = array(&path, "time");
            let rows = *shape.last().unwrap();
            assert!(rows > 0 && times.iter().all(|&t| t > 0.0), "{rows} rows");
            assert!(
                message.contains(name) && message.contains(&format!("{rows} rows")),
                "{message}"
            );
            let figures = summary(&done);
            assert_eq!(figures["status"], "interrupted");
            assert_eq!(figures["recorded_rows"], rows);
            assert_eq!(figures["steps"].as_u64().unwrap() / 1000, rows);
            assert_eq!(names(folder.path()), ["out.npz"]);
        }
    }
}

#[test]
#[cfg(unix)]
fn a_kill_leaves_the_old_record_whole() {
    let folder = folder();
    let path = folder.path().join("out.npz");
    fs::write(&path, "old").unwrap();
    let done = end_by("-KILL", ENDLESS, &path);
    assert_eq!(done.status.code(), None);
    assert_eq!(fs::read(&path).unwrap(), b"old");
}

#[test]
fn a_record_is_none_of_the_inputs() {
    let folder = folder();
    let ctrl = folder.path().join("ctrl.npz");
    npy(&ctrl, 1, &header(1, 1), None, &[0.0]);
    let before = fs::read(&ctrl).unwrap();
    let model = driven(folder.path());
    let run = |record: &Path| simulate(&model, "", &[("--ctrl", &ctrl), ("--record", record)]);
    refused(&run(&ctrl), &["--record", "--ctrl", "ctrl.npz"]);
    refused(
        &run(&folder.path().join(".").join("ctrl.npz")),
        &["--record", "--ctrl"],
    );
    #[cfg(unix)]
    {
        let link = folder.path().join("link.npz");
        std::os::unix::fs::symlink(&ctrl, &link).unwrap();
        refused(&run(&link), &["--record", "--ctrl", "link.npz"]);
    }
    let states = simulate(&model, "", &[("--states", &ctrl), ("--record", &ctrl)]);
    refused(&states, &["--record", "--states"]);
    assert_eq!(fs::read(&ctrl).unwrap(), before);
}

#[test]
#[cfg(unix)]
fn a_record_through_a_link_replaces_its_target() {
    let folder = folder();
    let (path, link) = (
        folder.path().join("out.npz"),
        folder.path().join("link.npz"),
    );
    fs::write(&path, "old").unwrap();
    std::os::unix::fs::symlink(&path, &link).unwrap();
    let done = simulate(&model("pendulum"), "--steps 2", &[("--record", &link)]);
    assert_eq!(code(&done), 0, "{}", errors(&done));
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(array(&path, "qpos").0[0], 2);
}

#[test]
#[cfg(unix)]
fn a_record_has_the_permissions_of_other_files() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let (path, plain) = (folder.path().join("out.npz"), folder.path().join("plain"));
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    let run = || {
        code(&simulate(
            &model("pendulum"),
            "--steps 2",
            &[("--record", &path)],
        ))
    };
    fs::write(&plain, "").unwrap();
    assert_eq!(run(), 0);
    assert_eq!(mode(&path), mode(&plain));
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
    assert_eq!(run(), 0);
    assert_eq!(mode(&path) & 0o777, 0o640);
}

#[test]
fn a_record_is_an_npz() {
    let folder = folder();
    for name in ["out", "out.npy", "out.csv", ".npz"] {
        let path = folder.path().join(name);
        let done = simulate(&model("pendulum"), "--steps 2", &[("--record", &path)]);
        refused(&done, &["--record", name, ".npz"]);
    }
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_device_is_an_error_and_nothing_else() {
    let folder = folder();
    let full = folder.path().join("full.npz");
    std::os::unix::fs::symlink("/dev/full", &full).unwrap();
    let done = simulate(&model("pendulum"), "--steps 2", &[("--record", &full)]);
    refused(&done, &["--record", "full.npz", "No space left"]);
    let message = errors(&done);
    assert_eq!(message.lines().count(), 1, "{message}");
}

#[test]
#[cfg(target_os = "linux")]
fn output_that_cannot_be_written_is_no_panic() {
    let full = || {
        fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap()
    };
    let run = || simulation(&model("pendulum"), "--steps 2", &[]);
    let done = run().stdout(full()).output().unwrap();
    refused(&done, &["standard output", "No space left"]);
    // Notes, warnings and errors that cannot be written change nothing.
    let bad = crate::program::command("simulate nowhere.xml")
        .stderr(full())
        .status()
        .unwrap();
    assert_eq!(bad.code(), Some(2));
    let warned = simulation(&model("humanoid"), "--steps 9 --timestep 0.5", &[]);
    let mut warned = warned;
    assert_ne!(
        warned.stderr(full()).output().unwrap().status.code(),
        Some(101)
    );
}
