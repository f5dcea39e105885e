//! What several tests share: random states, and how far the device is from the processor, stage by stage.
#![allow(dead_code)] // Each test uses a part.

use clench_gpu::{GpuBatch, GpuError, GpuOptions, GpuReal, GpuSolve};
use clench_math::{Mat3, Motion, Quat, Scalar, Vec3};
use clench_rigid::batch::Precision;
use clench_rigid::model::{JointKind, Model};
use clench_rigid::{Sim, State};
use std::collections::BTreeMap;
use std::ops::RangeBounds;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A model of this repository.
pub fn model(name: &str) -> Arc<Model> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/");
    Arc::new(clench_formats::load(format!("{path}{name}.xml")).expect("a model of ours loads"))
}

/// Models that are not compared in single precision: light fingers on heavy arms, which what rounding leaves of large forces accelerates
/// (`double.rs` compares them), and a dog of so many dofs and pairs of geoms that Mesa's software device ends its loops early, which is
/// a fault.
const NOT_COMPARED: [&str; 3] = ["dog", "manipulator", "stacker"];

/// Every model of a folder that an environment variable names agrees with the processor on so many states of each, so far from its
/// initial one, but for those whose names are `refused`, which are. Without the variable there is nothing to test.
pub fn agree_on_folder(variable: &str, models: &[(&str, usize, f64)], refused: &[&str]) {
    let Some(folder) = std::env::var_os(variable).map(PathBuf::from) else {
        eprintln!("skipped: {variable} names no folder");
        return;
    };
    let load = |name: &str| public(&folder, name);
    for &(name, count, spread) in models {
        agree(&load(name), count, spread);
    }
    for name in refused {
        let error = GpuBatch::<f32>::new(load(name), 1, GpuOptions::default())
            .expect_err("what can be done is no longer listed as refused");
        assert!(matches!(error, GpuError::Unsupported(_)), "{name}: {error}");
        println!("{name}: {error}");
    }
    let listed = |name: &str| {
        let known = refused.contains(&name) || NOT_COMPARED.contains(&name);
        known || models.iter().any(|m| m.0 == name)
    };
    for file in folder.read_dir().expect("a folder").flatten() {
        let path = file.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let is_model = path.extension().is_some_and(|e| e == "xml");
        assert!(!is_model || listed(&name), "{name} is not listed");
    }
}

/// A model of others, in a folder.
pub fn public(folder: &Path, name: &str) -> Arc<Model> {
    let path = folder.join(format!("{name}.xml"));
    Arc::new(clench_formats::load(path).expect("a public model loads"))
}

/// Models of no more dofs are stepped in every test, larger ones in those that are ignored but where one asks for them: Mesa's software device
/// takes minutes.
pub const SMALL: usize = 10;

/// Every model of a list in a folder that an environment variable names, if its dofs are so many, drifts as on the processor, in 200 steps
/// from 8 states each. Without the variable there is nothing to test.
pub fn drift_on_folder(
    variable: &str,
    models: &[(&str, usize, f64)],
    dofs: impl RangeBounds<usize>,
) {
    let Some(folder) = std::env::var_os(variable).map(PathBuf::from) else {
        eprintln!("skipped: {variable} names no folder");
        return;
    };
    for &(name, ..) in models {
        let model = public(&folder, name);
        if dofs.contains(&model.nv) {
            println!("{name}");
            drift_alike(&model, 8, 200);
        }
    }
}

/// The text of a model in `tests/device/models`.
pub fn own(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/device/models/");
    std::fs::read_to_string(format!("{folder}{name}.xml")).expect("a model of ours is there")
}

/// A model from the text of a file.
pub fn text(file: &str) -> Arc<Model> {
    Arc::new(clench_formats::load_str(file).expect("a model of ours loads"))
}

/// A batch; none where the machine has no device, or the environment variable `CLENCH_GPU` says to skip: then the test has nothing
/// to say. Where that says to require one, none is a failure.
pub fn batch(model: &Arc<Model>, count: usize) -> Option<GpuBatch> {
    let wish = std::env::var("CLENCH_GPU").unwrap_or_default();
    if wish == "skip" {
        return None;
    }
    match GpuBatch::new(model.clone(), count, GpuOptions::default()) {
        Ok(batch) => Some(batch),
        Err(GpuError::NoDevice) if wish != "require" => {
            eprintln!("skipped: {}", GpuError::NoDevice);
            None
        }
        Err(e) => panic!("{e}"),
    }
}

/// Random numbers, the same in every run.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Between −1 and 1.
    pub fn signed(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A state near the initial one, rounded to single precision so that both precisions start from the same numbers: joints turned
/// by up to `spread` of their range or a radian, roots moved by as many metres, velocities of the same size, and all controls.
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

/// The same state in another precision.
pub fn convert<S: Precision>(model: &Model, from: &State<f32>) -> State<S> {
    let mut state = State::<S>::new(model);
    let rows = [
        (&mut state.qpos, &from.qpos),
        (&mut state.qvel, &from.qvel),
        (&mut state.qacc_warmstart, &from.qacc_warmstart),
        (&mut state.ctrl, &from.ctrl),
        (&mut state.act, &from.act),
        (&mut state.qfrc_applied, &from.qfrc_applied),
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
    state
}

fn vector<S: Scalar>([x, y, z]: [S; 3]) -> Vec3<S> {
    Vec3 { x, y, z }
}

/// Gives the states to a batch, one an environment.
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
    for (name, values) in [
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

/// What the processor computed of one environment, by the names of the device's fields.
pub fn computed<S: Precision>(sim: &Sim<S>) -> BTreeMap<&'static str, Vec<f64>> {
    let ws = sim.workspace();
    let (pos, vel, force) = (&ws.position, &ws.velocity, &ws.force);
    let plain = |x: &[S]| x.iter().map(|x| x.to_f64()).collect::<Vec<f64>>();
    let vectors = |v: &[Vec3<S>]| {
        v.iter()
            .flat_map(|v| v.to_array().map(|x| x.to_f64()))
            .collect()
    };
    let quats = |q: &[Quat<S>]| {
        q.iter()
            .flat_map(|q| q.to_array().map(|x| x.to_f64()))
            .collect()
    };
    let matrices = |m: &[Mat3<S>]| {
        let rows = m.iter().flat_map(|m| m.rows);
        rows.flat_map(|r| r.to_array().map(|x| x.to_f64()))
            .collect()
    };
    let motions = |m: &[Motion<S>]| {
        m.iter()
            .flat_map(|m| m.to_array().map(|x| x.to_f64()))
            .collect()
    };
    let mut all = BTreeMap::new();
    all.insert("xpos", vectors(&pos.xpos));
    all.insert("xquat", quats(&pos.xquat));
    all.insert("xmat", matrices(&pos.xmat));
    all.insert("xipos", vectors(&pos.xipos));
    all.insert("ximat", matrices(&pos.ximat));
    all.insert("xanchor", vectors(&pos.xanchor));
    all.insert("xaxis", vectors(&pos.xaxis));
    all.insert("geom_xpos", vectors(&pos.geom_xpos));
    all.insert("geom_xmat", matrices(&pos.geom_xmat));
    all.insert("site_xpos", vectors(&pos.site_xpos));
    all.insert("site_xmat", matrices(&pos.site_xmat));
    all.insert("ten_length", plain(&pos.ten_length));
    all.insert("ten_jacobian", plain(&pos.ten_jacobian));
    all.insert("ten_velocity", plain(&vel.ten_velocity));
    all.insert("actuator_moment", plain(&pos.actuator_moment));
    all.insert("act_dot", plain(&force.act_dot));
    all.insert("qfrc_gravcomp", plain(&force.qfrc_gravcomp));
    all.insert("subtree_com", vectors(&pos.subtree_com));
    all.insert("cdof", motions(&pos.cdof));
    all.insert("cdof_dot", motions(&vel.cdof_dot));
    all.insert("cvel", motions(&vel.cvel));
    all.insert("qm", plain(&ws.problem.mass.values));
    all.insert("actuator_length", plain(&pos.actuator_length));
    all.insert("actuator_velocity", plain(&vel.actuator_velocity));
    all.insert("actuator_force", plain(&force.actuator_force));
    all.insert("qfrc_passive", plain(&force.qfrc_passive));
    all.insert("qfrc_bias", plain(&force.qfrc_bias));
    all.insert("qfrc_actuator", plain(&force.qfrc_actuator));
    all.insert("qfrc_smooth", plain(&force.qfrc_smooth));
    all.insert("qacc_smooth", plain(&ws.problem.qacc_smooth));
    all.insert("qacc", plain(&ws.qacc));
    all.insert("qfrc_constraint", plain(&ws.qfrc_constraint));
    all.insert("contacts", contact_numbers(sim));
    for (name, values) in row_numbers(sim) {
        all.insert(name, values);
    }
    all
}

/// Pair by pair as on the device, but for the number of the pair.
fn contact_numbers<S: Precision>(sim: &Sim<S>) -> Vec<f64> {
    let contacts = sim.contacts().iter();
    let numbers = contacts.flat_map(|c| {
        let place = [c.dist].into_iter().chain(c.pos.to_array());
        let axes = c.frame.rows.into_iter().flat_map(|row| row.to_array());
        place.chain(axes).collect::<Vec<_>>()
    });
    numbers.map(|x| x.to_f64()).collect()
}

/// What the convex problem holds of each row, in order.
fn row_numbers<S: Precision>(sim: &Sim<S>) -> Vec<(&'static str, Vec<f64>)> {
    let ws = sim.workspace();
    let nv = ws.problem.nv();
    let (mut aref, mut r, mut jacobian) = (Vec::new(), Vec::new(), Vec::new());
    for block in ws.problem.blocks() {
        aref.extend(block.aref.iter().map(|x| x.to_f64()));
        r.extend(block.r.iter().map(|x| x.to_f64()));
        for row in block.jacobian.chunks(block.dofs.len()) {
            let mut dense = vec![0.0; nv];
            for (&dof, j) in block.dofs.iter().zip(row) {
                dense[dof as usize] = j.to_f64();
            }
            jacobian.extend(dense);
        }
    }
    let plain = |x: &[S]| x.iter().map(|x| x.to_f64()).collect();
    vec![
        ("aref", aref),
        ("r", r),
        ("jacobian", jacobian),
        ("position", plain(&ws.record.pos)),
        ("velocity", plain(&ws.record.vel)),
    ]
}

/// The largest difference between two rows, over the largest number of the second; another length is no small difference.
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

/// Of a field of one environment: how far the device is from the processor in single precision, from that in double precision,
/// and how far the two are from each other.
#[derive(Clone, Copy, Debug)]
pub struct Distance {
    pub single: f64,
    pub double: f64,
    pub noise: f64,
}

/// How far the device is from the processor: by field, environment by environment.
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

/// The part of a row that is in use; of contacts, what is not the number of their pair.
pub fn used(name: &str, mut row: Vec<f64>, solve: &GpuSolve, nv: usize) -> Vec<f64> {
    match name {
        "contacts" => {
            row.truncate(14 * solve.contacts);
            row = row.chunks(14).flat_map(|c| c[1..].to_vec()).collect();
        }
        "jacobian" => row.truncate(solve.rows * nv),
        "aref" | "r" | "position" | "velocity" => row.truncate(solve.rows),
        _ => {}
    }
    row
}

/// Largest difference of a field, over its largest number.
pub const TOLERANCE: f64 = 1e-4;

/// Asserts that no environment stands still, and that the last pass went well in all.
pub fn assert_all_run<S: GpuReal>(batch: &GpuBatch<S>) {
    for faults in [batch.statuses(), batch.last_faults()] {
        let faults = faults.expect("a device");
        assert!(faults.iter().all(Option::is_none), "{faults:?}");
    }
}

/// Random states of a model on the device, after a forward pass.
fn states(model: &Arc<Model>, count: usize, spread: f64) -> Option<(GpuBatch, Vec<State<f32>>)> {
    let mut random = Random::new(3);
    let states: Vec<_> = (0..count)
        .map(|_| random_state(model, &mut random, spread))
        .collect();
    let mut batch = batch(model, count)?;
    upload(&mut batch, &states);
    batch.forward().expect("a device");
    assert_all_run(&batch);
    Some((batch, states))
}

impl Distance {
    /// Whether the device is within the tolerance of the processor, in either precision, or as near to it as the processor's own
    /// precisions are to each other, in this state or usually: where an impedance is near zero, say, R is the quotient of two
    /// roundings, and a light finger on a heavy arm is moved by what rounding leaves of large forces.
    pub fn is_near(&self, usual_noise: f64, tolerance: f64) -> bool {
        let noise = self.noise.max(usual_noise);
        self.single.min(self.double) <= tolerance.max(3.0 * noise)
    }
}

/// What the processor's precisions differ by in one state of twenty at least.
pub fn usual_noise(found: &[Distance]) -> f64 {
    let mut noises: Vec<f64> = found.iter().map(|d| d.noise).collect();
    noises.sort_by(f64::total_cmp);
    noises[noises.len() * 19 / 20]
}

/// Every field of every state is near the processor's, and most of them are not so because of noise alone.
pub fn agree(model: &Arc<Model>, count: usize, spread: f64) -> Option<GpuBatch> {
    agree_within(TOLERANCE, 0, model, count, spread)
}

/// The same, with a tolerance of its own, which so many states may exceed.
pub fn agree_within(
    tolerance: f64,
    strays: usize,
    model: &Arc<Model>,
    count: usize,
    spread: f64,
) -> Option<GpuBatch> {
    let (batch, states) = states(model, count, spread)?;
    for (name, found) in distances(&batch, &states) {
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
    Some(batch)
}

/// So many random states near the initial one.
pub fn some_states(model: &Model, count: usize) -> Vec<State<f32>> {
    let mut random = Random::new(11);
    (0..count)
        .map(|_| random_state(model, &mut random, 0.3))
        .collect()
}

/// Where the processor gets from a state in so many steps.
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

/// After `steps` steps from `count` states the device is not further from double precision than three times what the processor's single
/// precision is, by the medians.
pub fn drift_alike(model: &Arc<Model>, count: usize, steps: usize) {
    let starts = some_states(model, count);
    let Some(mut batch) = batch(model, count) else {
        return;
    };
    upload(&mut batch, &starts);
    batch.step(steps).expect("a device");
    assert_all_run(&batch);
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
