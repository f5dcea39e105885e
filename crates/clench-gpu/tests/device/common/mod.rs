//! Shared helpers: models, batches and random states here, and the distance of the device from the processor in the
//! other files.
#![allow(dead_code)] // Each test uses a part.

mod agreement;
mod computed;
mod drift;
pub mod efforts;
pub mod folders;

pub use agreement::*;
pub use computed::*;
pub use drift::*;

use clench_gpu::{GpuBatch, GpuError, GpuOptions, GpuReal};
use clench_math::{Scalar, Vec3};
use clench_rigid::batch::Precision;
use clench_rigid::model::{JointKind, Model};
use clench_rigid::options::RigidOptions;
use clench_rigid::state::kind::{Kind, Reference, StickReference};
use clench_rigid::{Batch, BatchOptions, State};
use std::sync::Arc;

/// Loads a model of this repository.
pub fn model(name: &str) -> Arc<Model> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/");
    Arc::new(clench_formats::load(format!("{path}{name}.xml")).expect("a model of ours loads"))
}

/// Returns the text of a model in `tests/device/models`.
pub fn own(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/device/models/");
    std::fs::read_to_string(format!("{folder}{name}.xml")).expect("a model of ours is there")
}

/// Loads a model from the text of a file.
pub fn text(file: &str) -> Arc<Model> {
    Arc::new(clench_formats::load_str(file).expect("a model of ours loads"))
}

/// Returns a batch with kernels specialized for its model, the default; `None` if there is no device.
pub fn batch(model: &Arc<Model>, count: usize) -> Option<GpuBatch> {
    batch_in(model, count)
}

/// Returns a batch with kernels for any model, which Mesa's slow software device compiles once for all tests. If the
/// environment variable `CLENCH_GPU_KERNELS` is `own`, the kernels are specialized for the model.
pub fn general_batch<S: GpuReal>(model: &Arc<Model>, count: usize) -> Option<GpuBatch<S>> {
    try_general_batch(model, count, RigidOptions::new()).unwrap_or_else(|e| panic!("{e}"))
}

/// Returns such a batch with options, or an error if the device refuses the model.
pub fn try_general_batch<S: GpuReal>(
    model: &Arc<Model>,
    count: usize,
    options: RigidOptions,
) -> Result<Option<GpuBatch<S>>, GpuError> {
    let general_kernels = std::env::var_os("CLENCH_GPU_KERNELS").is_none_or(|wish| wish != "own");
    let options = GpuOptions {
        options,
        general_kernels,
        ..GpuOptions::default()
    };
    with_options(model, count, options)
}

/// Returns a batch with kernels for any model in double precision, which many tests share, and with specialized ones in
/// single precision.
pub fn batch_in<S: GpuReal>(model: &Arc<Model>, count: usize) -> Option<GpuBatch<S>> {
    match shares_kernels::<S>() {
        true => general_batch(model, count),
        false => {
            with_options(model, count, GpuOptions::default()).unwrap_or_else(|e| panic!("{e}"))
        }
    }
}

fn shares_kernels<S>() -> bool {
    size_of::<S>() == size_of::<f64>()
}

/// Returns a batch of `clench-rigid` that a device steps, with the kernels of [`batch_in`].
pub fn stepped<S: GpuReal>(
    model: &Arc<Model>,
    count: usize,
    options: BatchOptions,
) -> Option<Batch<S>> {
    if shares_kernels::<S>() {
        return general_stepped(model, count, options);
    }
    let create = || clench_gpu::batch(model.clone(), count, options, None);
    unless_skipped(create).unwrap_or_else(|e| panic!("{e}"))
}

/// Returns such a batch with kernels for any model.
pub fn general_stepped<S: GpuReal>(
    model: &Arc<Model>,
    count: usize,
    options: BatchOptions,
) -> Option<Batch<S>> {
    let backend = try_general_batch::<S>(model, count, options.options);
    let backend = Box::new(backend.unwrap_or_else(|e| panic!("{e}"))?);
    Some(Batch::with_backend(model.clone(), count, options, backend).expect("a good model"))
}

fn with_options<S: GpuReal>(
    model: &Arc<Model>,
    count: usize,
    options: GpuOptions,
) -> Result<Option<GpuBatch<S>>, GpuError> {
    unless_skipped(|| GpuBatch::new(model.clone(), count, options))
}

/// Creates a batch, or returns `None` to skip the test if there is no device of this precision or the environment
/// variable `CLENCH_GPU` is `skip`. If it is `require`, a missing device is a failure.
fn unless_skipped<T>(create: impl FnOnce() -> Result<T, GpuError>) -> Result<Option<T>, GpuError> {
    let wish = std::env::var("CLENCH_GPU").unwrap_or_default();
    if wish == "skip" {
        return Ok(None);
    }
    match create() {
        Ok(batch) => Ok(Some(batch)),
        Err(error @ GpuError::NoDoublePrecision { .. }) => {
            eprintln!("skipped: {error}");
            Ok(None)
        }
        Err(GpuError::NoDevice) if wish != "require" => {
            eprintln!("skipped: {}", GpuError::NoDevice);
            Ok(None)
        }
        Err(error) => Err(error),
    }
}

/// A reproducible generator of random numbers.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Returns a number between −1 and 1.
    pub fn signed(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Returns a state near the initial one, rounded to single precision so that both precisions start from the same
/// numbers: joints rotated by up to `spread` of their range or a radian, roots moved by as many metres, velocities of
/// the same size, and all controls.
pub fn random_state(model: &Model, random: &mut Random, spread: f64) -> State<f32> {
    let mut state = State::<f32>::new(model);
    for (j, joint) in model.joints.iter().enumerate() {
        let q = &mut state.qpos[joint.qpos..];
        match joint.kind {
            JointKind::Free => {
                for x in &mut q[..3] {
                    *x += (0.1 * spread * random.signed()) as f32;
                }
                turn(&mut q[3..], random, spread);
            }
            JointKind::Ball => turn(q, random, spread),
            JointKind::Slide => q[0] += (0.1 * spread * random.signed()) as f32,
            JointKind::Hinge => {
                let [low, high] = model.params.jnt_range[j];
                let width = if joint.limited {
                    0.6 * (high - low)
                } else {
                    1.0
                };
                q[0] += (spread * width * random.signed()) as f32;
            }
        }
    }
    for v in &mut state.qvel {
        *v = (spread * random.signed()) as f32;
    }
    for v in &mut state.qacc_warmstart {
        *v = random.signed() as f32;
    }
    for u in &mut state.ctrl {
        *u = (1.5 * random.signed()) as f32;
    }
    for a in &mut state.act {
        *a = random.signed() as f32;
    }
    state
}

fn turn(q: &mut [f32], random: &mut Random, spread: f64) {
    for x in &mut q[..4] {
        *x += (0.5 * spread * random.signed()) as f32;
    }
}

/// Converts a state to another precision.
pub fn convert<S: Precision>(model: &Model, from: &State<f32>) -> State<S> {
    let mut state = State::<S>::new(model);
    let rows = [
        (&mut state.qpos, &from.qpos),
        (&mut state.qvel, &from.qvel),
        (&mut state.qacc_warmstart, &from.qacc_warmstart),
        (&mut state.ctrl, &from.ctrl),
        (&mut state.act, &from.act),
        (&mut state.qfrc_applied, &from.qfrc_applied),
        (&mut state.stick_friction, &from.stick_friction),
    ];
    for (to, from) in rows {
        for (to, &from) in to.iter_mut().zip(from) {
            *to = S::new(f64::from(from));
        }
    }
    for (to, from) in state.xfrc_applied.iter_mut().zip(&from.xfrc_applied) {
        let wide = |v: Vec3<f32>| v.to_array().map(|x| S::new(f64::from(x)));
        *to = clench_math::Force::new(vector(wide(from.angular)), vector(wide(from.linear)));
    }
    for (to, from) in state
        .stick_references
        .iter_mut()
        .zip(&from.stick_references)
    {
        let numbers = Reference::cells(from, 0).map(|x| S::new(f64::from(x)));
        Reference::set_cells(to, 0, numbers);
    }
    state
}

/// Returns the numbers of stick references.
pub fn reference_numbers<S: Scalar>(list: &[StickReference<S>]) -> Vec<f64> {
    let cells = list.iter().flat_map(|one| Reference::cells(one, 0));
    cells.map(|x: S| x.to_f64()).collect()
}

fn vector<S: Scalar>([x, y, z]: [S; 3]) -> Vec3<S> {
    Vec3 { x, y, z }
}

/// Uploads the states to a batch, one per environment.
pub fn upload<S: GpuReal>(batch: &mut GpuBatch<S>, states: &[State<f32>]) {
    let number = |x: f32| S::new(f64::from(x));
    let rows = |pick: fn(&State<f32>) -> &Vec<f32>| -> Vec<S> {
        states
            .iter()
            .flat_map(|s| pick(s).iter().map(|&x| number(x)))
            .collect()
    };
    let wrenches = states.iter().flat_map(|s| &s.xfrc_applied);
    let wrenches =
        wrenches.flat_map(|f| f.linear.to_array().into_iter().chain(f.angular.to_array()));
    let references = states
        .iter()
        .flat_map(|s| reference_numbers(&s.stick_references));
    for (name, values) in [
        ("stick_references", references.map(S::new).collect()),
        ("stick_friction", rows(|s| &s.stick_friction)),
        ("qpos", rows(|s| &s.qpos)),
        ("qvel", rows(|s| &s.qvel)),
        ("qacc_warmstart", rows(|s| &s.qacc_warmstart)),
        ("ctrl", rows(|s| &s.ctrl)),
        ("act", rows(|s| &s.act)),
        ("qfrc_applied", rows(|s| &s.qfrc_applied)),
        ("xfrc_applied", wrenches.map(number).collect()),
    ] {
        batch.write(name, &values).expect("a good state");
    }
}

/// Asserts that no environment has stopped, and that the last pass succeeded in all.
pub fn assert_all_run<S: GpuReal>(batch: &GpuBatch<S>) {
    for faults in [batch.statuses(), batch.last_faults()] {
        let faults = faults.expect("a device");
        assert!(faults.iter().all(Option::is_none), "{faults:?}");
    }
}

/// Returns `count` random states near the initial one.
pub fn some_states(model: &Model, count: usize) -> Vec<State<f32>> {
    let mut random = Random::new(11);
    (0..count)
        .map(|_| random_state(model, &mut random, 0.3))
        .collect()
}
