//! Shared by the tests of batches: scenes whose environments behave differently, and bitwise comparison.

pub use crate::scenes::*;
use clench_collide::ShapeKind;
use clench_math::{Instructions, Vec3};
use clench_rigid::builder::{GeomSpec, ModelBuilder};
use clench_rigid::model::JointKind;
use clench_rigid::options::RigidOptions;
use clench_rigid::state::kind::{Kind, Reference};
use clench_rigid::{Batch, BatchOptions, Model, Precision, Sim, State};
use std::sync::Arc;

/// Returns the humanoid with a user's solver options.
pub fn walker() -> ModelBuilder {
    let mut b = humanoid();
    b.options = RigidOptions::new();
    b
}

/// Builds an arm that swings over a box on the floor and touches it at some times and in some environments.
pub fn arm_and_box() -> ModelBuilder {
    let mut b = world();
    b.options = RigidOptions::new();
    b.bodies[0].geoms.push(plane());
    let (mut parent, mut pos) = (0, [0.0, 0.0, 0.95]);
    for (name, axis) in [
        ("shoulder", [0.0, 1.0, 0.0]),
        ("elbow", [1.0, 0.0, 0.0]),
        ("wrist", [0.0, 1.0, 0.0]),
    ] {
        let mut hinge = joint(JointKind::Hinge, name, axis);
        hinge.range = [-0.9, 0.9];
        hinge.limited = Some(true);
        hinge.frictionloss = 0.05;
        let mut link = geom(ShapeKind::Capsule, [0.03, 0.11, 0.0]);
        link.pos = Vec3::from_f64([0.0, 0.0, -0.12]);
        parent = add(&mut b, parent, name, pos, vec![hinge], vec![link]);
        pos = [0.0, 0.0, -0.25];
    }
    let solid = GeomSpec {
        condim: 4,
        ..cuboid([0.12, 0.1, 0.1])
    };
    add(&mut b, 0, "box", [0.05, 0.0, 0.1], free(), vec![solid]);
    b
}

/// Builds twelve bodies thrown into a box; finally nearly all of them touch.
pub fn many_islands() -> ModelBuilder {
    let mut b = world();
    b.options = RigidOptions::new();
    b.bodies[0].geoms.push(plane());
    for [x, y] in [[0.4, 0.0], [-0.4, 0.0], [0.0, 0.4], [0.0, -0.4]] {
        let wall = if y == 0.0 {
            cuboid([0.1, 0.5, 1.0])
        } else {
            cuboid([0.5, 0.1, 1.0])
        };
        b.bodies[0].geoms.push(wall.at([x, y, 0.9]));
    }
    for k in 0..12 {
        let pos = [
            0.2 * f64::from(k % 3) - 0.2,
            0.2 * f64::from(k / 3 % 2) - 0.1,
            0.15 + 0.21 * f64::from(k / 6),
        ];
        let shape = if k % 4 == 3 {
            cuboid([0.08, 0.07, 0.09])
        } else {
            sphere(0.09)
        };
        add(&mut b, 0, "", pos, free(), vec![shape]);
    }
    b
}

/// Starts environment `env`: throws it in its own direction; every fifth has its equalities switched.
pub fn begin<S: Precision>(env: usize, state: &mut State<S>) {
    let mut numbers = Numbers(env as u64 + 1);
    for v in &mut state.qvel {
        *v = S::new(1.5 * numbers.next());
    }
    for on in &mut state.eq_active {
        *on ^= env % 5 == 4;
    }
}

/// Returns the control `i` of environment `env` in a step.
pub fn control<S: Precision>(env: usize, step: usize, i: usize) -> S {
    let phase = 0.05 * step as f64 + 1.3 * i as f64 + 0.7 * env as f64;
    S::new(phase.sin())
}

/// Returns a simulation of environment `env` at its start.
pub fn alone<S: Precision>(model: &Arc<Model>, options: RigidOptions, env: usize) -> Sim<S> {
    let mut sim = Sim::with_options(model.clone(), options).expect("valid");
    begin(env, &mut sim.state);
    sim
}

/// Sets the controls of a step.
pub fn drive_alone<S: Precision>(sim: &mut Sim<S>, env: usize, step: usize) {
    for (i, ctrl) in sim.state.ctrl.iter_mut().enumerate() {
        *ctrl = control(env, step, i);
    }
}

/// Returns a batch whose row k is environment `envs[k]` at its start.
pub fn batch<S: Precision>(model: &Arc<Model>, envs: &[usize], options: BatchOptions) -> Batch<S> {
    let mut batch = Batch::with_options(model.clone(), envs.len(), options).expect("valid");
    let mut state = State::new(model);
    for (row, &env) in envs.iter().enumerate() {
        begin(env, &mut state);
        batch.state.qvel.row_mut(row).copy_from_slice(&state.qvel);
        let switches = batch.state.eq_active.row_mut(row).iter_mut();
        for (to, &on) in switches.zip(&state.eq_active) {
            *to = u8::from(on);
        }
        state = State::new(model);
    }
    batch
}

/// Sets the controls of a step, where row k is environment `envs[k]`.
pub fn drive<S: Precision>(batch: &mut Batch<S>, envs: &[usize], step: usize) {
    for (row, &env) in envs.iter().enumerate() {
        for (i, ctrl) in batch.state.ctrl.row_mut(row).iter_mut().enumerate() {
            *ctrl = control(env, step, i);
        }
    }
}

pub fn with(instructions: Instructions, threads: usize, options: RigidOptions) -> BatchOptions {
    BatchOptions {
        options,
        instructions: Some(instructions),
        threads: Some(threads),
        grouping: threads != 2,
    }
}

/// Asserts that numbers are equal to the bit.
pub fn assert_bits<S: Precision>(found: &[S], expected: &[S], what: &dyn Fn() -> String) {
    let bits = |x: S| x.to_f64().to_bits();
    let same = found.len() == expected.len()
        && found
            .iter()
            .zip(expected)
            .all(|(&a, &b)| bits(a) == bits(b));
    assert!(
        same,
        "{}: {found:?} where {expected:?} was expected",
        what()
    );
}

/// Asserts that a row of a batch holds this state, to the bit.
pub fn assert_state<S: Precision>(
    batch: &Batch<S>,
    row: usize,
    expected: &State<S>,
    what: &dyn Fn() -> String,
) {
    let rows = &batch.state;
    for (field, found, expected) in [
        ("qpos", &rows.qpos, &expected.qpos),
        ("qvel", &rows.qvel, &expected.qvel),
        ("act", &rows.act, &expected.act),
        ("plastic", &rows.plastic, &expected.plastic),
        ("history", &rows.history, &expected.history),
        ("ctrl", &rows.ctrl, &expected.ctrl),
        ("qfrc_applied", &rows.qfrc_applied, &expected.qfrc_applied),
        (
            "qacc_warmstart",
            &rows.qacc_warmstart,
            &expected.qacc_warmstart,
        ),
        ("pose_asleep", &rows.pose_asleep, &expected.pose_asleep),
        (
            "stick_friction",
            &rows.stick_friction,
            &expected.stick_friction,
        ),
    ] {
        let what = || format!("{}, row {row}: {field}", what());
        assert_bits(found.row(row), expected, &what);
    }
    let references =
        (expected.stick_references.iter()).flat_map(|one| Reference::cells::<S>(one, 0));
    let what_of_references = || format!("{}, row {row}: stick_references", what());
    assert_bits(
        rows.stick_references.row(row),
        &Vec::from_iter(references),
        &what_of_references,
    );
    assert_bits(rows.time.row(row), &[expected.time], what);
    let trees = rows.tree_asleep.row(row).iter();
    let trees = Vec::from_iter(trees.map(|&tree| S::new(f64::from(tree))));
    let what_of_trees = || format!("{}, row {row}: tree_asleep", what());
    assert_bits(&trees, &expected.tree_asleep, &what_of_trees);
    let switches = rows.eq_active.row(row).iter().map(|&on| on != 0);
    assert!(
        switches.eq(expected.eq_active.iter().copied()),
        "{}, row {row}: eq_active",
        what()
    );
}
