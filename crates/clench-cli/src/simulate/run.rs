//! What a run is told, read and checked.

use super::record::RecordOptions;
use super::start::Starts;
use crate::interrupt::Interrupt;
use crate::npy::Rows;
use clench::Model;
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::Arc;
use std::time::Duration;

/// What a run is told, read and checked.
pub(super) struct Run<'a> {
    pub(super) model: Arc<Model>,
    pub(super) starts: Starts<'a>,
    pub(super) controls: Option<Rows>,
    pub(super) steps: usize,
    pub(super) record: Option<RecordOptions<'a>>,
    pub(super) interrupt: Interrupt,
}

impl Run<'_> {
    /// A bar on standard error that appears once a run has lasted a while, and only on a terminal.
    pub(super) fn progress(&self) -> ProgressBar {
        let bar = ProgressBar::new(self.steps as u64);
        let style = ProgressStyle::with_template(
            "{elapsed_precise} [{wide_bar}] {pos}/{len} steps, {per_sec}, {eta} left",
        );
        if let Ok(style) = style {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(500));
        bar
    }
}
