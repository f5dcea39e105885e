//! A batch on a device behaves like any batch and shows the device's results. One simulation per environment emulates
//! the device, so that results are equal to the bit.

use crate::batches::*;
use clench_math::{Force, Vec3};
use clench_rigid::batch::{Backend, Controls, Outcome, StepFailure};
use clench_rigid::builder::ModelBuilder;
use clench_rigid::model::Model;
use clench_rigid::options::RigidOptions;
use clench_rigid::{Batch, BatchOptions, EnvStatus, Fault, Output, Sim, SimError, State};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

const COUNT: usize = 11;

/// A device emulated by simulations.
struct Played {
    sims: Vec<Sim<f64>>,
    /// The number of uploads of a field.
    uploads: Arc<AtomicUsize>,
    autoreset: bool,
}

/// Returns the numbers of a field of a state that the device holds.
fn numbers(state: &State<f64>, field: &str) -> Option<Vec<f64>> {
    Some(match field {
        "qpos" => state.qpos.clone(),
        "qvel" => state.qvel.clone(),
        "act" => state.act.clone(),
        "qacc_warmstart" => state.qacc_warmstart.clone(),
        "ctrl" => state.ctrl.clone(),
        "qfrc_applied" => state.qfrc_applied.clone(),
        "xfrc_applied" => (state.xfrc_applied.iter())
            .flat_map(|f| [f.linear.to_array(), f.angular.to_array()].concat())
            .collect(),
        "eq_active" => state
            .eq_active
            .iter()
            .map(|&on| f64::from(u8::from(on)))
            .collect(),
        _ => return None,
    })
}

fn replace(state: &mut State<f64>, field: &str, row: &[f64]) {
    let numbers = match field {
        "qpos" => &mut state.qpos,
        "qvel" => &mut state.qvel,
        "act" => &mut state.act,
        "qacc_warmstart" => &mut state.qacc_warmstart,
        "ctrl" => &mut state.ctrl,
        "qfrc_applied" => &mut state.qfrc_applied,
        "xfrc_applied" => {
            for (force, x) in state.xfrc_applied.iter_mut().zip(row.chunks(6)) {
                *force = Force::new(Vec3::new(x[3], x[4], x[5]), Vec3::new(x[0], x[1], x[2]));
            }
            return;
        }
        _ => {
            let switches = state.eq_active.iter_mut().zip(row);
            return switches.for_each(|(on, &x)| *on = x != 0.0);
        }
    };
    numbers.copy_from_slice(row);
}

fn failure(error: SimError) -> StepFailure {
    match error {
        SimError::Fault(Fault::Diverged {
            field,
            index,
            value,
            ..
        }) => StepFailure::Diverged {
            field,
            index,
            value,
        },
        error => panic!("{error}"),
    }
}

/// Makes steps of a simulation. With `autoreset`, one that fails is repeated from the initial state.
fn steps(sim: &mut Sim<f64>, steps: usize, autoreset: bool, keeps_controls: bool) -> Outcome {
    let (mut found, mut repeats, mut remaining) = (Outcome::default(), false, steps);
    while remaining > 0 {
        match sim.step() {
            Ok(()) => {
                remaining -= 1;
                found.steps += 1;
                found.resets += usize::from(repeats);
                repeats = false;
            }
            Err(_) if autoreset && !repeats => {
                let ctrl = sim.state.ctrl.clone();
                sim.state = State::new(sim.model());
                if keeps_controls {
                    sim.state.ctrl = ctrl;
                }
                (found.steps, found.restarted, repeats) = (0, true, true);
            }
            Err(error) => {
                found.failure = Some(failure(error));
                break;
            }
        }
    }
    found
}

impl Backend<f64> for Played {
    fn name(&self) -> String {
        "a played device".to_owned()
    }
    fn bytes_per_env(&self) -> usize {
        1_000_000
    }
    fn holds(&self, field: &str) -> bool {
        numbers(&self.sims[0].state, field).is_some()
    }
    fn computes(&self, output: Output) -> bool {
        output == Output::qacc
    }
    fn request(&mut self, _: &[Output]) -> Result<(), SimError> {
        Ok(())
    }
    fn parameters_of(&self, _: &Model) -> Result<Vec<f64>, SimError> {
        Err(SimError::Backend("they are the model's".to_owned()))
    }
    fn set_parameters(&mut self, _: &[usize], _: &[Vec<f64>]) -> Result<(), SimError> {
        Ok(())
    }
    fn write(&mut self, field: &'static str, rows: &[f64]) -> Result<(), SimError> {
        self.uploads.fetch_add(1, Relaxed);
        let width = rows.len() / COUNT;
        for (sim, row) in self.sims.iter_mut().zip(rows.chunks(width.max(1))) {
            replace(&mut sim.state, field, row);
        }
        Ok(())
    }
    fn read(&mut self, field: &'static str, rows: &mut [f64]) -> Result<(), SimError> {
        let states = self.sims.iter().map(|sim| &sim.state);
        let all = states.flat_map(|state| numbers(state, field).expect("it is held"));
        rows.copy_from_slice(&Vec::from_iter(all));
        Ok(())
    }
    fn read_output(&mut self, _: Output, rows: &mut [f64]) -> Result<(), SimError> {
        let all = self
            .sims
            .iter()
            .flat_map(|sim| sim.workspace().qacc.clone());
        rows.copy_from_slice(&Vec::from_iter(all));
        Ok(())
    }
    fn step(
        &mut self,
        count: usize,
        keeps_controls: bool,
        running: &[bool],
        outcomes: &mut [Outcome],
    ) -> Result<(), SimError> {
        for (env, sim) in self
            .sims
            .iter_mut()
            .enumerate()
            .filter(|(env, _)| running[*env])
        {
            outcomes[env] = steps(sim, count, self.autoreset, keeps_controls);
        }
        Ok(())
    }
    fn forward(&mut self, running: &[bool], outcomes: &mut [Outcome]) -> Result<(), SimError> {
        for (env, sim) in self
            .sims
            .iter_mut()
            .enumerate()
            .filter(|(env, _)| running[*env])
        {
            outcomes[env] = Outcome {
                failure: sim.forward().err().map(failure),
                ..Outcome::default()
            };
        }
        Ok(())
    }
}

/// Returns the same environments on an emulated device and on the CPU, and the device's upload counter.
fn both(scene: ModelBuilder, autoreset: bool) -> ([Batch<f64>; 2], Arc<AtomicUsize>) {
    let model = Arc::new(scene.build().expect("a good model"));
    let options = BatchOptions {
        options: RigidOptions::new().autoreset(autoreset),
        ..BatchOptions::default()
    };
    let sim = |_| Sim::new(model.clone()).expect("a good model");
    let uploads = Arc::new(AtomicUsize::new(0));
    let played = Played {
        sims: (0..COUNT).map(sim).collect(),
        uploads: uploads.clone(),
        autoreset,
    };
    let played = Batch::with_backend(model.clone(), COUNT, options, Box::new(played));
    let envs = Vec::from_iter(0..COUNT);
    let processor = batch(&model, &envs, options);
    let mut played = played.expect("a good model");
    played
        .restore(&processor.save().expect("rows"))
        .expect("the same model");
    ([played, processor], uploads)
}

fn assert_same(batches: &[Batch<f64>; 2]) {
    let [played, processor] = batches;
    for env in 0..COUNT {
        let what = || format!("environment {env}");
        assert_eq!(played.status(env), processor.status(env), "{}", what());
        let expected = processor.sim(env).expect("an environment").state.clone();
        assert_state(played, env, &expected, &what);
        if let (Some(found), Some(expected)) = (played.output("qacc"), processor.output("qacc")) {
            assert_bits(found.row(env), expected.row(env), &what);
        }
    }
}

/// Does the same with both and compares the results.
fn each<R: PartialEq + std::fmt::Debug>(
    batches: &mut [Batch<f64>; 2],
    mut act: impl FnMut(&mut Batch<f64>) -> R,
) -> R {
    let [played, processor] = batches;
    let found = act(played);
    assert_eq!(found, act(processor));
    found
}

#[test]
fn written_fields_are_uploaded_and_moving_fields_downloaded() {
    let (mut batches, _) = both(arm_and_box(), false);
    each(&mut batches, |batch| {
        batch.record(&["qacc", "time", "qvel", "energy"])
    })
    .expect("outputs");
    let envs = Vec::from_iter(0..COUNT);
    for step in 0..60 {
        each(&mut batches, |batch| {
            drive(batch, &envs, step);
            if step == 20 {
                batch.state.xfrc_applied.row_mut(3)[6 + 2] = 4.0;
                batch.state.qpos.row_mut(5)[0] += 0.1;
                batch.reset(7).expect("an environment");
            }
            batch.step_n(1 + step % 3)
        })
        .expect("good states");
        assert_same(&batches);
    }
    let [played, processor] = &batches;
    for name in ["time", "qvel", "energy"] {
        let rows = |batch: &Batch<f64>| batch.output(name).expect("it is kept").as_slice().to_vec();
        assert_bits(&rows(played), &rows(processor), &|| name.to_owned());
    }
}

#[test]
fn nothing_goes_up_that_is_there() {
    let ([mut played, _], uploads) = both(walker(), false);
    played.step_n(3).expect("good states");
    let before = uploads.load(Relaxed);
    played.step_n(3).expect("good states");
    assert_eq!(uploads.load(Relaxed), before);
    played.state.ctrl.row_mut(1)[0] = 0.5;
    played.step().expect("good states");
    assert_eq!(uploads.load(Relaxed), before + 1);
}

#[test]
fn rollouts_equal_those_of_the_processor() {
    let (mut batches, _) = both(arm_and_box(), false);
    let nu = batches[0].model().nu();
    let ctrl = Vec::from_iter((0..COUNT * 12 * nu).map(|i| (0.3 * i as f64).sin()));
    let recorded = batches.each_mut().map(|batch| {
        let recording = batch.rollout(
            12,
            Controls::Each(&ctrl),
            &["qpos", "qacc", "time", "energy"],
        );
        let rows = recording.expect("good controls").into_rows();
        Vec::from_iter(rows.map(|(output, rows)| (output, rows.as_slice().to_vec())))
    });
    assert_eq!(recorded[0], recorded[1]);
    assert_same(&batches);
    // The user's controls are uploaded again.
    each(&mut batches, |batch| batch.step()).expect("good states");
    assert_same(&batches);
}

#[test]
fn faults_are_reported_equally() {
    let (mut batches, _) = both(walker(), false);
    let summary = each(&mut batches, |batch| {
        batch.state.qfrc_applied.row_mut(2)[1] = 1e30;
        batch.state.qvel.row_mut(6)[0] = f64::NAN;
        batch.state.time.row_mut(8)[0] = f64::INFINITY;
        batch.step_n(4)
    });
    assert_eq!(summary.expect("rows").failed, 3);
    let told = |batch: &Batch<f64>| format!("{:?}", batch.statuses());
    assert_eq!(told(&batches[0]), told(&batches[1]));
    each(&mut batches, |batch| {
        [2, 6, 8]
            .map(|env| batch.reset(env))
            .into_iter()
            .collect::<Result<(), _>>()?;
        batch.step_n(4)
    })
    .expect("good states");
    assert_same(&batches);
}

#[test]
fn those_that_diverge_start_over() {
    let (mut batches, _) = both(walker(), true);
    let summary = each(&mut batches, |batch| {
        batch.state.qfrc_applied.row_mut(4)[1] = 1e30;
        batch.state.qvel.row_mut(6)[2] = f64::NAN;
        batch.state.qpos.row_mut(7)[0] = 9.999e9;
        batch.state.qvel.row_mut(7)[0] = 1e9;
        batch.state.ctrl.row_mut(7).fill(0.3);
        batch.step_n(5)
    });
    let summary = summary.expect("rows");
    assert!(summary.resets > 2 && summary.failed == 0, "{summary:?}");
    assert_eq!(batches[0].resets(), batches[1].resets());
    assert_same(&batches);
    // The inputs that a reset cleared are written again.
    each(&mut batches, |batch| {
        batch.state.ctrl.row_mut(7).fill(0.3);
        batch.step_n(2)
    })
    .expect("good states");
    assert_same(&batches);
}

#[test]
fn a_rollout_that_diverges_keeps_its_controls() {
    let (mut batches, _) = both(walker(), true);
    let nu = batches[0].model().nu();
    let ctrl = Vec::from_iter((0..COUNT * 6 * nu).map(|i| (0.3 * i as f64).sin()));
    let recorded = batches.each_mut().map(|batch| {
        batch.state.qpos.row_mut(7)[0] = 9.999e9;
        batch.state.qvel.row_mut(7)[0] = 1e9;
        let recording = batch.rollout(6, Controls::Each(&ctrl), &["qpos", "qacc", "time"]);
        let rows = recording.expect("good controls").into_rows();
        Vec::from_iter(rows.map(|(output, rows)| (output, rows.as_slice().to_vec())))
    });
    assert_eq!(batches[0].resets(), batches[1].resets());
    assert_eq!(batches[0].resets()[7], 1);
    assert_eq!(recorded[0], recorded[1]);
    assert_same(&batches);
}

#[test]
fn unsupported_operations_of_the_device_are_errors() {
    let ([mut played, _], _) = both(walker(), false);
    let told = |result: Result<(), SimError>| result.expect_err("it cannot").to_string();
    assert_eq!(
        told(played.record(&["sensordata"])),
        "a played device does not compute sensordata yet; it computes time, qpos, qvel, act, qacc, energy"
    );
    let masses = vec![1.0; played.model().nbody()];
    assert_eq!(
        told(played.randomize("body_mass", &[0], &masses)),
        "they are the model's"
    );
    assert!(played.param("body_mass", 0).expect("masses") != masses);
    assert!(played.set_options(RigidOptions::new()).is_err());
    assert!(played.add_weld(&[0], 1, 2).is_err());
    assert!(played.bytes_per_env() > 1_000_000);
    assert_eq!(played.device().as_deref(), Some("a played device"));
    assert_eq!(played.status(0), EnvStatus::Running);
}
