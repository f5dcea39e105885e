//! What a step is told besides model and state: the options of user and file, decided, and the feature switches.

use crate::Model;
use crate::contact::check_supported;
use crate::error::SimError;
use crate::model::Flags;
use clench_math::Real;
use clench_solver::{RigidOptions, Settings, Switch};

/// Every choice that a step reads. What the user sets wins over the file, the file over the defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSettings {
    /// Solver settings, which also hold cone, impratio and the floor of time constants.
    pub solver: Settings,
    /// Feature switches of the model, less what the settings turn off.
    pub flags: Flags,
    /// Joint limits act (tendon limits do not depend on this).
    pub joint_limits: bool,
}

/// An option outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("option {name} is {value}, but must be {range}")]
pub struct OptionError {
    /// Which option.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// What it may be.
    pub range: &'static str,
}

impl StepSettings {
    /// Decides every option for a simulation of `model` in the number type `T`.
    ///
    /// # Errors
    /// An option that is not finite or outside its range.
    pub fn new<T: Real>(model: &Model, user: RigidOptions) -> Result<Self, OptionError> {
        let options = user.or(model.options);
        let mut solver = options.resolve::<T>();
        solver.max_matrix = usize::try_from(model.budget.matrix).unwrap_or(usize::MAX);
        check(&solver)?;
        // A switch of the file is a setting of the file: what the user says about the same thing wins.
        let mut flags = model.flags;
        flags.constraint = match user.disable_constraint {
            Some(disable) => !disable,
            None => flags.constraint && !solver.disable_constraint,
        };
        flags.sleep &= model.may_sleep();
        let file_limits = flags.limit && solver.enable_joint_limit;
        let joint_limits = user.enable_joint_limit.unwrap_or(file_limits);
        if user.warmstart.is_none() {
            solver.warmstart &= flags.warmstart;
        }
        if user.islands.is_none() && !flags.island {
            solver.islands = Switch::Off;
        }
        Ok(StepSettings {
            solver,
            flags,
            joint_limits,
        })
    }

    /// The same for a model whose contacts are then sought.
    ///
    /// # Errors
    /// As [`new`](Self::new), and shapes that may meet and cannot be collided.
    pub(crate) fn supported<T: Real>(model: &Model, user: RigidOptions) -> Result<Self, SimError> {
        let settings = StepSettings::new::<T>(model, user)?;
        if settings.flags.constraint && settings.flags.contact {
            check_supported(model)?;
        }
        Ok(settings)
    }
}

fn check(s: &Settings) -> Result<(), OptionError> {
    let at_least_zero = [
        ("tolerance", s.tolerance),
        ("ls_tolerance", s.ls_tolerance),
        ("noslip_tolerance", s.noslip_tolerance),
        ("constraint_timeconst", s.constraint_timeconst),
    ];
    for (name, value) in at_least_zero {
        if !(value >= 0.0 && value.is_finite()) {
            let range = "finite and not negative";
            return Err(OptionError { name, value, range });
        }
    }
    let (name, value) = ("impratio", s.impratio);
    if !(value > 0.0 && value.is_finite()) {
        let range = "finite and positive";
        return Err(OptionError { name, value, range });
    }
    Ok(())
}
