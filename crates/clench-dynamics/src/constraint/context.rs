//! The inputs of all kinds of constraint.

use crate::dynamics::metric::Metric;
use crate::model::{Model, Params};
use crate::settings::StepSettings;
use crate::sleep::Sleep;
use crate::stages::{Positions, Velocities};
use crate::state::State;
use crate::stiction::Stiction;
use clench_math::Real;

/// The inputs of all kinds of constraint.
pub(super) struct ConstraintContext<'a, T: Real> {
    pub(super) model: &'a Model,
    pub(super) params: &'a Params<T>,
    pub(super) settings: &'a StepSettings,
    pub(super) state: &'a State<T>,
    pub(super) position: &'a Positions<T>,
    pub(super) velocity: &'a Velocities<T>,
    pub(super) sleep: &'a Sleep<T>,
    /// The displacements of friction, with the option `stiction`.
    pub(super) stiction: Option<&'a Stiction<T>>,
    /// The minimum time constant, s.
    pub(super) min_timeconst: T,
    /// The ratio of friction to normal impedance.
    pub(super) impratio: T,
    /// The metric, if steps evaluate constraints at their end.
    pub(super) metric: Option<&'a Metric<T>>,
}
