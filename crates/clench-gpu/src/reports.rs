//! What the device reports of each environment: words that say whether it runs, why not, and how its solve went.

use crate::batch::GpuBatch;
use crate::error::{GpuError, GpuFault};
use crate::kernels::ASIDE;
use crate::precision::GpuReal;
use clench_solver::Status;
use zerocopy::IntoBytes;

/// How the last solve of an environment went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GpuSolve {
    /// How it ended.
    pub status: Status,
    /// Iterations of Newton's method or of conjugate gradients.
    pub iterations: usize,
    /// Duality gap ½ gᵀM⁻¹g: an upper bound of cost − minimum, in the units of the cost.
    pub gap: f32,
    /// Contacts.
    pub contacts: usize,
    /// Rows of the convex problem.
    pub rows: usize,
}

impl<S: GpuReal> GpuBatch<S> {
    /// Why each environment stands still, if it does.
    ///
    /// # Errors
    /// That the device was lost.
    pub fn statuses(&self) -> Result<Vec<Option<GpuFault>>, GpuError> {
        self.faults("status")
    }

    /// What went wrong in each environment's last step or forward pass; nothing where all is well. A forward pass stops no
    /// environment, so that its faults are not among the [`statuses`](Self::statuses).
    ///
    /// # Errors
    /// That the device was lost.
    pub fn last_faults(&self) -> Result<Vec<Option<GpuFault>>, GpuError> {
        self.faults("trouble")
    }

    /// The faults that the codes of a word stand for.
    pub(crate) fn faults(&self, word: &str) -> Result<Vec<Option<GpuFault>>, GpuError> {
        let limit = self.capacity.contacts;
        let fault = |&code: &u32| match code {
            0 | ASIDE => None,
            1 => Some(GpuFault::Singular),
            3 => Some(GpuFault::ContactOverflow { limit }),
            5 => Some(GpuFault::Unfinished),
            _ => Some(GpuFault::Diverged),
        };
        Ok(self.report(word)?.iter().map(fault).collect())
    }

    /// How many steps each environment has made since its last reset.
    ///
    /// # Errors
    /// That the device was lost.
    pub fn steps(&self) -> Result<Vec<u32>, GpuError> {
        self.report("steps")
    }

    /// How the last solve of each environment went; of a step by Runge–Kutta, that of its last stage. Duality gaps are computed now.
    ///
    /// # Errors
    /// That the device was lost.
    pub fn solves(&self) -> Result<Vec<GpuSolve>, GpuError> {
        self.submit(|batch, encoder| {
            batch.encode(encoder, None, [&batch.pipelines.gap].into_iter());
        })?;
        let status = |code: u32| match code {
            0 => Status::Unconstrained,
            1 => Status::Proven,
            2 => Status::Converged,
            3 => Status::NoProgress,
            4 => Status::IterationLimit,
            _ => Status::NonFinite,
        };
        let [ended, niter, gap, ncon, nrow] =
            ["solve_status", "niter", "solve_gap", "ncon", "nrow"].map(|name| self.report(name));
        let (ended, niter, gap, ncon, nrow) = (ended?, niter?, gap?, ncon?, nrow?);
        let solve = |env: usize| GpuSolve {
            status: status(ended[env]),
            iterations: niter[env] as usize,
            gap: f32::from_bits(gap[env]),
            contacts: ncon[env] as usize,
            rows: nrow[env] as usize,
        };
        Ok((0..self.count).map(solve).collect())
    }

    /// Lets only those take part in what follows that are `running`, from step 0 on.
    pub(crate) fn choose(&mut self, running: &[bool]) {
        let code = |&runs: &bool| if runs { 0 } else { ASIDE };
        let codes = Vec::from_iter(running.iter().map(code));
        self.write_report("status", &codes);
        self.write_report("steps", &vec![0; self.count]);
    }

    /// Replaces a word of all environments.
    pub(crate) fn write_report(&self, name: &str, words: &[u32]) {
        if let Some(field) = self.reports.find(name) {
            let start = 4 * (field.place * self.count) as u64;
            (self.device.queue).write_buffer(&self.arrays.reports, start, words.as_bytes());
        }
    }

    /// Forgets what went wrong in a forward pass that was no step.
    pub(crate) fn clear_trouble(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(field) = self.reports.find("trouble").filter(|_| self.count > 0) {
            let bytes = 4 * self.count as u64;
            encoder.clear_buffer(
                &self.arrays.reports,
                field.place as u64 * bytes,
                Some(bytes),
            );
        }
    }
}
