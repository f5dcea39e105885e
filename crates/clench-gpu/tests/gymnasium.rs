//! The robots of Gymnasium's MuJoCo tasks, where the environment variable `CLENCH_GYMNASIUM` names the folder of their files.

mod common;

use std::path::PathBuf;
use std::sync::Arc;

/// Each, and how far from its initial state.
const ROBOTS: [(&str, f64); 9] = [
    ("half_cheetah", 0.3),
    ("hopper", 0.5),
    ("walker2d_v5", 0.5),
    ("ant", 0.5),
    ("swimmer", 1.0),
    ("inverted_pendulum", 0.5),
    ("inverted_double_pendulum", 0.5),
    ("humanoid", 0.5),
    ("humanoidstandup", 0.5),
];

#[test]
fn stages_agree_on_gymnasiums_robots() {
    let Some(folder) = std::env::var_os("CLENCH_GYMNASIUM").map(PathBuf::from) else {
        eprintln!("skipped: CLENCH_GYMNASIUM names no folder");
        return;
    };
    for (name, spread) in ROBOTS {
        let path = folder.join(format!("{name}.xml"));
        let model = clench_formats::load(path).expect("a robot of Gymnasium loads");
        common::agree(&Arc::new(model), 100, spread);
    }
}
