//! Each environment of a batch equals a single simulation to the bit, for every way of stepping.

use crate::batches::*;
use clench_math::Instructions;
use clench_rigid::builder::ModelBuilder;
use clench_rigid::model::Integrator;
use clench_rigid::options::{ContactModel, FrictionCone, RigidOptions};
use clench_rigid::readout::constraint_rows;
use clench_rigid::{EnvStatus, Precision};
use clench_solver::ConstraintSolver;
use std::collections::BTreeSet;

/// The number of environments: no multiple of any width, and more than one of the widest groups.
const ENVS: usize = 19;

/// Steps `ENVS` environments singly and in batches, and compares the ends. Returns the mean number of contacts.
fn compare<S: Precision>(builder: &ModelBuilder, options: RigidOptions, steps: usize) -> f64 {
    let model = model(builder);
    let envs: Vec<usize> = (0..ENVS).collect();
    let mut contacts = 0;
    let ends: Vec<_> = (envs.iter())
        .map(|&env| {
            let mut sim = alone::<S>(&model, options, env);
            for step in 0..steps {
                drive_alone(&mut sim, env, step);
                sim.step().expect("finite");
                contacts += sim.contacts().len();
            }
            sim
        })
        .collect();
    for (i, instructions) in Instructions::all_available::<S>().enumerate() {
        let threads = 1 + i % 3;
        // Half the environments in another order have other neighbours.
        for some in [&envs[..], &[17, 3, 8, 1, 0, 12, 5, 9, 4]] {
            let mut batch = batch::<S>(&model, some, with(instructions, threads, options));
            for step in 0..steps {
                drive(&mut batch, some, step);
                batch.step().expect("valid");
            }
            for (row, &env) in some.iter().enumerate() {
                assert_eq!(batch.status(row), EnvStatus::Running);
                let what = || format!("{instructions:?}, {threads} threads");
                assert_state(&batch, row, &ends[env].state, &what);
            }
        }
    }
    contacts as f64 / (ENVS * steps) as f64
}

fn options(solver: ConstraintSolver, cone: FrictionCone) -> RigidOptions {
    RigidOptions::new()
        .constraint_solver(solver)
        .friction_cone(cone)
}

#[test]
fn newton_with_pyramids_moves_environments_as_alone() {
    let options = options(ConstraintSolver::Newton, FrictionCone::Pyramidal);
    assert!(compare::<f64>(&loose_parts(), options, 1000) > 3.0);
}

#[test]
fn newton_with_elliptic_cones_moves_environments_as_alone() {
    let options = options(ConstraintSolver::Newton, FrictionCone::Elliptic).impratio(3.0);
    assert!(compare::<f64>(&loose_parts(), options, 1000) > 3.0);
}

#[test]
fn coulombs_law_moves_environments_as_alone() {
    for solver in [ConstraintSolver::Newton, ConstraintSolver::Cg] {
        let options = options(solver, FrictionCone::Elliptic).contact_model(ContactModel::Coulomb);
        assert!(compare::<f64>(&loose_parts(), options, 300) > 3.0);
        assert!(compare::<f32>(&loose_parts(), options, 300) > 3.0);
    }
}

#[test]
fn what_sticks_moves_as_alone() {
    for (law, cone) in [
        (ContactModel::Convex, FrictionCone::Pyramidal),
        (ContactModel::Convex, FrictionCone::Elliptic),
        (ContactModel::Coulomb, FrictionCone::Elliptic),
    ] {
        let options = options(ConstraintSolver::Newton, cone)
            .contact_model(law)
            .stiction(true);
        assert!(compare::<f64>(&loose_parts(), options, 300) > 3.0);
        assert!(compare::<f32>(&loose_parts(), options, 300) > 3.0);
        assert!(compare::<f64>(&walker(), options, 300) > 1.0);
    }
}

#[test]
fn conjugate_gradients_with_pyramids_move_environments_as_alone() {
    let options = options(ConstraintSolver::Cg, FrictionCone::Pyramidal);
    assert!(compare::<f64>(&loose_parts(), options, 1000) > 3.0);
}

#[test]
fn conjugate_gradients_with_elliptic_cones_move_environments_as_alone() {
    let options = options(ConstraintSolver::Cg, FrictionCone::Elliptic).noslip_iterations(2);
    assert!(compare::<f64>(&loose_parts(), options, 300) > 3.0);
}

#[test]
fn a_humanoid_with_pyramids_moves_as_alone() {
    let options = options(ConstraintSolver::Newton, FrictionCone::Pyramidal);
    assert!(compare::<f64>(&walker(), options, 1000) > 1.0);
}

#[test]
fn a_humanoid_with_elliptic_cones_moves_as_alone() {
    let options = options(ConstraintSolver::Newton, FrictionCone::Elliptic);
    assert!(compare::<f64>(&walker(), options, 1000) > 1.0);
}

/// The geoms are enough for a broad-phase sweep, which covers all lanes together.
#[test]
fn parts_on_a_field_of_bumps_move_as_alone() {
    let mut bumpy = loose_parts();
    for k in 0..144 {
        let place = [0.1 * (k % 12) as f64 - 0.5, 0.1 * (k / 12) as f64 - 0.5];
        let bump = sphere(0.05).at([place[0], place[1], -0.03]);
        bumpy.bodies[0].geoms.push(bump);
    }
    let options = options(ConstraintSolver::Newton, FrictionCone::Pyramidal);
    assert!(compare::<f64>(&bumpy, options, 200) > 3.0);
    assert!(compare::<f32>(&bumpy, options, 200) > 3.0);
}

#[test]
fn environments_in_single_precision_move_as_alone() {
    let newton = options(ConstraintSolver::Newton, FrictionCone::Pyramidal);
    assert!(compare::<f32>(&walker(), newton, 1000) > 1.0);
    let cg = options(ConstraintSolver::Cg, FrictionCone::Elliptic);
    assert!(compare::<f32>(&loose_parts(), cg, 300) > 3.0);
}

/// Two trees that form two islands at some times and in some environments, and one in others.
#[test]
fn an_arm_and_a_box_move_as_alone_by_newton() {
    let pyramids = options(ConstraintSolver::Newton, FrictionCone::Pyramidal);
    assert!(compare::<f64>(&arm_and_box(), pyramids, 400) > 3.0);
    assert!(compare::<f32>(&arm_and_box(), pyramids, 400) > 3.0);
    let cones = options(ConstraintSolver::Newton, FrictionCone::Elliptic).noslip_iterations(3);
    assert!(compare::<f64>(&arm_and_box(), cones, 400) > 3.0);
}

#[test]
fn an_arm_and_a_box_move_as_alone_by_conjugate_gradients() {
    let pyramids = options(ConstraintSolver::Cg, FrictionCone::Pyramidal).noslip_iterations(2);
    assert!(compare::<f64>(&arm_and_box(), pyramids, 200) > 3.0);
    let cones = options(ConstraintSolver::Cg, FrictionCone::Elliptic);
    assert!(compare::<f64>(&arm_and_box(), cones, 200) > 3.0);
    assert!(compare::<f32>(&arm_and_box(), cones, 200) > 3.0);
}

/// Islands of any of many trees, finally of more than eight, which differ between environments.
#[test]
fn many_islands_in_each_environment_move_as_alone() {
    let pyramids = options(ConstraintSolver::Newton, FrictionCone::Pyramidal);
    assert!(compare::<f64>(&many_islands(), pyramids, 200) > 10.0);
    let cones = options(ConstraintSolver::Newton, FrictionCone::Elliptic);
    assert!(compare::<f32>(&many_islands(), cones, 150) > 8.0);
    let cg = options(ConstraintSolver::Cg, FrictionCone::Pyramidal);
    assert!(compare::<f64>(&many_islands(), cg, 80) > 5.0);
}

/// Returns the kinds of constraints with nonzero forces in single simulations.
fn acting(builder: &ModelBuilder, steps: usize) -> BTreeSet<&'static str> {
    let model = model(builder);
    let mut kinds = BTreeSet::new();
    for env in 0..ENVS {
        let mut sim = alone::<f64>(&model, RigidOptions::new(), env);
        for step in 0..steps {
            drive_alone(&mut sim, env, step);
            sim.step().expect("finite");
            let rows = constraint_rows(sim.workspace(), 0);
            let pulling = rows.iter().filter(|row| row.force != 0.0);
            kinds.extend(pulling.map(|row| row.source.kind()));
        }
    }
    kinds
}

#[test]
fn every_kind_of_constraint_moves_as_alone_with_every_integrator() {
    let kinds = [
        "contact",
        "equality",
        "friction_dof",
        "friction_tendon",
        "limit_joint",
        "limit_tendon",
    ];
    for integrator in [
        Integrator::Euler,
        Integrator::ImplicitFast,
        Integrator::Implicit,
        Integrator::Rk4,
        Integrator::Discrete,
    ] {
        let mut builder = everything();
        builder.options = RigidOptions::new();
        builder.physics.integrator = integrator;
        assert_eq!(acting(&builder, 100), kinds.into(), "{integrator:?}");
        assert!(compare::<f64>(&builder, RigidOptions::new(), 100) > 0.5);
        let sticking = RigidOptions::new().stiction(true);
        assert!(compare::<f64>(&builder, sticking, 100) > 0.5);
    }
}

#[test]
fn many_steps_in_a_call_are_single_steps() {
    let model = model(&loose_parts());
    let envs: Vec<usize> = (0..ENVS).collect();
    let options = with(Instructions::widest(), 2, RigidOptions::new());
    let (mut one, mut many) = (
        batch::<f64>(&model, &envs, options),
        batch::<f64>(&model, &envs, options),
    );
    for _ in 0..150 {
        one.step().expect("valid");
    }
    many.step_n(149).expect("valid");
    many.step_n(0).expect("valid");
    many.step_n(1).expect("valid");
    for env in envs {
        let end = one.sim(env).expect("it exists").state;
        assert_state(&many, env, &end, &|| "150 steps".into());
    }
}

/// In slots that a neighbour uses, a far-away environment holds very large numbers.
#[test]
fn distant_bodies_move_as_alone() {
    let model = model(&loose_parts());
    let envs: Vec<usize> = (0..ENVS).collect();
    for far in [1e6, 1e8, 9e9] {
        let options = with(Instructions::widest(), 1, RigidOptions::new());
        let mut batch = batch::<f64>(&model, &envs, options);
        batch.step_n(100).expect("valid");
        batch.state.qpos.row_mut(3)[0] = far;
        let mut sim = batch.sim(3).expect("it exists");
        for _ in 0..30 {
            batch.step().expect("valid");
            sim.step().expect("finite");
            assert_eq!(batch.status(3), EnvStatus::Running);
            assert_state(&batch, 3, &sim.state, &|| format!("{far:e} m away"));
        }
    }
}

#[test]
fn pairs_without_multiccd_move_as_alone() {
    let options = options(ConstraintSolver::Newton, FrictionCone::Pyramidal);
    assert!(compare::<f64>(&parts_on_a_mesh(false), options, 100) > 2.0);
}
