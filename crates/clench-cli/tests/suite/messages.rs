//! MCAP recordings: their contents, and the readable part of one whose program was killed.

use crate::program::{code, errors, folder, model, refused, simulate, simulation, start, summary};
use mcap::read::Options;
use mcap::{MessageStream, Summary};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::thread::sleep;
use std::time::Duration;

/// Returns the messages of a file by topic, each with its time, s.
fn messages(bytes: &[u8], whole: bool) -> BTreeMap<String, Vec<(f64, Value)>> {
    let options = match whole {
        true => Options::ValidateChunkCrcs.into(),
        false => Options::ValidateChunkCrcs | Options::IgnoreEndMagic,
    };
    let mut found: BTreeMap<String, Vec<(f64, Value)>> = BTreeMap::new();
    for message in MessageStream::new_with_options(bytes, options).expect("it is MCAP") {
        // A message that was truncated when the program was killed ends the stream.
        let Ok(message) = message else {
            assert!(!whole, "{message:?}");
            break;
        };
        let time = 1e-9 * message.log_time as f64;
        let said = serde_json::from_slice(&message.data).expect("messages are JSON");
        let topic = message.channel.topic.clone();
        found.entry(topic).or_default().push((time, said));
    }
    found
}

#[test]
fn a_record_of_messages_has_poses_shapes_forces_and_plots() {
    let folder = folder();
    let path = folder.path().join("fall.mcap");
    let words = "--time 0.6 --every 10 --json";
    let done = simulate(&model("humanoid"), words, &[("--record", &path)]);
    assert_eq!(code(&done), 0, "{}", errors(&done));
    let rows = summary(&done)["recorded_rows"].as_u64().unwrap() as usize;
    let bytes = fs::read(&path).unwrap();
    let index = Summary::read(&bytes).unwrap().expect("it has an index");
    let schemas: Vec<_> = index
        .schemas
        .values()
        .map(|schema| &schema.name[..])
        .collect();
    for name in [
        "foxglove.SceneUpdate",
        "foxglove.FrameTransforms",
        "clench.Solver",
    ] {
        assert!(schemas.contains(&name), "{schemas:?}");
    }
    let all = messages(&bytes, true);
    for topic in [
        "/tf",
        "/forces",
        "/solver",
        "/energy",
        "/joints",
        "/controls",
    ] {
        assert_eq!(all[topic].len(), rows, "{topic}");
    }
    assert_eq!(all["/shapes"].len(), 1);
    let shapes = all["/shapes"][0].1["entities"].as_array().unwrap();
    let count = |kind: &str| -> usize {
        let lists = shapes
            .iter()
            .map(|entity| entity[kind].as_array().unwrap().len());
        lists.sum()
    };
    assert!(count("cylinders") >= 10 && count("spheres") > 20);
    // Each shape is in the frame of a body whose pose is published.
    let (_, poses) = &all["/tf"][0];
    let poses = poses["transforms"].as_array().unwrap();
    let mut frames = Vec::from_iter(poses.iter().map(|t| t["child_frame_id"].as_str().unwrap()));
    frames.push("world");
    for entity in shapes {
        assert!(frames.contains(&entity["frame_id"].as_str().unwrap()));
    }
    let (last, solver) = all["/solver"].last().unwrap();
    assert!((last - 0.6).abs() < 1e-6, "{last}");
    let contacts = solver["contacts"].as_u64().unwrap();
    let arrows = |k: usize| {
        all["/forces"][k].1["entities"][0]["arrows"]
            .as_array()
            .unwrap()
            .len()
    };
    assert!(contacts > 0 && arrows(rows - 1) > 0, "{contacts} contacts");
}

#[test]
fn a_killed_recording_of_messages_can_be_read_to_its_last_flush() {
    let folder = folder();
    let path = folder.path().join("run.mcap");
    let words = "--steps 2000000000 --every 100";
    let mut run = start(simulation(
        &model("pendulum"),
        words,
        &[("--record", &path)],
    ));
    sleep(Duration::from_millis(2500));
    run.kill().expect("it runs");
    run.wait().expect("it ends");
    let left = messages(&fs::read(&path).unwrap(), false);
    let (poses, solves) = (&left["/tf"], &left["/solver"]);
    assert!(poses.len() > 10, "{} moments", poses.len());
    assert!(poses.len().abs_diff(solves.len()) <= 1);
    assert!(poses.is_sorted_by(|(before, _), (after, _)| before < after));
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_ends_the_record_and_not_the_run() {
    let folder = folder();
    let full = folder.path().join("full.mcap");
    std::os::unix::fs::symlink("/dev/full", &full).unwrap();
    let words = "--steps 3000 --json";
    let done = simulate(&model("humanoid"), words, &[("--record", &full)]);
    refused(&done, &["--record", "full.mcap", "No space left"]);
    let figures = summary(&done);
    assert_eq!(figures["steps"], 3000);
    assert_eq!(figures["status"], "record_failed");
}
