//! Tendons and transmissions: lengths, their derivatives, and the inertia of tendons.

use crate::machines::{everything, shake, sim};
use clench_rigid::dynamics::integrate::integrate_positions;
use clench_rigid::model::Wrap;
use clench_rigid::{Sim, readout};
use std::collections::HashSet;

/// The step of finite differences (rad, m). Their error is its square, plus rounding of 1e-16 over it.
const H: f64 = 1e-5;
const TOLERANCE: f64 = 1e-8;
const SEEDS: u64 = 12;

fn shaken(seed: u64) -> Sim {
    let mut sim = sim(&everything());
    shake(&mut sim, seed);
    sim.forward().expect("finite");
    sim
}

/// Returns the machine after moving with `velocity` for `time`, which may be negative.
fn moved(sim: &Sim, velocity: &[f64], time: f64) -> Sim {
    let mut moved = Sim::new(sim.model().clone()).expect("as the original");
    moved.state.copy_from(&sim.state);
    integrate_positions(sim.model(), &mut moved.state.qpos, velocity, time);
    moved.forward().expect("finite");
    moved
}

/// Returns the lengths of tendons, then of actuators.
fn lengths(sim: &Sim) -> Vec<f64> {
    let pos = &sim.workspace().position;
    [&pos.ten_length[..], &pos.actuator_length].concat()
}

/// Returns the dense gradients of the lengths.
fn gradients(sim: &Sim) -> Vec<Vec<f64>> {
    let (model, pos) = (sim.model(), &sim.workspace().position);
    let dense = |row: &mut dyn Iterator<Item = (usize, f64)>| {
        let mut dense = vec![0.0; model.nv];
        row.for_each(|(dof, entry)| dense[dof] += entry);
        dense
    };
    let tendon = |t| dense(&mut model.tendon_dofs.row(&pos.ten_jacobian, t));
    let actuator = |u| dense(&mut model.actuator_dofs.row(&pos.actuator_moment, u));
    (0..model.tendons.len())
        .map(tendon)
        .chain((0..model.actuators.len()).map(actuator))
        .collect()
}

/// Returns true for a wrench: an actuator without a length from which its moment could follow.
fn is_wrench(sim: &Sim, index: usize) -> bool {
    let tendons = sim.model().tendons.len();
    index >= tendons && sim.workspace().position.actuator_length[index - tendons] == 0.0
}

#[test]
fn moment_arms_are_derivatives_of_lengths() {
    for seed in 0..SEEDS {
        let sim = shaken(seed);
        let gradients = gradients(&sim);
        for dof in 0..sim.model().nv {
            let mut along = vec![0.0; sim.model().nv];
            along[dof] = 1.0;
            let (after, before) = (moved(&sim, &along, H), moved(&sim, &along, -H));
            let (after, before) = (lengths(&after), lengths(&before));
            for (i, row) in gradients.iter().enumerate() {
                // On a ball joint, the length is part of a rotation vector, whose rate is not the angular velocity.
                let ball = i >= sim.model().tendons.len()
                    && sim.model().actuators[i - sim.model().tendons.len()].name == "ball";
                if is_wrench(&sim, i) || ball {
                    continue;
                }
                let expected = (after[i] - before[i]) / (2.0 * H);
                assert!(
                    (row[dof] - expected).abs() < TOLERANCE,
                    "seed {seed}, length {i}, dof {dof}: {} instead of {expected}",
                    row[dof]
                );
            }
        }
    }
}

#[test]
fn every_string_is_seen_straight_and_bent() {
    // The test above must cover these cases.
    let mut seen = HashSet::new();
    let straight = |sim: &Sim, t: usize| {
        let (model, pos) = (sim.model(), &sim.workspace().position);
        let mut sum = 0.0;
        for section in model.tendons[t].sections() {
            let [a, b] = section.sites.map(|site| pos.site_xpos[site]);
            sum += (b - a).norm() / section.divisor.map_or(1.0, |i| model.params.wrap_coef[i]);
        }
        (sum - pos.ten_length[t]).abs() < 1e-12
    };
    for seed in 0..SEEDS {
        let sim = shaken(seed);
        for (t, tendon) in sim.model().tendons.iter().enumerate() {
            if tendon
                .path
                .iter()
                .any(|wrap| matches!(wrap, Wrap::Geom { .. }))
            {
                seen.insert((t, straight(&sim, t)));
            }
        }
    }
    assert!(seen.len() >= 12, "of 14 cases only {seen:?}");
}

#[test]
fn velocities_are_rates_of_lengths() {
    for seed in 0..SEEDS {
        let sim = shaken(seed);
        let v = sim.state.qvel.clone();
        let (after, before) = (moved(&sim, &v, H), moved(&sim, &v, -H));
        let (after, before) = (lengths(&after), lengths(&before));
        for (t, &found) in sim.workspace().velocity.ten_velocity.iter().enumerate() {
            let expected = (after[t] - before[t]) / (2.0 * H);
            assert!((found - expected).abs() < 10.0 * TOLERANCE, "tendon {t}");
        }
    }
}

/// Returns the machine with tendons without inertia.
fn light(sim: &Sim) -> Sim {
    let mut model = (**sim.model()).clone();
    model.params.tendon_armature.fill(0.0);
    let mut light = Sim::new(model.into()).expect("as the original");
    light.state.copy_from(&sim.state);
    light.forward().expect("finite");
    light
}

#[test]
fn the_inertia_of_a_tendon_is_felt_along_its_gradient() {
    for seed in 0..SEEDS {
        let (sim, gradients) = (shaken(seed), gradients(&shaken(seed)));
        let (model, nv) = (sim.model(), sim.model().nv);
        let (heavy, light) = (readout::mass_matrix(sim.workspace(), 0), light(&sim));
        let light = readout::mass_matrix(light.workspace(), 0);
        for i in 0..nv {
            for &j in model.tree.row(i) {
                let j = j as usize;
                let armatures = model.params.tendon_armature.iter().zip(&gradients);
                let expected: f64 = armatures.map(|(m, row)| m * row[i] * row[j]).sum();
                let found = heavy[i * nv + j] - light[i * nv + j];
                assert!((found - expected).abs() < 1e-13, "entry {i}, {j}");
            }
        }
    }
}

#[test]
fn the_bias_of_a_tendon_is_its_inertia_times_the_change_of_its_rate() {
    for seed in 0..SEEDS {
        let sim = shaken(seed);
        let (v, gradients) = (sim.state.qvel.clone(), gradients(&sim));
        let (after, before) = (moved(&sim, &v, H), moved(&sim, &v, -H));
        let rate = |sim: &Sim, t: usize| sim.workspace().velocity.ten_velocity[t];
        let light = light(&sim);
        for dof in 0..sim.model().nv {
            let armatures = sim.model().params.tendon_armature.iter();
            let mut expected = 0.0;
            for (t, (&m, gradient)) in armatures.zip(&gradients).enumerate() {
                let change = (rate(&after, t) - rate(&before, t)) / (2.0 * H);
                expected += m * gradient[dof] * change;
            }
            let bias = |sim: &Sim| sim.workspace().force.qfrc_bias[dof];
            let found = bias(&sim) - bias(&light);
            assert!(
                (found - expected).abs() < 1e-7,
                "dof {dof}: {found}, {expected}"
            );
        }
    }
}
