//! The report of a run as text: the same lines in the same order for every model. A batch has three more.

use super::report::{BatchReport, PairReport, Report, StageReport};
use crate::table::Table;
use std::fmt::{self, Display, Formatter};

impl Display for Report {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let lanes = match &self.batch {
            Some(batch) => format!(", {} in SIMD lanes ({})", batch.lanes, self.instructions),
            None => String::new(),
        };
        let threads = match self.threads {
            1 => "1 thread".into(),
            n => format!("{n} threads"),
        };
        let envs = self.envs;
        line(
            f,
            "environments",
            format_args!("{envs}{lanes} on {threads}"),
        )?;
        let (time, steps) = (self.simulated_time, self.steps);
        let (speed, factor) = (self.steps_per_second, self.real_time_factor);
        let contacts = (self.contacts_mean, self.contacts_max);
        line(
            f,
            "simulated time",
            format_args!("{time:.4} s in {steps} steps, {} bit", self.precision),
        )?;
        line(
            f,
            "speed",
            format_args!("{speed:.0} steps/s, {factor:.1} × real time"),
        )?;
        line(
            f,
            "contacts",
            format_args!("{:.1} per step, at most {}", contacts.0, contacts.1),
        )?;
        line(
            f,
            "solver",
            format_args!("{:.1} iterations per step", self.iterations_mean),
        )?;
        line(
            f,
            "worst duality gap",
            format_args!("{:.1e} (cost above the minimum)", self.gap_max),
        )?;
        line(
            f,
            "worst penetration",
            format_args!("{:.3} mm", 1e3 * self.penetration_max),
        )?;
        match self.energy_drift {
            Some(drift) => line(f, "energy drift", format_args!("{drift:.1e} J"))?,
            None => line(
                f,
                "energy drift",
                "not reported: the model adds or removes energy",
            )?,
        }
        if let Some(batch) = &self.batch {
            batch.fmt(f)?;
        }
        self.fmt_verdict(f)?;
        if let Some(stages) = &self.profile {
            write!(f, "\n{}", table(stages))?;
        }
        match &self.pairs {
            Some(pairs) if !pairs.is_empty() => write!(f, "\n{}", pair_table(pairs)),
            _ => Ok(()),
        }
    }
}

impl Report {
    /// Writes the counts of failed steps, the rows recorded and the verdict.
    fn fmt_verdict(&self, f: &mut Formatter) -> fmt::Result {
        line(
            f,
            "not converged",
            format_args!(
                "{} steps stopped at the iteration limit",
                self.unconverged_steps
            ),
        )?;
        line(
            f,
            "contacts omitted",
            format_args!("in {} steps, by --max-contacts", self.overflow_steps),
        )?;
        line(
            f,
            "diverged",
            format_args!("{} times, then reset by --autoreset", self.resets),
        )?;
        match self.recorded_rows {
            Some(rows) => line(f, "recorded", format_args!("{rows} rows"))?,
            None => line(f, "recorded", "nothing")?,
        }
        line(f, "quality", self.quality)?;
        line(f, "status", self.status)
    }
}

impl Display for BatchReport {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let kilobytes = |bytes: usize| bytes as f64 / 1e3;
        let divergence = &self.divergence;
        line(
            f,
            "side by side",
            format_args!(
                "{:.1} iterations and {:.1} contact slots per step, {:.0}% of lanes active",
                divergence.iterations_per_group,
                divergence.slots_per_group,
                100.0 * divergence.live_share
            ),
        )?;
        line(
            f,
            "memory",
            format_args!(
                "{:.1} kB per environment, {:.0} kB per thread",
                kilobytes(self.bytes_per_env),
                kilobytes(self.scratch_bytes_per_thread)
            ),
        )?;
        line(
            f,
            "failed",
            format_args!("{} environments", self.failed_envs),
        )?;
        for failure in &self.failures {
            writeln!(f, "    environment {}: {}", failure.env, failure.reason)?;
        }
        if self.failed_envs > self.failures.len() {
            writeln!(f, "    ...")?;
        }
        Ok(())
    }
}

fn line(f: &mut Formatter, name: &str, value: impl Display) -> fmt::Result {
    writeln!(f, "  {name:<20} {value}")
}

fn table(stages: &[StageReport]) -> Table {
    let mut table = Table::new(&["stage", "µs a step", "percent"]);
    for stage in stages {
        table.row(vec![
            stage.stage.into(),
            format!("{:9.3}", stage.microseconds),
            format!("{:7.1}", stage.percent),
        ]);
    }
    let total: f64 = stages.iter().map(|s| s.microseconds).sum();
    table.row(vec!["total".into(), format!("{total:9.3}"), String::new()]);
    table
}

fn pair_table(pairs: &[PairReport]) -> Table {
    let mut table = Table::new(&["narrow phase", "near", "touching", "µs a step"]);
    for pair in pairs {
        table.row(vec![
            pair.kinds.join(" – "),
            format!("{:7.2}", pair.near),
            format!("{:8.2}", pair.touching),
            format!("{:9.3}", pair.microseconds),
        ]);
    }
    table
}
