//! Central differences of steps.

use crate::common::Random;
use clench_derivatives::Matrix;
use clench_dynamics::dynamics::integrate::differentiate_positions;
use clench_rigid::options::RigidOptions;
use clench_rigid::{Model, Sim, State};
use std::sync::Arc;

/// The largest difference from the exact derivative, relative to 1 + its magnitude.
const TOLERANCE: f64 = 1e-6;
/// A simulation and the differences of its steps.
pub(crate) struct Differences {
    pub(crate) sim: Sim<f64>,
    pub(crate) from: State<f64>,
    /// True if x has the fields of [`StateField::MEMORY`](clench_derivatives::StateField::MEMORY).
    pub(crate) memory: bool,
}

impl Differences {
    /// Starts from a state after some steps under random controls.
    pub(crate) fn new(model: Arc<Model>, options: RigidOptions, steps: usize) -> Self {
        // The differences are as accurate as the solutions.
        let options = options.tolerance(0.0).iterations(100);
        let mut sim = Sim::with_options(model, options).expect("a simulation");
        let mut random = Random(1);
        for step in 0..steps {
            if step % 10 == 0 {
                for control in &mut sim.state.ctrl {
                    *control = 0.5 * random.next();
                }
            }
            sim.step().expect("a step");
        }
        let from = sim.state.clone();
        Differences {
            sim,
            from,
            memory: false,
        }
    }

    /// Returns x⁺ and y, each position as the motion from that of the step without changes, `to`.
    fn step(&mut self, to: &[f64], change: impl FnOnce(&mut Sim<f64>)) -> Vec<f64> {
        self.sim.state.copy_from(&self.from);
        change(&mut self.sim);
        self.sim.step().expect("a step");
        let (model, state) = (self.sim.model(), &self.sim.state);
        let mut result = vec![0.0; model.nv];
        differentiate_positions(model, to, &state.qpos, 1.0, &mut result);
        result.extend(state.qvel.iter().chain(&state.act));
        if self.memory {
            result.extend(state.plastic.iter().chain(&state.history));
            for slot in &state.stick_references {
                result.extend([slot.first, slot.second]);
                result.extend(slot.position.to_array());
                result.extend(slot.rotation.to_array());
            }
            result.extend(&state.stick_friction);
        }
        result.extend(&self.sim.workspace().sensors.data);
        result
    }

    /// Returns the central difference of two steps, and its error as far as it is known: that of a wider interval.
    fn column(&mut self, h: f64, change: impl Fn(&mut Sim<f64>, f64)) -> Vec<(f64, f64)> {
        self.sim.state.copy_from(&self.from);
        self.sim.step().expect("a step");
        let to = self.sim.state.qpos.clone();
        let mut central = |h: f64| -> Vec<f64> {
            let ahead = self.step(&to, |sim| change(sim, h));
            let behind = self.step(&to, |sim| change(sim, -h));
            let pairs = ahead.iter().zip(&behind);
            pairs.map(|(a, b)| (a - b) / (2.0 * h)).collect()
        };
        let (wide, narrow) = (central(h), central(0.5 * h));
        let pairs = wide.iter().zip(&narrow);
        // Richardson's extrapolation.
        pairs
            .map(|(w, n)| ((4.0 * n - w) / 3.0, (w - n).abs()))
            .collect()
    }

    /// Compares a column of two matrices, one over the other.
    pub(crate) fn compare(
        &mut self,
        of: [&Matrix; 2],
        column: usize,
        change: impl Fn(&mut Sim<f64>, f64),
    ) -> usize {
        let exact = of.map(|matrix| {
            let rows = matrix.values.chunks_exact(matrix.shape[1].max(1));
            rows.map(|row| row[column]).collect::<Vec<_>>()
        });
        let exact = exact.concat();
        let differences = self.column(1e-5, change);
        assert_eq!(exact.len(), differences.len());
        let mut switching = 0;
        for (row, (&exact, (difference, error))) in exact.iter().zip(differences).enumerate() {
            let scale = 1.0 + difference.abs();
            if error > 1e-4 * scale {
                switching += 1;
                continue;
            }
            assert!(
                (exact - difference).abs() <= TOLERANCE * scale + error,
                "row {row}, column {column}: {exact} exactly, {difference} by differences (error {error:.1e})"
            );
        }
        switching
    }
}
