//! Smooth dynamics compared with its definitions.

use crate::machines::{distance, everything, floating, shake, sim, turn_between};
use clench_dynamics::part::Part;
use clench_math::{Force, Motion, Vec3};
use clench_rigid::dynamics::coriolis::{Coriolis, add_bias_derivatives};
use clench_rigid::dynamics::derivatives::add_velocity_derivatives;
use clench_rigid::dynamics::integrate::integrate_positions;
use clench_rigid::dynamics::project::{force_at, project_forces};
use clench_rigid::{Sim, readout};
use clench_solver::{TreeLu, TreeMatrix};

/// The step of finite differences. Their error is its square, plus rounding of 1e-16 over it.
const H: f64 = 1e-5;

fn shaken(builder: &clench_rigid::builder::ModelBuilder, seed: u64) -> Sim {
    let mut sim = sim(builder);
    shake(&mut sim, seed);
    sim.forward().expect("the state is finite");
    sim
}

/// Returns the simulation after moving along `velocity` for `time`.
fn moved(sim: &Sim, velocity: &[f64], time: f64) -> Sim {
    let mut other = Sim::new(sim.model().clone()).expect("as the original");
    other.state.copy_from(&sim.state);
    integrate_positions(sim.model(), &mut other.state.qpos, velocity, time);
    other.forward().expect("the state is finite");
    other
}

/// Returns the spatial velocities of all bodies if only dof `dof` moves, at unit velocity.
fn unit_velocities(sim: &Sim, dof: usize) -> Vec<Motion<f64>> {
    let mut other = Sim::new(sim.model().clone()).expect("as the original");
    other.state.copy_from(&sim.state);
    other.state.qvel.fill(0.0);
    other.state.qvel[dof] = 1.0;
    other.forward().expect("the state is finite");
    other.workspace().velocity.cvel.clone()
}

#[test]
fn body_velocities_are_derivatives_of_poses() {
    for seed in 0..4 {
        let sim = shaken(&floating(), seed);
        let qvel = sim.state.qvel.clone();
        let (after, before) = (moved(&sim, &qvel, H), moved(&sim, &qvel, -H));
        let (ws, a, b) = (sim.workspace(), after.workspace(), before.workspace());
        for (i, body) in sim.model().bodies.iter().enumerate().skip(1) {
            let cvel = ws.velocity.cvel[i];
            let com = ws.position.subtree_com[body.root];
            let point = cvel.velocity_at(ws.position.xipos[i] - com);
            let moved = (a.position.xipos[i] - b.position.xipos[i]) * (0.5 / H);
            assert!((point - moved).norm() < 1e-8, "body {i}");
            let turned = turn_between(b.position.xquat[i], a.position.xquat[i]) * (0.5 / H);
            assert!((cvel.angular - turned).norm() < 1e-8, "body {i}");
        }
    }
}

#[test]
fn the_rate_of_dof_axes_is_their_derivative() {
    let sim = shaken(&floating(), 5);
    let qvel = sim.state.qvel.clone();
    let (after, before) = (moved(&sim, &qvel, H), moved(&sim, &qvel, -H));
    let velocity = &sim.workspace().velocity;
    // Only the sum over a body's dofs is defined, about a fixed point.
    let about_origin = |sim: &Sim, body: usize| {
        let (model, ws) = (sim.model(), sim.workspace());
        let com = ws.position.subtree_com[model.bodies[body].root];
        let dofs = model.bodies[body].dofs.clone();
        dofs.fold(Motion::ZERO, |sum: Motion<f64>, i| {
            let axis = ws.position.cdof[i];
            sum + Motion::new(axis.angular, axis.velocity_at(-com)) * qvel[i]
        })
    };
    for (i, body) in sim.model().bodies.iter().enumerate().skip(1) {
        let com = sim.workspace().position.subtree_com[body.root];
        let rate = (body.dofs.clone()).fold(Motion::ZERO, |sum: Motion<f64>, k| {
            sum + velocity.cdof_dot[k] * qvel[k]
        });
        let expected = (about_origin(&after, i) - about_origin(&before, i)) * (0.5 / H);
        assert!((rate.angular - expected.angular).norm() < 1e-7, "body {i}");
        let at_origin = rate.velocity_at(-com);
        assert!((at_origin - expected.linear).norm() < 1e-7, "body {i}");
    }
}

#[test]
fn mass_matrix_is_the_sum_of_body_inertias() {
    for seed in 0..4 {
        let sim = shaken(&floating(), seed);
        let (model, nv) = (sim.model(), sim.model().nv);
        let mass = readout::mass_matrix(sim.workspace(), 0);
        let columns: Vec<_> = (0..nv).map(|i| unit_velocities(&sim, i)).collect();
        for i in 0..nv {
            for j in 0..nv {
                let mut expected = if i == j {
                    model.params.dof_armature[i]
                } else {
                    0.0
                };
                for (b, &inertia) in sim.workspace().position.cinert.iter().enumerate() {
                    expected += columns[i][b].dot(inertia * columns[j][b]);
                }
                let error = (mass[i * nv + j] - expected).abs();
                assert!(error < 1e-12, "M({i}, {j}) is off by {error}");
                assert_eq!(mass[i * nv + j], mass[j * nv + i]);
            }
        }
        // The factorization accepts positive definite matrices only.
        assert!(!sim.workspace().singular);
    }
}

/// Returns the momentum and angular momentum of each body about the world's origin.
fn momenta(sim: &Sim) -> Vec<Force<f64>> {
    let (model, ws) = (sim.model(), sim.workspace());
    (model.bodies.iter().enumerate())
        .map(|(b, body)| {
            let momentum = ws.position.cinert[b] * ws.velocity.cvel[b];
            let com = ws.position.subtree_com[body.root];
            let angular = momentum.angular + com.cross(momentum.linear);
            Force::new(angular, momentum.linear)
        })
        .collect()
}

/// d'Alembert: the rates of change of all momenta at constant dof velocities, less gravity, along each dof.
#[test]
fn bias_is_the_force_of_steady_motion() {
    for seed in 0..4 {
        let sim = shaken(&floating(), seed);
        let (model, ws) = (sim.model(), sim.workspace());
        let qvel = sim.state.qvel.clone();
        let (after, before) = (moved(&sim, &qvel, H), moved(&sim, &qvel, -H));
        let mut forces: Vec<Force<f64>> = (momenta(&after).iter().zip(momenta(&before)))
            .map(|(&a, b)| (a - b) * (0.5 / H))
            .collect();
        for (b, force) in forces.iter_mut().enumerate() {
            let weight = model.params.gravity * model.params.body_mass[b];
            // Move to the tree's reference point and add the force that carries the weight.
            let com = ws.position.subtree_com[model.bodies[b].root];
            force.angular -= com.cross(force.linear);
            *force -= force_at(
                model,
                &ws.position,
                b,
                ws.position.xipos[b],
                weight,
                Vec3::ZERO,
            );
        }
        let mut expected = vec![0.0; model.nv];
        project_forces(
            model,
            &[Part::whole(model)],
            &ws.position,
            &mut forces,
            &mut expected,
        );
        let error = distance(&expected, &ws.force.qfrc_bias);
        assert!(error < 1e-7, "seed {seed}: {error}");
    }
}

#[test]
fn gravity_and_springs_are_gradients_of_the_potential() {
    let mut builder = everything();
    builder.physics.density = 0.0;
    builder.physics.viscosity = 0.0;
    for seed in 0..3 {
        let mut sim = sim(&builder);
        shake(&mut sim, seed);
        sim.state.qvel.fill(0.0);
        sim.forward().expect("finite");
        let nv = sim.model().nv;
        for dof in 0..nv {
            let mut along = vec![0.0; nv];
            along[dof] = 1.0;
            let potential = |time| {
                moved(&sim, &along, time)
                    .energy()
                    .expect("finite")
                    .potential
            };
            let slope = (potential(H) - potential(-H)) / (2.0 * H);
            let force = &sim.workspace().force;
            let expected = force.qfrc_bias[dof] - force.qfrc_spring[dof];
            assert!(
                (slope - expected).abs() < 1e-6,
                "dof {dof}: {slope} {expected}"
            );
        }
    }
}

#[test]
fn kinetic_energy_is_that_of_the_bodies() {
    let mut sim = shaken(&floating(), 2);
    let kinetic = sim.energy().expect("finite").kinetic;
    let ws = sim.workspace();
    let bodies: f64 = (ws.velocity.cvel.iter().zip(&ws.position.cinert))
        .map(|(&v, &inertia)| 0.5 * v.dot(inertia * v))
        .sum();
    let rotors: f64 = (sim.state.qvel.iter().zip(&sim.model().params.dof_armature))
        .map(|(v, armature)| 0.5 * armature * v * v)
        .sum();
    assert!((kinetic - bodies - rotors).abs() < 1e-12 * kinetic);
}

/// Compares ∂(passive + actuator)/∂v, without Coriolis terms, in the entries of the tree.
#[test]
fn velocity_derivatives_agree_with_differences_of_the_forces() {
    let mut machine = everything();
    // As in MuJoCo, the range of a joint's total force does not clamp derivatives of other transmissions.
    machine
        .actuators
        .retain(|a| a.name != "string" && a.name != "piston");
    for seed in 0..3 {
        let sim = shaken(&machine, seed);
        let (model, ws) = (sim.model(), sim.workspace());
        let mut derivatives = TreeMatrix::zeros(&model.tree);
        add_velocity_derivatives(
            model,
            sim.params(),
            &sim.state,
            (&ws.position, &ws.velocity, &ws.force),
            1.0,
            &mut derivatives,
        );
        let derivatives = derivatives.to_dense(&model.tree);
        let nv = model.nv;
        let force = |dof: usize, change: f64| {
            let mut other = Sim::new(model.clone()).expect("as the original");
            other.state.copy_from(&sim.state);
            other.state.qvel[dof] += change;
            other.forward().expect("finite");
            let force = &other.workspace().force;
            let sum = force.qfrc_passive.iter().zip(&force.qfrc_actuator);
            sum.map(|(a, b)| a + b).collect::<Vec<_>>()
        };
        for j in 0..nv {
            let (after, before) = (force(j, H), force(j, -H));
            for i in 0..nv {
                if !model.tree.row(i.max(j)).contains(&(i.min(j) as u32)) {
                    continue;
                }
                let expected = (after[i] - before[i]) / (2.0 * H);
                let error = (derivatives[i * nv + j] - expected).abs();
                assert!(error < 1e-6, "seed {seed}, ({i}, {j}): {error}");
            }
        }
    }
}

#[test]
fn bias_derivatives_agree_with_differences_of_the_bias() {
    let mut machine = everything();
    // As in MuJoCo, the bias of tendons with inertia is omitted.
    machine.tendons.iter_mut().for_each(|t| t.armature = 0.0);
    for seed in 0..3 {
        let sim = shaken(&machine, seed);
        let (model, ws) = (sim.model(), sim.workspace());
        let mut derivatives = TreeLu::zeros(&model.tree);
        add_bias_derivatives(
            model,
            sim.params(),
            (&ws.position, &ws.velocity),
            &sim.state.qvel,
            1.0,
            &mut Coriolis::new(model),
            &mut derivatives,
        );
        let bias = |dof: usize, change: f64| {
            let mut other = Sim::new(model.clone()).expect("as the original");
            other.state.copy_from(&sim.state);
            other.state.qvel[dof] += change;
            other.forward().expect("finite");
            other.workspace().force.qfrc_bias.clone()
        };
        let nv = model.nv;
        let mut expected = vec![0.0; nv * nv];
        for j in 0..nv {
            let (after, before) = (bias(j, H), bias(j, -H));
            for (i, (after, before)) in after.iter().zip(&before).enumerate() {
                expected[i * nv + j] = (after - before) / (2.0 * H);
            }
        }
        for i in 0..nv {
            let (row, column) = derivatives.dof_mut(&model.tree, i);
            for (k, &j) in model.tree.row(i).iter().enumerate() {
                let (above, below) = (i * nv + j as usize, j as usize * nv + i);
                assert!((row[k] - expected[above]).abs() < 1e-7, "({i}, {j})");
                assert!((column[k] - expected[below]).abs() < 1e-7, "({j}, {i})");
                (expected[above], expected[below]) = (0.0, 0.0);
            }
        }
        // Dofs of different branches do not affect each other.
        assert!(expected.iter().all(|x| x.abs() < 1e-7));
    }
}

#[test]
fn actuator_velocity_is_the_rate_of_its_length() {
    let sim = shaken(&everything(), 1);
    let qvel = sim.state.qvel.clone();
    let (after, before) = (moved(&sim, &qvel, H), moved(&sim, &qvel, -H));
    let length = |sim: &Sim| sim.workspace().position.actuator_length.clone();
    let (a, b) = (length(&after), length(&before));
    for (u, actuator) in sim.model().actuators.iter().enumerate() {
        // Rotation vectors are not additive, and a free joint has no length.
        if ["ball", "thruster", "jet"].contains(&actuator.name.as_str()) {
            continue;
        }
        let expected = (a[u] - b[u]) / (2.0 * H);
        let error = (sim.workspace().velocity.actuator_velocity[u] - expected).abs();
        assert!(error < 1e-8, "{}: {error}", actuator.name);
    }
}

#[test]
fn full_compensation_floats() {
    let mut builder = floating();
    for body in &mut builder.bodies {
        body.gravcomp = 1.0;
    }
    let mut sim = sim(&builder);
    sim.forward().expect("finite");
    assert!(distance(&sim.workspace().qacc, &[0.0; 14]) < 1e-12);
}

#[test]
fn weight_is_compensated_only_if_gravcomp_is_set() {
    let builder = floating();
    let mut sim = sim(&builder);
    let mut compensated = |shares: [f64; 6]| {
        sim.set_param("body_gravcomp", &[&[0.0][..], &shares].concat())
            .expect("a share a body");
        sim.forward().expect("finite");
        sim.workspace().force.qfrc_gravcomp.clone()
    };
    let nothing = compensated([-1.0, -2.0, 0.0, -0.5, 0.0, 0.0]);
    assert_eq!(nothing, [0.0; 14]);
    let third = compensated([0.0, 0.0, 0.25, 0.0, 0.0, 0.0]);
    let both = compensated([-1.0, 0.0, 0.25, 0.0, 0.0, 0.0]);
    let weight = 9.81 * sim.params().body_mass[1];
    assert!((both[2] - third[2] + weight).abs() < 1e-12);
}

#[test]
fn applied_forces_accelerate_the_centre_of_mass() {
    let mut builder = floating();
    builder.physics.gravity = [0.0; 3];
    let mut sim = sim(&builder);
    shake(&mut sim, 3);
    let (force, hand) = (Vec3::new(1.0, -2.0, 0.5), 3);
    sim.state.xfrc_applied[hand] = Force::new(Vec3::new(0.3, 0.2, 0.1), force);
    // The rate of the total momentum, from steps forward and backward in time.
    let momentum = |sim: &Sim| {
        momenta(sim)
            .iter()
            .fold(Vec3::ZERO, |sum, p| sum + p.linear)
    };
    let mut rate = Vec3::ZERO;
    for sign in [1.0, -1.0] {
        let mut other = Sim::new(sim.model().clone()).expect("as the original");
        other.state.copy_from(&sim.state);
        other.forward().expect("finite");
        let qacc = other.workspace().qacc.clone();
        let qvel = other.state.qvel.clone();
        let mut middle = qvel.clone();
        for (v, a) in middle.iter_mut().zip(&qacc) {
            *v += 0.5 * sign * H * a;
        }
        integrate_positions(sim.model(), &mut other.state.qpos, &middle, sign * H);
        for (v, a) in other.state.qvel.iter_mut().zip(&qacc) {
            *v += sign * H * a;
        }
        other.forward().expect("finite");
        rate += momentum(&other) * (sign * 0.5 / H);
    }
    assert!((rate - force).norm() < 1e-7, "{rate:?}");
}
