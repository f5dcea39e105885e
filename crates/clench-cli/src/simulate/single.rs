//! A run of a single environment.

use super::arguments::Arguments;
use super::energy::{EnergyAccount, STEPS_BETWEEN_CHECKS};
use super::page::RunRecorder;
use super::progress::Progress;
use super::quality::verdict;
use super::report::{Report, pairs, stages};
use super::run::Run;
use super::summary::{Summary, energy};
use anyhow::Result;
use clench::rigid::Precision;
use clench::{RigidOptions, Sim};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Steps a single environment.
pub(crate) fn run<T: Precision>(
    arguments: &Arguments,
    run: &Run,
    options: RigidOptions,
) -> Result<Report> {
    let mut sim = Sim::<T>::with_options(Arc::clone(&run.model), options)?;
    sim.set_threads(arguments.batch.threads.map_or(1, usize::from))?;
    run.starts.start(&mut sim)?;
    let mut recorder = (run.record.as_ref())
        .map(|options| RunRecorder::create(options, &run.model))
        .transpose()?;
    let mut summary = Summary::new(&mut sim)?;
    let mut account = EnergyAccount::open(&run.model, [energy(&mut sim)?]);
    let mut progress = Progress::new(run.steps);
    let mut spent = Duration::ZERO;
    for step in 0..run.steps {
        if run.interrupt.signal().is_some() {
            break;
        }
        if let Some(rows) = &run.controls {
            let ctrl = sim.state.ctrl.iter_mut().zip(rows.row(step));
            ctrl.for_each(|(to, &from)| *to = T::new(from));
        }
        // Queries between steps are not counted.
        sim.run_clocks(arguments.profile);
        let start = Instant::now();
        let result = sim.step();
        spent += start.elapsed();
        sim.run_clocks(false);
        if let Err(error) = result {
            summary.failed(step, &error);
            break;
        }
        summary.after_step(&sim);
        if let Some(account) = &mut account {
            watch(account, step, &mut sim)?;
        }
        if let Some(recorder) = &mut recorder {
            recorder.after_steps(step + 1, &mut sim)?;
        }
        progress.reach(step + 1);
    }
    if let Some(account) = &mut account {
        account.check(0, energy(&mut sim)?);
    }
    drop(progress);
    let recorded = recorder.map(RunRecorder::write).transpose();
    sim.run_clocks(false);
    let verdict = verdict(&run.model, summary.quality(), account.as_ref());
    let mut report = summary.finish(&mut sim, spent.as_secs_f64(), verdict);
    report.set_record(recorded);
    if arguments.profile {
        let (profile, steps) = (sim.profile(), report.steps as u64);
        report.profile = Some(stages(&profile, spent, steps));
        report.pairs = Some(pairs(&profile, steps));
    }
    Ok(report)
}

/// Adds a step to the energy account.
fn watch<T: Precision>(account: &mut EnergyAccount, step: usize, sim: &mut Sim<T>) -> Result<()> {
    if sim.model().nu() > 0 {
        let power = sim.output("actuator_power")?;
        account.supply(0, power[0].to_f64());
    }
    if (step + 1).is_multiple_of(STEPS_BETWEEN_CHECKS) {
        account.check(0, energy(sim)?);
    }
    Ok(())
}
