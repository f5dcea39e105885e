//! Sleep: in every step the same trees sleep as on the processor.

use crate::common::{self, difference, own, reference_numbers, text};
use clench_gpu::GpuReal;
use clench_math::Vec3;
use clench_rigid::model::Model;
use clench_rigid::options::{MaxContacts, RigidOptions};
use clench_rigid::{Batch, BatchOptions, Sim, State};
use std::sync::Arc;

/// Changes a state before a step, given the number of its environment.
pub type Disturb<S> = fn(usize, usize, &mut State<S>);

pub fn options() -> BatchOptions {
    BatchOptions {
        options: RigidOptions {
            max_contacts: Some(MaxContacts::Limit(60)),
            ..RigidOptions::default()
        },
        ..BatchOptions::default()
    }
}

/// Returns a batch, or `None` if the test is skipped for want of a device of this precision.
pub fn batch<S: GpuReal>(model: &Arc<Model>, count: usize) -> Option<Batch<S>> {
    common::stepped(model, count, options())
}

/// Returns the counters of an environment, and the device's.
fn counters<S: GpuReal>(batch: &Batch<S>, env: usize, sim: &Sim<S>) -> [Vec<i32>; 2] {
    let found = batch.state.tree_asleep.row(env).to_vec();
    let expected = sim.state.tree_asleep.iter().map(|x| x.to_f64() as i32);
    [found, expected.collect()]
}

/// A comparison with the processor.
pub struct Comparison<S: GpuReal> {
    pub steps: usize,
    /// The largest difference of positions; outputs may differ by ten times as much.
    pub tolerance: f64,
    /// True if each step starts from the processor's state.
    pub from_same: bool,
    pub disturb: Disturb<S>,
}

/// The number of environments.
pub const COUNT: usize = 3;

/// Asserts that in each step the same trees sleep as on the processor, and that positions, the memory of friction that
/// sticks, and outputs agree. Returns the share of trees that slept, and the number of times that any woke; `None` if
/// there is no device.
pub fn sleeps_alike<S: GpuReal>(
    model: &Arc<Model>,
    outputs: &[&str],
    comparison: &Comparison<S>,
) -> Option<(f64, usize)> {
    let &Comparison {
        steps,
        tolerance,
        from_same,
        disturb,
    } = comparison;
    let mut batch = batch::<S>(model, COUNT)?;
    batch.record(outputs).expect("the device computes them");
    let mut sims = Vec::from_iter((0..COUNT).map(|_| Sim::<S>::new(model.clone()).expect("valid")));
    let mut state = State::<S>::new(sims[0].model());
    let (mut asleep, mut wakes) = (0, 0);
    for step in 0..steps {
        for (env, sim) in sims.iter_mut().enumerate() {
            match from_same {
                true => state.copy_from(&sim.state),
                false => batch.state.read(env, &mut state).expect("a row"),
            }
            disturb(env, step, &mut state);
            batch.state.write(env, &state).expect("a row");
            disturb(env, step, &mut sim.state);
        }
        batch.step().expect("a device");
        for (env, sim) in sims.iter_mut().enumerate() {
            let slept = Vec::from_iter(sim.state.tree_asleep.iter().map(|x| x.to_f64() >= 0.0));
            sim.step().expect("finite");
            let [found, expected] = counters(&batch, env, sim);
            let what = format!("step {step} of environment {env}");
            assert_eq!(found, expected, "{what}");
            let far = apart(batch.state.qpos.row(env), &sim.state.qpos);
            assert!(far <= tolerance, "{what}: {far:.1e}");
            let far = apart(
                batch.state.stick_friction.row(env),
                &sim.state.stick_friction,
            );
            assert!(far <= tolerance, "{what}: dry friction: {far:.1e}");
            let found = batch.state.stick_references.row(env);
            let found = Vec::from_iter(found.iter().map(|x| x.to_f64()));
            let far = apart(&found, &reference_numbers(&sim.state.stick_references));
            assert!(far <= tolerance, "{what}: stick references: {far:.1e}");
            for name in outputs {
                let found = batch.output(name).expect("recorded").row(env);
                let far = apart(found, &sim.output(name).expect("there"));
                assert!(far <= 10.0 * tolerance, "{what}: {name}: {far:.1e}");
            }
            let now = Vec::from_iter(expected.iter().map(|&x| x >= 0));
            asleep += now.iter().filter(|&&asleep| asleep).count();
            wakes += slept
                .iter()
                .zip(&now)
                .filter(|pair| matches!(pair, (true, false)))
                .count();
        }
    }
    let share = asleep as f64 / (COUNT * steps * model.ntree()) as f64;
    Some((share, wakes))
}

/// Returns the largest difference, relative to the largest number or 1: accelerations of bodies at rest are near zero.
pub fn apart<S: GpuReal>(found: &[S], expected: &[S]) -> f64 {
    let with_one = |x: &[S]| Vec::from_iter(x.iter().map(|x| x.to_f64()).chain([1.0]));
    difference(&with_one(found), &with_one(expected))
}

/// Wakes trees of `nap` in many ways, at times that differ between environments.
pub fn disturb_nap<S: GpuReal>(env: usize, step: usize, state: &mut State<S>) {
    let number = |x: f64| S::new(x);
    let at = |time: usize| step == time + 3 * env;
    if step == 0 {
        state.qvel[0] = number(0.1 * env as f64);
    }
    if at(150) {
        // The ball begins asleep in mid air, and falls on the stack.
        state.qvel[20] = number(-0.0);
    }
    if at(260) {
        state.mocap_pos[0].y += number(-0.1);
    }
    if at(300) {
        // It touches the third box.
        let [x, y, z] = [1.149, 0.0, 0.1].map(number);
        state.mocap_pos[0] = Vec3 { x, y, z };
    }
    if at(340) {
        state.mocap_pos[0].x += number(1.0);
    }
    state.qfrc_applied[26] = number(if at(360) { 1e-9 } else { 0.0 });
    state.xfrc_applied[3].linear.x = number(if at(370) { 30.0 } else { 0.0 });
    for (k, active) in state.eq_active.iter_mut().enumerate() {
        if at(380 + 30 * k) {
            *active = true;
        }
    }
    if at(420) {
        // The rope becomes taut, and wakes the slide at its other end.
        state.qvel[27] = number(3.0);
    }
    state.ctrl[0] = number(0.02 * (0.1 * step as f64).sin());
}

#[test]
fn trees_sleep_and_wake_as_on_the_processor() {
    let comparison = Comparison::<f64> {
        steps: 600,
        tolerance: 1e-9,
        from_same: false,
        disturb: disturb_nap,
    };
    let outputs = ["xpos", "qacc", "qfrc_constraint", "contact_count"];
    if let Some((asleep, wakes)) = sleeps_alike(&text(&own("nap")), &outputs, &comparison) {
        assert!(
            (0.2..0.9).contains(&asleep) && wakes > 20,
            "{asleep} {wakes}"
        );
    }
}

/// The numbers that decide are those at the start of a step, which are the same here.
#[test]
fn so_they_do_in_single_precision() {
    let comparison = Comparison::<f32> {
        steps: 600,
        tolerance: 1e-4,
        from_same: true,
        disturb: disturb_nap,
    };
    if let Some((asleep, wakes)) = sleeps_alike(&text(&own("nap")), &[], &comparison) {
        assert!(
            (0.2..0.9).contains(&asleep) && wakes > 20,
            "{asleep} {wakes}"
        );
    }
}

#[test]
fn so_they_do_with_other_integrators_and_constraints() {
    // Equalities of bodies, of one body and a mocap body, and of tendons.
    let equalities =
        "<connect body1='low' body2='beside' anchor='0.5 0 0' solref='0.5 1' active='false'/>
        <weld body1='hand' body2='beside' solref='0.5 1' active='false'/>
        <tendon tendon1='rope' tendon2='sum' active='false'/></equality>";
    let implicit = own("nap")
        .replace(
            "timestep",
            "integrator=\"implicitfast\" cone=\"elliptic\" timestep",
        )
        .replace("</equality>", equalities);
    // Nothing sleeps without islands.
    let disabled = implicit.replace("<flag ", "<flag island=\"disable\" ");
    for (file, steps, least) in [(implicit, 500, 20), (disabled, 160, 0)] {
        let comparison = Comparison::<f64> {
            steps,
            tolerance: 1e-6,
            from_same: false,
            disturb: disturb_nap,
        };
        let Some((asleep, wakes)) = sleeps_alike(&text(&file), &[], &comparison) else {
            return;
        };
        assert_eq!(asleep > 0.0, least > 0, "{asleep}");
        assert!(wakes >= least, "{wakes}");
    }
}

/// Boxes, and a mocap body that pushes two of them.
fn boxes() -> Arc<Model> {
    let file = "<mujoco>
          <option timestep='0.004'><flag sleep='enable'/></option>
          <worldbody>
            <geom type='plane' size='4 4 1'/>
            <body pos='0 0 0.12'><freejoint/><geom type='box' size='0.1 0.1 0.1'/></body>
            <body pos='1 0 0.5' sleep='init'><freejoint/><geom type='box' size='0.1 0.1 0.1'/></body>
            <body mocap='true' pos='0 3 0.1'><geom size='0.05'/></body>
          </worldbody>
        </mujoco>";
    text(file)
}

fn disturb_boxes(env: usize, step: usize, state: &mut State<f64>) {
    let at = |time: usize| step == time + 3 * env;
    if at(150) {
        state.mocap_pos[0].y = 2.0;
    }
    if at(160) {
        // A pose that was written with its copy does not wake the body.
        (state.qpos[9], state.pose_asleep[9]) = (0.6, 0.6);
    }
    if at(170) {
        state.mocap_pos[0] = Vec3::new(0.149, 0.0, 0.1);
    }
    if at(190) {
        state.mocap_pos[0].x = 3.0;
    }
    if at(230) {
        state.qvel[7] = -0.0;
    }
}

/// Their outputs are those of the present state although they are computed only when something changes.
#[test]
fn environments_rest_while_everything_sleeps() {
    let comparison = Comparison::<f64> {
        steps: 420,
        tolerance: 1e-9,
        from_same: false,
        disturb: disturb_boxes,
    };
    let outputs = ["xpos", "qacc", "contact_count"];
    if let Some((asleep, wakes)) = sleeps_alike(&boxes(), &outputs, &comparison) {
        assert!(
            (0.3..0.95).contains(&asleep) && wakes > 5,
            "{asleep} {wakes}"
        );
    }
}

#[test]
fn a_reset_or_restored_environment_sleeps_as_it_did() {
    let model = boxes();
    let Some(mut batch) = batch::<f64>(&model, COUNT) else {
        return;
    };
    let begun = batch.state.tree_asleep.row(0).to_vec();
    assert_eq!(begun, [-10, 1]);
    let saved = batch.save().expect("room");
    batch.step_n(200).expect("a device");
    assert_eq!(batch.state.tree_asleep.row(1), [0, 1]);
    let time = batch.state.time.row(0)[0];
    batch.record(&["cacc"]).expect("the device computes it");
    batch.step_n(3).expect("a device");
    let more = batch.state.time.row(0)[0] - time;
    assert!((more - 3.0 * model.params.timestep).abs() < 1e-9, "{more}");
    let lift = batch.output("cacc").expect("recorded").row(0)[6 * 2 + 5];
    assert!(
        (lift - 9.81).abs() < 1e-9,
        "recorded since it rests: {lift}"
    );
    batch.reset(2).expect("there");
    assert_eq!(batch.state.tree_asleep.row(2), begun);
    batch.restore(&saved).expect("fits");
    batch.step_n(3).expect("a device");
    for env in 0..COUNT {
        assert_eq!(batch.state.tree_asleep.row(env), [-11, 1]);
    }
}

/// Users may write any numbers.
#[test]
fn numbers_that_are_no_cycle_end() {
    let model = text(&own("nap"));
    let Some(mut batch) = batch::<f32>(&model, COUNT) else {
        return;
    };
    batch.step_n(120).expect("a device");
    let rows = [[5, 1_000_000, 0], [1, 2, 1], [0, 0, 0]];
    for (env, row) in rows.iter().enumerate() {
        batch.state.tree_asleep.row_mut(env)[..3].copy_from_slice(row);
        batch.state.qvel.row_mut(env)[0] = 0.1;
    }
    let summary = batch.step_n(50).expect("a device");
    assert_eq!(summary.running, COUNT);
}

/// A row of dominoes that fall asleep before each is hit, by the model of that name of MuJoCo and Genesis.
#[test]
fn dominoes_wake_one_another() {
    let file = "<mujoco>
          <option cone='elliptic' impratio='10' sleep_tolerance='3e-4' tolerance='1e-12'>
            <flag sleep='enable'/>
          </option>
          <worldbody>
            <geom type='plane' size='2 2 .01' pos='.5 0 1e-6'/>
            <body pos='-.1 0 .089' euler='0 7 0'>
              <freejoint/><geom type='box' size='.008 .044 .089' mass='0.09'/>
            </body>
            <replicate count='5' offset='.1 0 0'>
              <body pos='0 0 .089'>
                <freejoint/><geom type='box' size='.008 .044 .089' mass='0.09'/>
              </body>
            </replicate>
          </worldbody>
        </mujoco>";
    let comparison = Comparison::<f64> {
        steps: 700,
        tolerance: 1e-6,
        from_same: false,
        disturb: |env, step, state| {
            if step == 0 {
                // They fall at different times.
                state.qvel[4] = 0.2 * env as f64;
            }
        },
    };
    if let Some((asleep, wakes)) = sleeps_alike(&text(file), &[], &comparison) {
        assert!(
            (0.2..0.9).contains(&asleep) && wakes >= 3 * 5,
            "{asleep} {wakes}"
        );
    }
}
