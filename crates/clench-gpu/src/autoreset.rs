//! Automatic resets. A step that fails leaves the initial state, and its environment is a step behind: those that are
//! behind make the missing steps at the end of the call.

use crate::batch::GpuBatch;
use crate::codes::Code;
use crate::error::GpuError;
use crate::kernels::Report;
use crate::precision::GpuReal;
use crate::tables::KEEPS_CONTROLS;
use zerocopy::IntoBytes;

impl<S: GpuReal> GpuBatch<S> {
    /// Returns the number of automatic resets of each environment since the batch was created. With the option
    /// `autoreset`, a step that fails, except beyond `max_contacts`, is repeated from the initial state; only if that
    /// fails too does the environment stop.
    ///
    /// # Errors
    /// Returns an error if the device was lost.
    pub fn resets(&self) -> Result<Vec<u32>, GpuError> {
        self.report("resets")
    }

    /// Makes automatic resets keep the controls or not.
    pub(crate) fn keep_controls(&mut self, keeps: bool) {
        let (word, offset) = (u32::from(keeps), 4 * KEEPS_CONTROLS as u64);
        (self.device.queue).write_buffer(&self.arrays.words, offset, [word].as_bytes());
    }

    /// Repeats the steps that failed since `before`, the resets at that time. Returns the resets now.
    ///
    /// # Errors
    /// Returns an error if the device was lost.
    pub(crate) fn catch_up(&mut self, before: &[u32]) -> Result<Vec<u32>, GpuError> {
        if !self.settings.autoreset {
            return Ok(before.to_vec());
        }
        let running = Report::Running.code() as u32;
        let mut known = self.resets()?;
        let since = known.iter().zip(before);
        let mut behind = Vec::from_iter(since.map(|(now, before)| now.wrapping_sub(*before)));
        while behind.iter().any(|&steps| steps > 0) {
            let statuses = self.report("status")?;
            let runs = |env: usize| statuses[env] == running;
            for env in (0..self.count).filter(|&env| !runs(env)) {
                behind[env] = 0;
            }
            let Some(&next) = behind.iter().filter(|&&steps| steps > 0).min() else {
                break;
            };
            let waits = Vec::from_iter((0..self.count).map(|env| runs(env) && behind[env] == 0));
            let excluded = Report::Excluded.code() as u32;
            let chosen = |(&waits, &status): (&bool, &u32)| if waits { excluded } else { status };
            let chosen = Vec::from_iter(waits.iter().zip(&statuses).map(chosen));
            self.write_report("status", &chosen);
            self.dispatch(next as usize)?;
            let after = self.report("status")?;
            let all = |(&waits, &status): (&bool, &u32)| if waits { running } else { status };
            let after = Vec::from_iter(waits.iter().zip(&after).map(all));
            self.write_report("status", &after);
            let now = self.resets()?;
            for (env, steps) in behind
                .iter_mut()
                .enumerate()
                .filter(|(_, steps)| **steps > 0)
            {
                *steps = (*steps - next).wrapping_add(now[env].wrapping_sub(known[env]));
            }
            known = now;
        }
        Ok(known)
    }
}
