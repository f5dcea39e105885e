//! The recorded outputs of a batch, and the output targets and controls of a call.

use super::Rows;
use super::cells::Cells;
use super::shared::Shared;
use crate::output::Output;
use clench_math::Scalar;
use std::array::from_fn;

/// An output of every environment.
#[derive(Debug)]
pub(super) struct OutputRows<S> {
    pub(super) output: Output,
    pub(super) rows: Rows<S>,
}

/// The targets of an output.
pub struct Target<'a, S: Scalar + Shared> {
    /// Its values in the last forward pass of a call.
    pub last: Option<Cells<'a, S>>,
    /// Its values after each step of a rollout.
    pub trace: Option<Cells<'a, S>>,
}

/// The targets of each output, in the order of [`Output::ALL`].
pub(super) type Targets<'a, S> = [Target<'a, S>; Output::COUNT];

/// Shares the tables of outputs with threads.
pub(super) fn targets<'a, S: Scalar + Shared>(
    last: &'a mut [OutputRows<S>],
    trace: &'a mut [OutputRows<S>],
) -> Targets<'a, S> {
    let mut targets = from_fn(|_| Target {
        last: None,
        trace: None,
    });
    for own in last {
        targets[own.output as usize].last = Some(Cells::new(&mut own.rows));
    }
    for own in trace {
        targets[own.output as usize].trace = Some(Cells::new(&mut own.rows));
    }
    targets
}

/// The controls of a rollout.
#[derive(Clone, Copy, Debug)]
pub enum Controls<'a, S> {
    /// The controls in [`StateRows::ctrl`](super::StateRows::ctrl), in all steps.
    Held,
    /// The same controls for all environments (steps, nu).
    Shared(&'a [S]),
    /// Separate controls for each environment (n, steps, nu).
    Each(&'a [S]),
}

impl<S> Controls<'_, S> {
    /// Returns the controls of an environment in a step; `None` if they are those of the state.
    pub(super) fn row(&self, env: usize, step: usize, steps: usize, nu: usize) -> Option<&[S]> {
        match self {
            Controls::Held => None,
            Controls::Shared(values) => Some(&values[step * nu..][..nu]),
            Controls::Each(values) => Some(&values[(env * steps + step) * nu..][..nu]),
        }
    }
}

/// Returns the bytes per environment.
pub(super) fn row_bytes<S>(outputs: &[OutputRows<S>]) -> usize {
    outputs.iter().map(|own| own.rows.row_bytes()).sum()
}
