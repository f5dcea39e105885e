//! Random models with all features of MJCF, compared with the processor in double precision. The environment variable
//! `CLENCH_RANDOM_MODELS` names their folder (`parity/write_random_models.py` fills it).

use crate::common::{self, Random, computed, difference, random_state, try_general_batch, used};
use clench_gpu::{GpuBatch, GpuError, GpuSolve};
use clench_rigid::Sim;
use clench_rigid::model::{Model, SensorKind};
use clench_rigid::options::RigidOptions;
use std::path::PathBuf;
use std::sync::Arc;

/// The number of states of each model.
const COUNT: usize = 4;
/// The tolerance relative to a field's largest number.
const TOLERANCE: f64 = 1e-6;
/// The largest force of an actuator, N or N m: above it rounding errors cause motion.
const STRONGEST: f64 = 1e10;
/// The tolerance of rows. If rows differ by more, the problems differ, and their solutions may differ by any factor of
/// it.
const SAME_ROWS: f64 = 1e-10;
/// The least regularization of rows: below it inverse inertias are nearly zero, and rounding of J changes the solution.
const LEAST_R: f64 = 1e-12;
/// The fields of each row of the convex problem.
const ROWS: [&str; 3] = ["jacobian", "aref", "r"];
/// The least pivot in the factor of M, relative to the diagonal.
const LEAST_PIVOT: f64 = 1e-9;
/// The relative uncertainty of accelerations above which a solution is loose.
const LOOSE: f64 = 1e-3;
/// Fields that depend on the solution of the convex problem, which is accurate to its duality gap.
const SOLVED: [&str; 2] = ["qacc", "qfrc_constraint"];
/// Sensors that read the solution.
const SOLVED_SENSORS: [SensorKind; 9] = [
    SensorKind::Touch,
    SensorKind::Accelerometer,
    SensorKind::Force,
    SensorKind::Torque,
    SensorKind::FrameLinAcc,
    SensorKind::FrameAngAcc,
    SensorKind::JointLimitFrc,
    SensorKind::TendonLimitFrc,
    SensorKind::Contact,
];

/// Other fields that depend on the inverse of the mass matrix.
const OF_INVERSE_MASS: [&str; 3] = ["qacc_smooth", "aref", "r"];

/// Counts of compared and excluded cases.
#[derive(Debug, Default)]
struct Tally {
    models: usize,
    refused: usize,
    states: usize,
    /// More contacts than the pool holds, more loop iterations than the device allows, or an error of the processor.
    ended: usize,
    /// Cases that depend on rounding: contacts of shapes with equal overlap in two directions, or in another order, and
    /// actuators so strong that rounding errors of moment arms cause motion.
    undecided: usize,
    /// Differences that depend on rounding: a mass matrix is nearly singular, or rows have nearly zero inverse inertia
    /// or differ by rounding.
    excused: usize,
    /// Solves whose gaps allow large errors of the accelerations: mostly those that end at a limit of few iterations,
    /// or continue with `noslip`.
    loose: usize,
    sensors: usize,
}

#[test]
fn random_models_agree() {
    let Some(folder) = std::env::var_os("CLENCH_RANDOM_MODELS").map(PathBuf::from) else {
        eprintln!("skipped: CLENCH_RANDOM_MODELS names no folder");
        return;
    };
    let files = folder.read_dir().expect("a folder").flatten();
    let mut files = Vec::from_iter(files.map(|file| file.path()));
    files.retain(|path| path.extension().is_some_and(|e| e == "xml"));
    files.sort();
    let (mut tally, mut wrong) = (Tally::default(), Vec::new());
    for path in &files {
        // The reader refuses some; the comparison with MuJoCo counts them.
        let Some(model) = clench_formats::load(path).ok().filter(|m| m.nv > 0) else {
            continue;
        };
        if let Err(difference) = compare(&Arc::new(model), &mut tally) {
            wrong.push(format!("{}: {difference}", path.display()));
        }
    }
    println!("{tally:?}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let compared = tally.states - tally.ended - tally.undecided;
    assert!(2 * compared > tally.states, "few are compared: {tally:?}");
    assert!(
        100 * tally.excused <= tally.states,
        "more than rounding: {tally:?}"
    );
}

/// Compares a forward pass in a few states.
fn compare(model: &Arc<Model>, tally: &mut Tally) -> Result<(), String> {
    let mut batch = match try_general_batch::<f64>(model, COUNT, RigidOptions::new()) {
        Ok(Some(batch)) => batch,
        Ok(None) => return Ok(()),
        Err(GpuError::Unsupported(_)) => {
            tally.refused += 1;
            return Ok(());
        }
        Err(error) => return Err(error.to_string()),
    };
    tally.models += 1;
    let measures = batch.measure().is_ok();
    tally.sensors += if measures { model.sensors.len() } else { 0 };
    let mut random = Random::new(5);
    let states = Vec::from_iter((0..COUNT).map(|_| random_state(model, &mut random, 0.2)));
    common::upload(&mut batch, &states);
    batch.forward().expect("a device");
    let faults = batch.last_faults().expect("a device");
    let solves = batch.solves().expect("a device");
    let mut sim = Sim::<f64>::new(model.clone()).expect("a good model");
    for (env, state) in states.iter().enumerate() {
        tally.states += 1;
        sim.state = common::convert(model, state);
        if sim.forward().is_err() || faults[env].is_some() {
            tally.ended += 1;
            continue;
        }
        let found = Environment {
            batch: &batch,
            env,
            solve: &solves[env],
        };
        let forces = &sim.workspace().force.actuator_force;
        let is_strong = forces.iter().any(|force| force.abs() > STRONGEST);
        let agree = found.agrees("contacts", &computed(&sim)["contacts"], TOLERANCE);
        if is_strong || !agree {
            tally.undecided += 1;
            continue;
        }
        let compared = found.compare(&mut sim, measures, tally);
        let excused = compared.map_err(|difference| format!("state {env}: {difference}"))?;
        tally.excused += usize::from(excused);
    }
    Ok(())
}

/// Returns true if rounding dominates a pivot of a mass matrix of `n` dofs.
fn is_nearly_singular(mut mass: Vec<f64>, n: usize) -> bool {
    let diagonal = Vec::from_iter((0..n).map(|i| mass[n * i + i]));
    for k in 0..n {
        let pivot = mass[n * k + k];
        if pivot <= LEAST_PIVOT * diagonal[k] {
            return true;
        }
        for i in k + 1..n {
            let share = mass[n * i + k] / pivot;
            (k..n).for_each(|j| mass[n * i + j] -= share * mass[n * k + j]);
        }
    }
    false
}

/// An environment on the device after a forward pass.
struct Environment<'a> {
    batch: &'a GpuBatch<f64>,
    env: usize,
    solve: &'a GpuSolve,
}

impl Environment<'_> {
    /// Returns the used part of its row of a field.
    fn row(&self, name: &str) -> Vec<f64> {
        let width = self.batch.width(name).expect("a field");
        let values = self.batch.read(name).expect("a device");
        let row = values[self.env * width..][..width].to_vec();
        used(name, row, self.solve, self.batch.model().nv)
    }

    fn agrees(&self, name: &str, expected: &[f64], tolerance: f64) -> bool {
        difference(&self.row(name), expected) <= tolerance
    }

    /// Returns an error with the difference from the processor, or true if there is one that rounding excuses.
    fn compare(
        &self,
        sim: &mut Sim<f64>,
        measures: bool,
        tally: &mut Tally,
    ) -> Result<bool, String> {
        let mass = sim.mass_matrix().expect("positions are known");
        let is_singular = is_nearly_singular(mass, self.batch.model().nv);
        let is_excused = self.compare_fields(sim, is_singular)?;
        let is_solution_excused = self.compare_solutions(sim, is_singular, tally)?;
        if measures {
            self.compare_sensors(sim)?;
        }
        Ok(is_excused || is_solution_excused)
    }

    fn compare_fields(&self, sim: &Sim<f64>, is_singular: bool) -> Result<bool, String> {
        let mut is_excused = false;
        let fields = computed(sim).into_iter();
        for (name, expected) in fields.filter(|(name, _)| !SOLVED.contains(name)) {
            if self.agrees(name, &expected, TOLERANCE) {
                continue;
            }
            if !(is_singular && OF_INVERSE_MASS.contains(&name)) {
                return Err(format!("{name} is {:?}, not {expected:?}", self.row(name)));
            }
            is_excused = true;
        }
        Ok(is_excused)
    }

    fn compare_solutions(
        &self,
        sim: &mut Sim<f64>,
        is_singular: bool,
        tally: &mut Tally,
    ) -> Result<bool, String> {
        let Solutions {
            apart,
            allowed,
            size,
        } = self.solutions(sim);
        let noslip = sim.settings().solver.noslip_iterations > 0;
        tally.loose += usize::from(noslip || allowed > LOOSE * size);
        let most = allowed + TOLERANCE * (1.0 + size);
        if !apart.is_nan() && (noslip || apart <= most) {
            return Ok(false);
        }
        let rows = computed(sim);
        let is_rounded = is_singular || rows["r"].iter().any(|&r| r < LEAST_R);
        let differs = |name: &&str| !self.agrees(name, &rows[*name], SAME_ROWS);
        let is_excused = is_rounded || ROWS.iter().any(differs);
        if !is_excused || apart.is_nan() {
            return Err(format!(
                "qacc is {apart:.1e} off where gaps allow {most:.1e}"
            ));
        }
        Ok(true)
    }

    fn compare_sensors(&self, sim: &Sim<f64>) -> Result<(), String> {
        let data = self.row("sensordata");
        let expected = &sim.workspace().sensors.data;
        let model = self.batch.model();
        for sensor in &model.sensors {
            let solved = SOLVED_SENSORS.contains(&sensor.kind) && self.solve.rows > 0;
            let (found, expected) = (
                &data[sensor.numbers.clone()],
                &expected[sensor.numbers.clone()],
            );
            if !solved && difference(found, expected) > TOLERANCE {
                let kind = sensor.kind.name();
                return Err(format!(
                    "{kind} \"{}\" is {found:?}, not {expected:?}",
                    sensor.name
                ));
            }
        }
        Ok(())
    }

    /// Compares the accelerations. The cost grows at least as fast as the square of M's norm, so each solution is at
    /// most √(2 gap) from the true one.
    fn solutions(&self, sim: &mut Sim<f64>) -> Solutions {
        let mass = sim.mass_matrix().expect("positions are known");
        let (found, expected) = (self.row("qacc"), sim.workspace().qacc.clone());
        let norm = |x: &[f64]| {
            let rows = mass.chunks(x.len()).zip(x);
            let product = |row: &[f64]| row.iter().zip(x).map(|(m, x)| m * x).sum::<f64>();
            let square: f64 = rows.map(|(row, x)| x * product(row)).sum();
            // Rounding may make it slightly negative.
            if square < 0.0 { 0.0 } else { square.sqrt() }
        };
        let apart = Vec::from_iter(found.iter().zip(&expected).map(|(a, b)| a - b));
        let gaps = [f64::from(self.solve.gap), sim.stats().gap];
        Solutions {
            apart: norm(&apart),
            allowed: gaps.map(|gap| (2.0 * gap).sqrt()).iter().sum(),
            size: norm(&expected),
        }
    }
}

/// A comparison of accelerations in the norm of M.
struct Solutions {
    /// The distance between device and processor.
    apart: f64,
    /// The distance that their duality gaps allow.
    allowed: f64,
    /// The norm of the processor's accelerations.
    size: f64,
}
