//! A step in plain numbers, and its actuators.

use super::curves::Curves;
use crate::source::Source;
use clench_dynamics::model::{Model, Params};
use clench_dynamics::{State, StepSettings, Workspace};

/// A step in plain numbers, whose derivatives are wanted.
pub(super) struct Step<'a> {
    pub model: &'a Model,
    pub params: &'a Params<f64>,
    pub settings: &'a StepSettings,
    pub before: &'a State<f64>,
    pub plain: &'a Workspace<f64>,
    pub curves: &'a Curves,
}

impl<'a> Step<'a> {
    /// Creates the step from the state `before`, whose results `plain` contains.
    pub(super) fn new(
        source: Source<'a>,
        before: &'a State<f64>,
        plain: &'a Workspace<f64>,
        curves: &'a Curves,
    ) -> Self {
        Step {
            model: source.model,
            params: source.params,
            settings: source.settings,
            before,
            plain,
            curves,
        }
    }

    /// Returns 0 if the range of a joint holds the total force of its actuators, else 1.
    pub(super) fn passed_share(&self, joint: usize) -> f64 {
        let [low, high] = self.params.jnt_actfrcrange[joint];
        let joint = &self.model.joints[joint];
        let total = self.plain.force.qfrc_actuator[joint.dof];
        let held = joint.actfrclimited && (total <= low || total >= high);
        f64::from(u8::from(!held))
    }
}
