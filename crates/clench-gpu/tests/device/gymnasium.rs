//! The robots of Gymnasium's MuJoCo tasks, in the folder named by the environment variable `CLENCH_GYMNASIUM`.

use crate::common::folders;

/// Each robot with the number of states and their spread around the initial one.
const ROBOTS: &[(&str, usize, f64)] = &[
    ("half_cheetah", 100, 0.3),
    ("hopper", 100, 0.5),
    ("walker2d", 100, 0.5),
    ("walker2d_v5", 100, 0.5),
    ("ant", 100, 0.5),
    ("swimmer", 100, 1.0),
    ("point", 100, 0.5),
    ("pusher", 100, 0.5),
    ("pusher_v5", 100, 0.5),
    ("reacher", 100, 0.5),
    ("inverted_pendulum", 100, 0.5),
    ("inverted_double_pendulum", 100, 0.5),
    ("humanoid", 100, 0.5),
    ("humanoidstandup", 100, 0.5),
];

#[test]
fn trajectories_of_gymnasiums_robots_drift_as_on_the_processor() {
    folders::drift_on_folder("CLENCH_GYMNASIUM", ROBOTS, 100);
}

#[test]
fn stages_agree_on_gymnasiums_robots() {
    folders::agree_on_folder("CLENCH_GYMNASIUM", ROBOTS, &[]);
}
