//! Inverse dynamics inverts forward dynamics, with every kind of constraint active.

use crate::scenes::{Numbers, everything, humanoid, shake};
use clench_math::Vec3;
use clench_rigid::builder::ModelBuilder;
use clench_rigid::model::Integrator;
use clench_rigid::options::{ContactModel, FrictionCone, RigidOptions};
use clench_rigid::{Acceleration, Sim, SimError};
use std::sync::Arc;

fn shaken(builder: &ModelBuilder, options: RigidOptions, seed: u64) -> Sim {
    let model = builder.build().unwrap_or_else(|error| panic!("{error}"));
    let options = options.tolerance(0.0).iterations(300);
    let mut sim = Sim::with_options(Arc::new(model), options).unwrap();
    shake(&mut sim, seed);
    let mut numbers = Numbers(seed + 1);
    numbers.fill(&mut sim.state.ctrl, 1.0);
    numbers.fill(&mut sim.state.qfrc_applied, 1.0);
    let body = sim.model().nbody() - 1;
    sim.state.xfrc_applied[body].linear = Vec3::new(1.0, 2.0, -3.0);
    sim
}

/// Returns the forces of actuators and users.
fn given(sim: &mut Sim) -> Vec<f64> {
    let mut forces = sim.output("qfrc_actuator").unwrap();
    for (sum, applied) in forces.iter_mut().zip(&sim.state.qfrc_applied) {
        *sum += applied;
    }
    for body in 0..sim.model().nbody() {
        let applied = sim.state.xfrc_applied[body];
        let place = sim.workspace().position.xipos[body];
        let wrench = (applied.linear, applied.angular);
        (sim.add_joint_forces(body, place, wrench, &mut forces)).unwrap();
    }
    forces
}

/// Compares relative to the largest force, constraint forces included.
fn assert_close(sim: &Sim, found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    let all = expected.iter().chain(&sim.workspace().qfrc_constraint);
    let scale = all.fold(1.0_f64, |most, x| most.max(x.abs()));
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!(
            (a - b).abs() <= tolerance * scale,
            "{what}, dof {i}: {a}, not {b}"
        );
    }
}

#[test]
fn inverse_dynamics_find_the_forces_that_forward_dynamics_were_given() {
    for (cone, law, stiction) in [
        (FrictionCone::Pyramidal, ContactModel::Convex, false),
        (FrictionCone::Elliptic, ContactModel::Convex, true),
        (FrictionCone::Elliptic, ContactModel::Coulomb, false),
    ] {
        for (seed, builder) in [everything(), humanoid()].iter().enumerate() {
            let options = RigidOptions::new()
                .friction_cone(cone)
                .contact_model(law)
                .stiction(stiction);
            let mut sim = shaken(builder, options, seed as u64 + 2);
            // Both begin with a free joint. Lower them until they touch the floor.
            sim.forward().unwrap();
            while sim.contacts().is_empty() && sim.state.qpos[2] > -1.0 {
                sim.state.qpos[2] -= 0.02;
                sim.forward().unwrap();
            }
            assert!(!sim.contacts().is_empty());
            if stiction {
                sim.step().unwrap();
                sim.forward().unwrap();
                assert!(sim.state.stick_references[0].first > 0.0);
            }
            let qacc = sim.workspace().qacc.clone();
            let mut found = vec![f64::NAN; qacc.len()];
            (sim.inverse(&qacc, Acceleration::Continuous, &mut found)).unwrap();
            let expected = given(&mut sim);
            assert_close(&sim, &found, &expected, 1e-9, &format!("{cone:?}, {law:?}"));
        }
    }
}

#[test]
fn discrete_inverse_dynamics_find_them_from_the_change_of_velocity() {
    for integrator in [
        Integrator::Euler,
        Integrator::ImplicitFast,
        Integrator::Implicit,
        Integrator::Discrete,
    ] {
        let mut builder = everything();
        builder.physics.integrator = integrator;
        let mut sim = shaken(&builder, RigidOptions::new(), 4);
        sim.forward().unwrap();
        let expected = given(&mut sim);
        let before = sim.state.clone();
        sim.step().unwrap();
        let h = sim.params().timestep;
        let change = sim.state.qvel.iter().zip(&before.qvel);
        let qacc: Vec<f64> = change.map(|(after, before)| (after - before) / h).collect();
        sim.state.copy_from(&before);
        let mut found = vec![f64::NAN; qacc.len()];
        (sim.inverse(&qacc, Acceleration::Discrete, &mut found)).unwrap();
        assert_close(&sim, &found, &expected, 1e-8, &format!("{integrator:?}"));
    }
}

#[test]
fn a_step_of_runge_and_kutta_has_no_discrete_acceleration() {
    let mut builder = everything();
    builder.physics.integrator = Integrator::Rk4;
    let mut sim = shaken(&builder, RigidOptions::new(), 4);
    let nv = sim.model().nv;
    let mut room = vec![0.0; nv];
    let refused = sim.inverse(&vec![0.0; nv], Acceleration::Discrete, &mut room);
    assert_eq!(refused, Err(SimError::NoDiscreteInverse));
    assert!(
        sim.inverse(&vec![0.0; nv], Acceleration::Continuous, &mut room)
            .is_ok()
    );
}

#[test]
fn inverse_dynamics_leave_everything_as_it_was() {
    let mut sim = shaken(&everything(), RigidOptions::new(), 6);
    sim.step().unwrap();
    let nv = sim.model().nv;
    let before = (sim.output("qacc").unwrap(), sim.output("xpos").unwrap());
    let mut room = vec![0.0; nv];
    sim.inverse(&vec![1.0; nv], Acceleration::Continuous, &mut room)
        .unwrap();
    assert_eq!(
        before,
        (sim.output("qacc").unwrap(), sim.output("xpos").unwrap())
    );
    let wrong = sim.inverse(&[], Acceleration::Continuous, &mut room);
    assert!(matches!(wrong, Err(SimError::WrongLength { .. })));
    sim.state.qpos[0] = f64::NAN;
    let qacc = vec![0.0; nv];
    assert!(
        sim.inverse(&qacc, Acceleration::Continuous, &mut room)
            .is_err()
    );
}
