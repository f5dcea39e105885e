//! The inputs of all kinds of constraint.

use super::softness::Softness;
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

/// The inputs of the softness of contacts and limits that are common to all of them.
#[derive(Clone, Copy)]
pub(super) struct SoftnessLimits<'a, T> {
    pub(super) settings: &'a StepSettings,
    /// The minimum time constant, s.
    pub(super) min_timeconst: T,
    /// The ratio of friction to normal impedance.
    pub(super) impratio: T,
    /// True with the option `stiction`.
    pub(super) sticks: bool,
    /// The length of a step that evaluates constraints at its end and limits their stiffness, s.
    pub(super) timestep: Option<T>,
}

impl<T: Real> SoftnessLimits<'_, T> {
    /// Returns the softness of a limit or contact, with its stiffness limited to what a step resolves.
    #[inline(always)]
    pub(super) fn resolved(&self, soft: Softness<T>, solref: [T; 2]) -> Softness<T> {
        match self.timestep {
            Some(timestep) => soft.resolved(solref, timestep),
            None => soft,
        }
    }
}

impl<'a, T: Real> ConstraintContext<'a, T> {
    /// Returns the common inputs of softness.
    #[inline(always)]
    pub(super) fn limits(&self) -> SoftnessLimits<'a, T> {
        let limited = self.metric.is_some() && self.settings.flags.refsafe;
        SoftnessLimits {
            settings: self.settings,
            min_timeconst: self.min_timeconst,
            impratio: self.impratio,
            sticks: self.stiction.is_some(),
            timestep: limited.then_some(self.params.timestep),
        }
    }
}
