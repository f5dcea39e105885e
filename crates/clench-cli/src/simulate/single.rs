//! A run of one environment.

use super::record::Recorder;
use super::report::{Report, stages};
use super::summary::Summary;
use super::{Arguments, Run};
use anyhow::Result;
use clench::rigid::Precision;
use clench::{RigidOptions, Sim};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Steps one environment alone.
pub fn run<T: Precision>(
    arguments: &Arguments,
    run: &Run,
    options: RigidOptions,
) -> Result<Report> {
    let mut sim = Sim::<T>::with_options(Arc::clone(&run.model), options)?;
    start(&mut sim, run)?;
    let record = arguments.record.as_ref();
    let mut recorder = record
        .map(|path| Recorder::create(path, arguments.every))
        .transpose()?;
    let mut summary = Summary::new(&mut sim)?;
    sim.run_clocks(arguments.profile);
    let progress = run.progress();
    let mut spent = Duration::ZERO;
    for step in 0..run.steps {
        if let Some(rows) = &run.controls {
            let ctrl = sim.state.ctrl.iter_mut().zip(rows.row(step));
            ctrl.for_each(|(to, &from)| *to = T::new(from));
        }
        let start = Instant::now();
        let result = sim.step();
        spent += start.elapsed();
        if let Err(error) = result {
            progress.abandon();
            summary.failed(step, &error);
            break;
        }
        summary.after_step(&sim);
        if let Some(recorder) = &mut recorder {
            recorder.after_step(step, &sim);
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    if let Some(recorder) = recorder {
        recorder.write(&run.model)?;
    }
    sim.run_clocks(false);
    let mut report = summary.finish(&mut sim, spent.as_secs_f64());
    report.profile = arguments
        .profile
        .then(|| stages(&sim.profile(), spent, report.steps as u64));
    Ok(report)
}

fn start<T: Precision>(sim: &mut Sim<T>, run: &Run) -> Result<()> {
    if let Some(key) = run.starts.keyframe() {
        sim.reset_to_keyframe(key)?;
    }
    let widen = |values: &[T]| -> Vec<f64> { values.iter().map(|x| x.to_f64()).collect() };
    let (mut qpos, mut qvel) = (widen(&sim.state.qpos), widen(&sim.state.qvel));
    run.starts.place(0, &mut qpos, &mut qvel);
    let narrow = |values: Vec<f64>| -> Vec<T> { values.into_iter().map(T::new).collect() };
    sim.set_configuration(&narrow(qpos), &narrow(qvel))?;
    Ok(())
}
