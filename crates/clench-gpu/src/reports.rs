//! The report of each environment: its status, its faults, and the status of its solve.

use crate::batch::GpuBatch;
use crate::codes::Code;
use crate::error::{GpuError, GpuFault};
use crate::kernels::Report;
use crate::precision::GpuReal;
use clench_solver::Status;
use zerocopy::IntoBytes;

/// The last solve of an environment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GpuSolve {
    /// The solver's status.
    pub status: Status,
    /// The iterations of Newton's method or of conjugate gradients.
    pub iterations: usize,
    /// The evaluations of the derivatives in line searches.
    pub ls_evaluations: usize,
    /// Duality gap ½ gᵀM⁻¹g: an upper bound of cost − minimum, in the units of the cost.
    pub gap: f32,
    /// The number of contacts.
    pub contacts: usize,
    /// The number of rows of the convex problem.
    pub rows: usize,
}

impl<S: GpuReal> GpuBatch<S> {
    /// Returns the fault that stopped each environment, if any.
    ///
    /// # Errors
    /// Returns an error if the device was lost.
    pub fn statuses(&self) -> Result<Vec<Option<GpuFault>>, GpuError> {
        self.faults("status")
    }

    /// Returns the fault of each environment's last step or forward pass, if any. A forward pass stops no environment,
    /// so its faults are not among the [`statuses`](Self::statuses).
    ///
    /// # Errors
    /// Returns an error if the device was lost.
    pub fn last_faults(&self) -> Result<Vec<Option<GpuFault>>, GpuError> {
        self.faults("failure")
    }

    /// Decodes a report field into faults.
    pub(crate) fn faults(&self, field: &str) -> Result<Vec<Option<GpuFault>>, GpuError> {
        let limit = self.capacity.contacts;
        let slots = self.model().max_stick_pairs.unwrap_or(0);
        let fault = |&code: &u32| match Report::of(code) {
            Some(Report::Running | Report::Resting | Report::Excluded) => None,
            Some(Report::Singular) => Some(GpuFault::Singular),
            Some(Report::ContactOverflow) => Some(GpuFault::ContactOverflow { limit }),
            Some(Report::StickOverflow) => Some(GpuFault::StickOverflow { limit: slots }),
            Some(Report::Unfinished) => Some(GpuFault::Unfinished),
            // No kernel writes another code: its memory is corrupt.
            Some(Report::Diverged) | None => Some(GpuFault::Diverged),
        };
        Ok(self.report(field)?.iter().map(fault).collect())
    }

    /// Returns the number of steps of each environment since its last reset.
    ///
    /// # Errors
    /// Returns an error if the device was lost.
    pub fn steps(&self) -> Result<Vec<u32>, GpuError> {
        self.report("steps")
    }

    /// Returns the last solve of each environment; for a Runge–Kutta step, that of its last stage. Computes the duality
    /// gaps.
    ///
    /// # Errors
    /// Returns an error if the device was lost.
    pub fn solves(&self) -> Result<Vec<GpuSolve>, GpuError> {
        self.submit(|batch, encoder| {
            batch.encode(encoder, None, [&batch.pipelines.gap].into_iter());
        })?;
        // No kernel writes another code: its memory is corrupt.
        let status = |code: u32| Status::of(code).unwrap_or(Status::NonFinite);
        let ended = self.report("solve_status")?;
        let [niter, evaluations] = [self.report("niter")?, self.report("ls_evaluations")?];
        let [gap, ncon, nrow] = ["solve_gap", "ncon", "nrow"].map(|name| self.report(name));
        let (gap, ncon, nrow) = (gap?, ncon?, nrow?);
        let solve = |env: usize| GpuSolve {
            status: status(ended[env]),
            iterations: niter[env] as usize,
            ls_evaluations: evaluations[env] as usize,
            gap: f32::from_bits(gap[env]),
            contacts: ncon[env] as usize,
            rows: nrow[env] as usize,
        };
        Ok((0..self.count).map(solve).collect())
    }

    /// Restricts subsequent calls to the `running` environments, from step 0.
    pub(crate) fn choose(&mut self, running: &[bool]) {
        let code = |&runs: &bool| {
            if runs {
                Report::Running
            } else {
                Report::Excluded
            }
        };
        let codes = Vec::from_iter(running.iter().map(|runs| code(runs).code() as u32));
        self.write_report("status", &codes);
        for name in ["steps", "resets", "repeats"] {
            self.write_report(name, &vec![0; self.count]);
        }
    }

    /// Makes the next pass compute everything, also of environments in which everything sleeps.
    pub(crate) fn end_rest(&self) {
        self.write_report("at_rest", &vec![0; self.count]);
    }

    /// Writes a report field of all environments.
    pub(crate) fn write_report(&self, name: &str, words: &[u32]) {
        if let Some(field) = self.reports.find(name) {
            let start = 4 * (field.offset * self.count) as u64;
            (self.device.queue).write_buffer(&self.arrays.reports, start, words.as_bytes());
        }
    }

    /// Clears the faults of a forward pass outside a step.
    pub(crate) fn clear_failures(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(field) = self.reports.find("failure").filter(|_| self.count > 0) {
            let bytes = 4 * self.count as u64;
            encoder.clear_buffer(
                &self.arrays.reports,
                field.offset as u64 * bytes,
                Some(bytes),
            );
        }
    }
}
