//! Rollouts of a batch equal a loop of steps.

use crate::batches::*;
use clench_math::Instructions;
use clench_rigid::batch::Controls;
use clench_rigid::options::RigidOptions;
use clench_rigid::{Batch, EnvStatus, Output, Sim, SimError};

#[test]
fn rollouts_are_steps() {
    const STEPS: usize = 37;
    let model = model(&walker());
    let options = with(Instructions::widest(), 2, RigidOptions::new());
    let envs: Vec<usize> = (0..13).collect();
    let (mut stepped, mut rolled) = (
        batch::<f64>(&model, &envs, options),
        batch::<f64>(&model, &envs, options),
    );
    let (n, nu) = (envs.len(), model.nu());
    let mut controls = vec![0.0; n * STEPS * nu];
    for (k, ctrl) in controls.iter_mut().enumerate() {
        *ctrl = control(k / (STEPS * nu), k / nu % STEPS, k % nu);
    }
    let record = ["qpos", "qvel", "time", "xpos", "energy", "qacc", "qpos"];
    stepped.record(&record).expect("known");
    rolled.record(&["xpos"]).expect("known");
    let recording = rolled
        .rollout(STEPS, Controls::Each(&controls), &record)
        .expect("valid");
    assert_eq!(
        (recording.summary.failed, recording.summary.running),
        (0, n)
    );
    assert!(recording.get("xmat").is_none());
    for step in 0..STEPS {
        drive(&mut stepped, &envs, step);
        stepped.step().expect("valid");
        for name in record {
            let rows = stepped.output(name).expect("kept");
            let recorded = recording.get(name).expect("recorded");
            for env in 0..n {
                let found = &recorded.row(env)[step * rows.width()..][..rows.width()];
                assert_bits(found, rows.row(env), &|| {
                    format!("{name} of {env}, step {step}")
                });
            }
        }
    }
    for env in 0..n {
        let end = stepped.sim(env).expect("it exists").state;
        assert_bits(rolled.state.qpos.row(env), &end.qpos, &|| "end".into());
        assert_eq!(
            rolled.state.ctrl.row(env),
            vec![0.0; nu],
            "left as they were"
        );
        let (last, kept) = (rolled.output("xpos"), stepped.output("xpos"));
        assert_eq!(last.expect("kept").row(env), kept.expect("kept").row(env));
    }
    let times = Vec::from(recording.get("time").expect("recorded").as_slice());
    let mut tables = recording.into_rows();
    assert_eq!(tables.next().expect("six").0, Output::qpos);
    let (output, rows) = tables.nth(1).expect("six");
    assert_eq!((output, rows.as_slice()), (Output::time, &times[..]));
    assert_eq!(tables.count(), 3);
}

#[test]
fn rollouts_start_at_the_requested_states() {
    let model = model(&everything());
    let (n, steps, nq) = (5, 12, model.nq);
    let mut batch = Batch::<f64>::new(model.clone(), n).expect("valid");
    // The state before must have no effect: the solver's start, a failure.
    batch.state.qvel.row_mut(3).fill(f64::NAN);
    batch.step_n(4).expect("valid");
    let mut initial = Vec::new();
    let mut alone: Vec<Sim> = Vec::new();
    for env in 0..n {
        let mut sim = Sim::<f64>::new(model.clone()).expect("valid");
        begin(env, &mut sim.state);
        let switches = batch.state.eq_active.row(env).iter();
        sim.state.eq_active = switches.map(|&on| on != 0).collect();
        sim.state.time = env as f64;
        sim.state.act.fill(0.1 * env as f64);
        initial.push(sim.state.time);
        initial.extend(
            [&sim.state.qpos, &sim.state.qvel, &sim.state.act]
                .map(|v| &v[..])
                .concat(),
        );
        alone.push(sim);
    }
    let before = batch.state.qpos.as_slice().to_vec();
    let short = batch.rollout_from(&initial[1..], steps, Controls::Held, &[]);
    assert!(matches!(
        short,
        Err(SimError::WrongLength {
            field: "initial",
            ..
        })
    ));
    assert!(
        batch
            .rollout_from(&initial, steps, Controls::Held, &["xpose"])
            .is_err()
    );
    assert_eq!(batch.state.qpos.as_slice(), before, "errors change nothing");
    let recording = batch
        .rollout_from(&initial, steps, Controls::Held, &["time", "qpos", "act"])
        .expect("valid");
    assert_eq!(recording.summary.running, n);
    let row = |name, env| recording.get(name).expect("recorded").row(env);
    for (env, sim) in alone.iter_mut().enumerate() {
        for step in 0..steps {
            sim.step().expect("finite");
            let what = || format!("environment {env}, step {step}");
            assert_bits(&row("qpos", env)[step * nq..][..nq], &sim.state.qpos, &what);
            assert_bits(&row("time", env)[step..][..1], &[sim.state.time], &what);
        }
        assert_state(&batch, env, &sim.state, &|| "end".into());
    }
    // A NaN in an initial state fails only its environment.
    let width = initial.len() / n;
    initial[2 * width + 1] = f64::NAN;
    let end = batch.state.qpos.row(1).to_vec();
    let again = batch.rollout_from(&initial, steps, Controls::Held, &[]);
    let summary = again.expect("valid").summary;
    assert_eq!((summary.failed, summary.running), (1, n - 1));
    assert_eq!(batch.state.qpos.row(1), end);
}

#[test]
fn controls_are_shared_or_held() {
    let model = model(&walker());
    let (n, steps, nu) = (5, 9, model.nu());
    let shared: Vec<f64> = (0..steps * nu).map(|k| (k as f64).sin()).collect();
    let each = shared.repeat(n);
    let end = |controls: Controls<f64>, held: f64| {
        let mut batch = Batch::<f64>::new(model.clone(), n).expect("valid");
        batch.state.ctrl.as_mut_slice().fill(held);
        batch.rollout(steps, controls, &[]).expect("valid");
        batch.state.qpos.as_slice().to_vec()
    };
    assert_eq!(
        end(Controls::Shared(&shared), 0.3),
        end(Controls::Each(&each), 0.3)
    );
    assert_eq!(
        end(Controls::Held, 0.3),
        end(Controls::Shared(&vec![0.3; steps * nu]), 0.0)
    );
    assert_ne!(end(Controls::Held, 0.3), end(Controls::Held, 0.0));
    let mut batch = Batch::<f64>::new(model.clone(), n).expect("valid");
    for (controls, expected) in [
        (Controls::Shared(&each[..]), steps * nu),
        (Controls::Each(&shared[..]), n * steps * nu),
    ] {
        let error = batch
            .rollout(steps, controls, &[])
            .expect_err("too many or too few");
        let SimError::WrongLength {
            expected: found, ..
        } = error
        else {
            panic!("{error}");
        };
        assert_eq!(found, expected);
    }
    assert!(batch.rollout(steps, Controls::Held, &["xpose"]).is_err());
}

#[test]
fn a_rollout_reports_only_steps_that_were_taken() {
    let model = model(&walker());
    let (n, steps, nu) = (9, 12, model.nu());
    let mut controls = vec![0.1; n * steps * nu];
    controls[(4 * steps + 7) * nu] = f64::NAN;
    let mut batch = Batch::<f64>::new(model, n).expect("valid");
    let recording = batch
        .rollout(steps, Controls::Each(&controls), &["qvel"])
        .expect("valid");
    assert_eq!(
        (recording.summary.failed, recording.summary.running),
        (1, n - 1)
    );
    assert!(matches!(batch.status(4), EnvStatus::Failed(_)));
    let rows = recording.get("qvel").expect("recorded");
    let nv = rows.width() / steps;
    for env in 0..n {
        let done = if env == 4 { 7 } else { steps };
        let (good, rest) = rows.row(env).split_at(done * nv);
        assert!(good.iter().all(|x| x.is_finite()) && rest.iter().all(|x| x.is_nan()));
        assert_eq!(good[(done - 1) * nv..], *batch.state.qvel.row(env));
    }
}
