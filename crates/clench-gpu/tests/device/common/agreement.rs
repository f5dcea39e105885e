//! The distance of the device from the processor, stage by stage, and its tolerance.

use super::{Random, assert_all_run, computed, convert, general_batch, random_state, upload, used};
use clench_gpu::GpuBatch;
use clench_rigid::model::Model;
use clench_rigid::{Sim, State};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Returns the largest difference between two rows relative to the largest number of the second; infinity if the
/// lengths differ.
pub fn difference(found: &[f64], expected: &[f64]) -> f64 {
    if found.len() != expected.len() {
        return f64::INFINITY;
    }
    let scale = expected.iter().fold(1e-6f64, |most, x| most.max(x.abs()));
    let gaps = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
    let larger = |most: f64, gap: f64| {
        if gap > most || gap.is_nan() {
            gap
        } else {
            most
        }
    };
    gaps.fold(0.0, larger) / scale
}

/// For a field of one environment: the distance of the device from the processor in single and in double precision, and
/// the distance between these two.
#[derive(Clone, Copy, Debug)]
pub struct Distance {
    pub single: f64,
    pub double: f64,
    pub noise: f64,
}

/// Computes the distances of the device from the processor: by field, one per environment.
pub fn distances(batch: &GpuBatch, states: &[State<f32>]) -> BTreeMap<&'static str, Vec<Distance>> {
    let model = batch.model().clone();
    let mut single = Sim::<f32>::new(model.clone()).expect("a good model");
    let mut double = Sim::<f64>::new(model.clone()).expect("a good model");
    let mut all: BTreeMap<&'static str, Vec<Distance>> = BTreeMap::new();
    let mut read: BTreeMap<&'static str, Vec<f32>> = BTreeMap::new();
    let solves = batch.solves().expect("a device");
    for (env, state) in states.iter().enumerate() {
        single.state = convert(&model, state);
        double.state = convert(&model, state);
        single.forward().expect("a good state");
        double.forward().expect("a good state");
        let exact = computed(&double);
        for (name, rounded) in computed(&single) {
            let width = batch.width(name).expect("a field");
            let values = (read.entry(name)).or_insert_with(|| batch.read(name).expect("a device"));
            let row = values[env * width..(env + 1) * width].iter();
            let found = used(
                name,
                row.map(|&x| f64::from(x)).collect(),
                &solves[env],
                model.nv,
            );
            all.entry(name).or_default().push(Distance {
                single: difference(&found, &rounded),
                double: difference(&found, &exact[name]),
                noise: difference(&rounded, &exact[name]),
            });
        }
    }
    all
}

/// The tolerance of a field, relative to its largest number.
pub const TOLERANCE: f64 = 1e-4;

impl Distance {
    /// Returns true if the device is within the tolerance of the processor, in either precision, or within three times
    /// the noise of the processor's precisions, in this state or usually. For example, R is the quotient of two
    /// roundings where an impedance is near zero, and rounding errors of large forces move a light finger on a heavy
    /// arm.
    pub fn is_near(&self, usual_noise: f64, tolerance: f64) -> bool {
        let noise = self.noise.max(usual_noise);
        self.single.min(self.double) <= tolerance.max(3.0 * noise)
    }
}

/// Returns the 95th percentile of the difference of the processor's precisions.
pub fn usual_noise(found: &[Distance]) -> f64 {
    let mut noises: Vec<f64> = found.iter().map(|d| d.noise).collect();
    noises.sort_by(f64::total_cmp);
    noises[noises.len() * 19 / 20]
}

/// Asserts that every field of every state is near the processor's, and that most of them are within the tolerance.
pub fn agree(model: &Arc<Model>, count: usize, spread: f64) -> Option<GpuBatch> {
    agree_within(TOLERANCE, 0, model, count, spread)
}

/// Asserts the same with a given tolerance, which `strays` states may exceed.
pub fn agree_within(
    tolerance: f64,
    strays: usize,
    model: &Arc<Model>,
    count: usize,
    spread: f64,
) -> Option<GpuBatch> {
    let mut batch = general_batch(model, count)?;
    forward_agrees(&mut batch, tolerance, strays, spread);
    Some(batch)
}

/// Asserts that every field of a random state in each environment is near the processor's after a forward pass, except
/// for `strays` states.
pub fn forward_agrees(batch: &mut GpuBatch, tolerance: f64, strays: usize, spread: f64) {
    let model = batch.model().clone();
    let count = batch.count();
    let mut random = Random::new(3);
    let states = Vec::from_iter((0..count).map(|_| random_state(&model, &mut random, spread)));
    forward_agrees_in(batch, &states, tolerance, strays);
}

/// Asserts the same of given states.
pub fn forward_agrees_in(
    batch: &mut GpuBatch,
    states: &[State<f32>],
    tolerance: f64,
    strays: usize,
) {
    let model = batch.model().clone();
    let count = states.len();
    upload(batch, states);
    batch.forward().expect("a device");
    assert_all_run(batch);
    for (name, found) in distances(batch, states) {
        let usual = usual_noise(&found);
        let mut far = (0..count).filter(|&env| !found[env].is_near(usual, tolerance));
        if let Some(env) = far.nth(strays) {
            panic!("{}: {name} of state {env}: {:?}", model.name, found[env]);
        }
        let noisy = found.iter().filter(|d| d.single.min(d.double) > tolerance);
        assert!(
            4 * noisy.count() <= count,
            "{}: {name} is mostly noise",
            model.name
        );
    }
}

/// Asserts that every field of every state is within `tolerance` of the processor's in double precision.
pub fn forward_agrees_in_double(batch: &mut GpuBatch<f64>, states: &[State<f32>], tolerance: f64) {
    let model = batch.model().clone();
    upload(batch, states);
    batch.forward().expect("a device");
    assert_all_run(batch);
    let solves = batch.solves().expect("a device");
    let mut sim = Sim::<f64>::new(model.clone()).expect("a good model");
    let mut read = BTreeMap::new();
    for (env, state) in states.iter().enumerate() {
        sim.state = convert(&model, state);
        sim.forward().expect("a good state");
        for (name, expected) in computed(&sim) {
            let width = batch.width(name).expect("a field");
            let values = read
                .entry(name)
                .or_insert_with(|| batch.read(name).expect("a device"));
            let row = values[env * width..(env + 1) * width].to_vec();
            let found = used(name, row, &solves[env], model.nv);
            let far = difference(&found, &expected);
            assert!(
                far <= tolerance,
                "{}: {name} of state {env}: {far:.1e}",
                model.name
            );
        }
    }
}
