//! Heaps come to rest: towers sink as deep as the softness formula predicts, a pile stays in its bin.

use clench::prelude::*;
use clench::rigid::readout::{ContactRow, contact_rows};
use std::path::Path;
use std::sync::Arc;

const GRAVITY: f64 = 9.81;

fn start(name: &str) -> Sim {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../models")
        .join(name);
    let model = clench::load(path).expect("a model of our own");
    Sim::new(Arc::new(model)).expect("supported")
}

fn run(sim: &mut Sim, seconds: f64) {
    while sim.state.time < seconds {
        sim.step().expect("finite");
    }
    sim.forward().expect("finite");
}

/// Returns the depth at which `points` contacts with default parameters carry a weight of inverse inertia `a0`.
///
/// At rest, each of a contact's four edges requests k r and gets it by a force k |r| / R, so the weight is points · 4
/// k(r) |r| / R(r) with k = d / (0.95² 0.02²), R = 2 μ² (1 + μ²) A₀ (1 − d) / d and the impedance d between 0.9 and
/// 0.95 over a millimetre.
fn predicted_depth(weight: f64, points: f64, a0: f64, mu: f64) -> f64 {
    let carried = |depth: f64| {
        let x = (depth / 0.001f64).min(1.0);
        let share = if x < 0.5 {
            2.0 * x * x
        } else {
            1.0 - 2.0 * (1.0 - x) * (1.0 - x)
        };
        let d = 0.9 + 0.05 * share;
        let stiffness = d / (0.95 * 0.02f64).powi(2);
        let r = 2.0 * mu * mu * (1.0 + mu * mu) * a0 * (1.0 - d) / d;
        points * 4.0 * stiffness * depth / r
    };
    let (mut low, mut high) = (0.0, 0.1);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if carried(middle) < weight {
            &mut low
        } else {
            &mut high
        }) = middle;
    }
    low
}

#[test]
fn towers_penetrate_as_the_formula_predicts() {
    let mut sim = start("towers.xml");
    let first = sim.state.qpos.clone();
    run(&mut sim, 10.0);
    let rows = contact_rows(sim.workspace(), 0);
    for tower in ["box", "cylinder", "prism"] {
        let geom = |level: usize| match level {
            0 => sim.model().geom("floor").expect("named"),
            _ => sim.model().geom(&format!("{tower}{level}")).expect("named"),
        };
        for level in 1..=10 {
            let between: Vec<&ContactRow> = (rows.iter())
                .filter(|row| {
                    let pair = [geom(level - 1), geom(level)];
                    row.geoms == pair || row.geoms == [pair[1], pair[0]]
                })
                .collect();
            let body = sim.model().geoms[geom(level)].body;
            let mass = sim.model().params.body_mass[body];
            let weight = (11 - level) as f64 * mass * GRAVITY;
            let force: f64 = between.iter().map(|row| row.force[0]).sum();
            assert!(
                (force / weight - 1.0).abs() < 1e-6,
                "{tower} {level}: {force} N"
            );

            let a0 = if level == 1 { 1.0 } else { 2.0 } / mass;
            let predicted = predicted_depth(weight, between.len() as f64, a0, 0.8);
            for row in &between {
                assert!(
                    (-row.dist / predicted - 1.0).abs() < 1e-3,
                    "{tower} {level}: {} instead of {predicted} m in {} points",
                    -row.dist,
                    between.len()
                );
            }
            let at = 7 * (body - 1);
            for axis in 0..2 {
                let drift = sim.state.qpos[at + axis] - first[at + axis];
                assert!(drift.abs() < 1e-6, "{tower} {level} moved by {drift} m");
            }
            assert!(
                sim.state.qpos[at + 3] > 1.0 - 1e-9,
                "{tower} {level} has turned"
            );
        }
    }
}

#[test]
fn a_pile_of_all_shapes_settles_in_its_bin() {
    let mut sim = start("pile.xml");
    run(&mut sim, 1.5);
    let count = sim.state.qpos.len() / 7;
    assert_eq!(count, 200);
    for body in 0..count {
        let [x, y, z] = [0, 1, 2].map(|axis| sim.state.qpos[7 * body + axis]);
        assert!(
            x.abs() < 0.55 && y.abs() < 0.55 && z > 0.0,
            "body {body} is at {x}, {y}, {z}"
        );
    }
    // They fell with 150 J. Round bodies may roll for long and make others slip.
    let energy: f64 = (0..count)
        .map(|body| {
            let speed: f64 = sim.state.qvel[6 * body..][..3].iter().map(|v| v * v).sum();
            0.5 * sim.model().params.body_mass[body + 1] * speed
        })
        .sum();
    assert!(energy < 0.5, "{energy} J of motion are left");
    let deepest = (sim.contacts().iter()).fold(0.0, |deepest: f64, c| deepest.min(c.dist));
    assert!(deepest > -0.005, "{deepest} m deep");
}
