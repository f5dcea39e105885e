//! Constraints that are added at run time on a device: each environment has its own, and they act as on the processor.

use crate::common::{self, Random, computed, difference, own, random_state, text, used};
use clench_gpu::{GpuBatch, GpuReal};
use clench_math::{Scalar, Vec3};
use clench_rigid::batch::{EnvStatus, Precision};
use clench_rigid::model::Model;
use clench_rigid::options::RigidOptions;
use clench_rigid::{Batch, BatchOptions, Sim};
use std::sync::Arc;

const COUNT: usize = 24;

/// The pairs of bodies that are tied: of separate trees, of one chain, of rigidly connected bodies, and static ones.
const PAIRS: [[&str; 2]; 6] = [
    ["hand", "box"],
    ["box", "cup"],
    ["post", "ball"],
    ["arm", "cup"],
    ["cup", "hand"],
    ["world", "box"],
];

fn body(model: &Model, name: &str) -> usize {
    let found = model.bodies.iter().position(|body| body.name == name);
    found.expect("a body of the model")
}

/// Returns simulations in random states that violate constraints which were added in other states: none in the first,
/// then up to three. Some slots name bodies that cannot be tied.
fn tied<S: Precision>(model: &Arc<Model>) -> Vec<Sim<S>> {
    let mut random = Random::new(7);
    let mut sims = Vec::new();
    for env in 0..COUNT {
        let mut sim = Sim::<S>::new(model.clone()).expect("a good model");
        sim.state = common::convert(model, &random_state(model, &mut random, 0.2));
        for k in 0..env % 4 {
            let [one, other] = PAIRS[(env + k) % PAIRS.len()].map(|name| body(model, name));
            let added = if (env + k) % 3 == 0 {
                let anchor = [0.1, -0.05, 0.02].map(S::new);
                sim.add_connect(one, other, Vec3::from_array(anchor))
            } else {
                sim.add_weld(one, other)
            };
            added.expect("a free slot");
        }
        let moved = common::convert::<S>(model, &random_state(model, &mut random, 0.2));
        (sim.state.qpos, sim.state.qvel) = (moved.qpos, moved.qvel);
        let state = &mut sim.state;
        let [one, other, kind] = match env % 5 {
            0 => [2.0, 2.0, 2.0],
            1 => [2.0, 99.0, 1.0],
            2 => [0.0, body(model, "post") as f64, 2.0],
            3 => [1.5, 2.0, 2.0],
            _ => [1.0, 4.0, 3.0],
        };
        let last = state.dynamic_kind.len() - 1;
        state.dynamic_kind[last] = S::new(kind);
        state.dynamic_body1[last] = S::new(one);
        state.dynamic_body2[last] = S::new(other);
        state.dynamic_quat[last].w = S::new(1.0);
        sims.push(sim);
    }
    sims
}

/// Uploads the states of simulations, with their slots.
fn upload<S: GpuReal>(batch: &mut GpuBatch<S>, sims: &[Sim<S>]) {
    let rows = |row: &dyn Fn(&Sim<S>) -> Vec<S>| Vec::from_iter(sims.iter().flat_map(row));
    let vectors = |v: &[Vec3<S>]| Vec::from_iter(v.iter().flat_map(|v| v.to_array()));
    for (name, values) in [
        ("qpos", rows(&|s| s.state.qpos.clone())),
        ("qvel", rows(&|s| s.state.qvel.clone())),
        ("qacc_warmstart", rows(&|s| s.state.qacc_warmstart.clone())),
        ("dynamic_kind", rows(&|s| s.state.dynamic_kind.clone())),
        ("dynamic_body1", rows(&|s| s.state.dynamic_body1.clone())),
        ("dynamic_body2", rows(&|s| s.state.dynamic_body2.clone())),
        (
            "dynamic_anchor1",
            rows(&|s| vectors(&s.state.dynamic_anchor1)),
        ),
        (
            "dynamic_anchor2",
            rows(&|s| vectors(&s.state.dynamic_anchor2)),
        ),
        (
            "dynamic_quat",
            rows(&|s| Vec::from_iter(s.state.dynamic_quat.iter().flat_map(|q| q.to_array()))),
        ),
    ] {
        batch.write(name, &values).expect("good states");
    }
}

/// Asserts that every field of each environment is the processor's, except for the rounding of `tolerance`.
fn forward_agrees<S: GpuReal>(model: &Arc<Model>, tolerance: f64) {
    let Some(mut batch) = common::batch_in::<S>(model, COUNT) else {
        return;
    };
    batch.enable_dynamic_constraints().expect("memory");
    let mut sims = tied::<S>(model);
    upload(&mut batch, &sims);
    batch.forward().expect("a device");
    common::assert_all_run(&batch);
    let solves = batch.solves().expect("a device");
    let mut ties = 0;
    for (env, sim) in sims.iter_mut().enumerate() {
        sim.forward().expect("a good state");
        for (name, expected) in computed(sim) {
            let width = batch.width(name).expect("a field");
            let all = batch.read(name).expect("a device");
            let row = all[env * width..][..width].iter().map(|x| x.to_f64());
            let found = used(name, row.collect(), &solves[env], model.nv);
            let far = difference(&found, &expected);
            assert!(far <= tolerance, "{name} of environment {env}: {far:.1e}");
        }
        ties += sim.dynamic_constraints().count();
    }
    assert!(ties > COUNT, "{ties} constraints that were added");
}

#[test]
fn rows_of_slots_are_those_of_the_processor() {
    let model = text(&own("held"));
    forward_agrees::<f32>(&model, 1e-4);
    forward_agrees::<f64>(&model, 1e-9);
}

fn largest_gap<S: Scalar>(found: &[S], expected: &[S]) -> f64 {
    let gaps = found
        .iter()
        .zip(expected)
        .map(|(a, b)| (a.to_f64() - b.to_f64()).abs());
    gaps.fold(0.0, f64::max)
}

/// Returns a batch on the device and one on the processor in the same random states; `None` without a device.
fn both<S: GpuReal>(model: &Arc<Model>, options: RigidOptions) -> Option<[Batch<S>; 2]> {
    let options = BatchOptions {
        options,
        ..BatchOptions::default()
    };
    let device = common::stepped(model, COUNT, options)?;
    let processor = Batch::with_options(model.clone(), COUNT, options).expect("a good model");
    let mut batches = [device, processor];
    let mut random = Random::new(3);
    for env in 0..COUNT {
        let state = common::convert(model, &random_state(model, &mut random, 0.2));
        for batch in &mut batches {
            batch.state.write(env, &state).expect("a row");
        }
    }
    Some(batches)
}

/// Constraints are added between steps, act, are stored and restored with the state, and removed.
fn batches_agree<S: GpuReal>(tolerance: f64) {
    let model = text(&own("held"));
    let Some([mut device, mut processor]) = both::<S>(&model, RigidOptions::new()) else {
        return;
    };
    let [hand, cup, held, ball] = ["hand", "cup", "box", "ball"].map(|name| body(&model, name));
    let outputs = ["cfrc_int", "cfrc_ext", "sensordata", "qfrc_constraint"];
    let bytes = device.bytes_per_env();
    for batch in [&mut device, &mut processor] {
        batch.record(&outputs).expect("they are computed");
        batch.step_n(10).expect("good states");
        let grips = batch.add_weld(&[1, 5, 9], cup, held).expect("free slots");
        batch.step_n(10).expect("good states");
        let anchor = Vec3::from_array([0.1, 0.0, 0.0].map(S::new));
        batch
            .add_connect(&[5, 6], ball, hand, anchor)
            .expect("free slots");
        let kept = batch.save().expect("rows");
        batch.step_n(20).expect("good states");
        batch.restore(&kept).expect("the same model");
        batch.step_n(20).expect("good states");
        batch
            .remove(&[1, 9], &[grips[0], grips[2]])
            .expect("they exist");
        batch.weld_here(&[2], 0).expect("a connect");
        batch.reset(6).expect("an environment");
        assert_eq!(batch.step_n(5).expect("good states").running, COUNT);
    }
    assert!(device.bytes_per_env() > bytes, "slots need memory");
    for env in 0..COUNT {
        let gap = largest_gap(device.state.qpos.row(env), processor.state.qpos.row(env));
        assert!(gap <= tolerance, "qpos of environment {env}: {gap:.1e}");
        for name in outputs {
            let rows = [&device, &processor].map(|batch| batch.output(name).expect("recorded"));
            let of = |k: usize| Vec::from_iter(rows[k].row(env).iter().map(|x| x.to_f64()));
            let far = difference(&of(0), &of(1));
            assert!(
                far <= 100.0 * tolerance,
                "{name} of environment {env}: {far:.1e}"
            );
        }
    }
    let [mut plain, _] = both::<S>(&model, RigidOptions::new()).expect("a device");
    plain.step_n(45).expect("good states");
    for env in [0, 5, 9] {
        let without = largest_gap(device.state.qpos.row(env), plain.state.qpos.row(env));
        assert_eq!(without > 1e-3, env != 0, "environment {env}: {without:.1e}");
    }
    assert_eq!(
        device.state.dynamic_kind.row(5)[..2],
        [S::new(2.0), S::new(1.0)].map(|x| x.to_f64() as i32)
    );
    assert!(
        device
            .state
            .dynamic_kind
            .row(6)
            .iter()
            .all(|&kind| kind == 0)
    );
}

#[test]
fn constraints_are_added_and_removed_as_on_the_processor() {
    batches_agree::<f32>(1e-4);
    batches_agree::<f64>(1e-9);
}

#[test]
fn a_reset_frees_slots() {
    let model = text(&own("held"));
    let options = RigidOptions::new().autoreset(true);
    let Some([mut device, _]) = both::<f32>(&model, options) else {
        return;
    };
    let [cup, held] = ["cup", "box"].map(|name| body(&model, name));
    device.add_weld(&[3, 4], cup, held).expect("free slots");
    device.state.qfrc_applied.row_mut(3)[1] = 1e30;
    device.step_n(3).expect("a device");
    assert_eq!(device.resets()[..5], [0, 0, 0, 1, 0]);
    let used = |env: usize| device.state.dynamic_kind.row(env)[0];
    assert_eq!([used(3), used(4)], [0, 2]);
    assert_eq!(device.status(3), EnvStatus::Running);
}

/// The kernels of a batch without constraints know no slots, and those with them are compiled once.
#[test]
fn slots_are_reserved_on_request() {
    let model = text(&own("held"));
    let Some(mut batch) = common::batch(&model, 2) else {
        return;
    };
    let before = (batch.bytes_per_env(), batch.width("dynamic_kind"));
    batch.step(3).expect("a device");
    let qpos = batch.read("qpos").expect("a device");
    batch.enable_dynamic_constraints().expect("memory");
    assert_eq!(batch.read("qpos").expect("a device"), qpos);
    assert_eq!((before.1, batch.width("dynamic_kind")), (Some(0), Some(8)));
    assert!(batch.bytes_per_env() > before.0);
    let mut many = (*model).clone();
    many.max_dynamic_constraints = 1 << 20;
    let mut many = common::batch(&Arc::new(many), 2).expect("a device");
    let error = many.enable_dynamic_constraints().expect_err("too many");
    assert!(
        error.to_string().contains("max_dynamic_constraints"),
        "{error}"
    );
}
