//! The drift of trajectories on the device from double precision.

use super::{
    Random, assert_all_run, convert, difference, general_batch, random_state, some_states, upload,
};
use clench_gpu::GpuBatch;
use clench_rigid::batch::Precision;
use clench_rigid::model::Model;
use clench_rigid::{Sim, State};
use std::sync::Arc;

/// Returns the positions that the processor reaches from a state after `steps` steps.
fn arrival<S: Precision>(model: &Arc<Model>, from: &State<f32>, steps: usize) -> Vec<f64> {
    let mut sim = Sim::<S>::new(model.clone()).expect("a good model");
    sim.state = convert(model, from);
    for _ in 0..steps {
        sim.step().expect("a good state");
    }
    sim.state.qpos.iter().map(|q| q.to_f64()).collect()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// Asserts that after `steps` steps from `count` states the median distance of the device from double precision is at
/// most three times that of the processor's single precision.
pub fn drift_alike(model: &Arc<Model>, count: usize, steps: usize) {
    if let Some(mut batch) = general_batch(model, count) {
        batch_drifts_alike(&mut batch, steps);
    }
}

/// Asserts the same of a batch.
pub fn batch_drifts_alike(batch: &mut GpuBatch, steps: usize) {
    let (model, count) = (&batch.model().clone(), batch.count());
    let starts = some_states(model, count);
    upload(batch, &starts);
    batch.step(steps).expect("a device");
    assert_all_run(batch);
    assert_eq!(batch.steps().expect("a device"), vec![steps as u32; count]);
    let qpos = batch.read("qpos").expect("a device");
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for (env, start) in starts.iter().enumerate() {
        let exact = arrival::<f64>(model, start, steps);
        let found: Vec<f64> = qpos[env * model.nq..][..model.nq]
            .iter()
            .map(|&q| f64::from(q))
            .collect();
        ours.push(distance(&found, &exact));
        theirs.push(distance(&arrival::<f32>(model, start, steps), &exact));
    }
    let median = |d: &mut Vec<f64>| {
        d.sort_by(f64::total_cmp);
        d[d.len() / 2]
    };
    let (ours, theirs) = (median(&mut ours), median(&mut theirs));
    assert!(
        ours <= 3.0 * theirs + 1e-6,
        "{}: {ours:.1e} against {theirs:.1e}",
        model.name
    );
}

/// Asserts that `steps` steps reach the states of the processor's double precision.
pub fn doubles_arrive(batch: &mut GpuBatch<f64>, steps: usize) {
    let model = batch.model().clone();
    let mut random = Random::new(3);
    let count = batch.count();
    let states = Vec::from_iter((0..count).map(|_| random_state(&model, &mut random, 0.3)));
    upload(batch, &states);
    batch.step(steps).expect("a device");
    assert_all_run(batch);
    let qpos = batch.read("qpos").expect("a device");
    for (found, state) in qpos.chunks(model.nq).zip(&states) {
        let far = difference(found, &arrival::<f64>(&model, state, steps));
        assert!(far <= 1e-8, "{}: {far:.1e}", model.name);
    }
}
