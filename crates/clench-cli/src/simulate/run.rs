//! The validated input of a run.

use super::record::RecordOptions;
use super::start::Starts;
use crate::interrupt::Interrupt;
use crate::npy::Rows;
use clench::Model;
use std::sync::Arc;

/// The validated input of a run.
pub(super) struct Run<'a> {
    pub(super) model: Arc<Model>,
    /// This model and the others of a batch.
    pub(super) models: Vec<Arc<Model>>,
    pub(super) starts: Starts<'a>,
    pub(super) controls: Option<Rows>,
    pub(super) steps: usize,
    pub(super) record: Option<RecordOptions<'a>>,
    pub(super) interrupt: Interrupt,
}
