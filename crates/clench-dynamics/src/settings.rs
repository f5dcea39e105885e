//! The settings of a step: the resolved options of user and file, and the feature switches.

use crate::Model;
use crate::contact::check_supported;
use crate::dynamics::discrete_limits::check_discrete;
use crate::error::SimError;
use crate::model::{Flags, Geom};
use crate::options::{ContactModel, FrictionCone, MaxContacts, OptionError, RigidOptions};
use clench_math::Real;
use clench_solver::{Settings, Switch};
use std::sync::Arc;

/// The stick references that a state has room for by default: some, and more for each geom that moves.
const MIN_STICK_PAIRS: usize = 16;
const STICK_PAIRS_PER_GEOM: usize = 3;
/// The smallest limit of evaluations of a line search with Coulomb's law. Shorter searches often find no step, and
/// solves then end with friction at limits that are not those of the normal forces.
const MIN_COULOMB_SEARCH: usize = 20;

macro_rules! declare_settings {
    (
        solver $solver:tt
        step {$(
            $(#[$doc:meta])*
            $name:ident: $type:ident = $default:expr $(=> $single:expr)?, $range:ident, $argument:expr, $mjcf:expr;
        )*}
    ) => {
        /// Every setting that a step reads. User options take precedence over the file, the file over the defaults.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct StepSettings {
            /// The settings of the solver.
            pub solver: Settings,
            /// Feature switches of the model, except those that the settings turn off.
            pub flags: Flags,
            $( $(#[$doc])* pub $name: $type, )*
        }

        impl StepSettings {
            /// Takes the options that are set, else defaults, and the flags of the model.
            fn resolve<T: Real>(options: RigidOptions, flags: Flags) -> Self {
                StepSettings {
                    solver: options.solver().resolve::<T>(),
                    flags,
                    $( $name: options.$name.unwrap_or({
                        $( if size_of::<T::Scalar>() < size_of::<f64>() { $single } else )? { $default }
                    }), )*
                }
            }
        }
    };
}

crate::rigid_options!(declare_settings);

impl StepSettings {
    /// Resolves every option for a simulation of `model` in the number type `T`.
    ///
    /// # Errors
    /// Returns an error if an option is not finite or outside its range.
    pub fn new<T: Real>(model: &Model, user: RigidOptions) -> Result<Self, OptionError> {
        let options = user.or(model.options);
        options.check()?;
        let mut settings = StepSettings::resolve::<T>(options, model.flags);
        if settings.contact_model == ContactModel::Coulomb {
            let evaluations = &mut settings.solver.ls_iterations;
            *evaluations = MIN_COULOMB_SEARCH.max(*evaluations);
        }
        settings.solver.max_matrix = usize::try_from(model.budget.matrix).unwrap_or(usize::MAX);
        // A switch of the file is a setting of the file: a user option on the same subject takes precedence.
        if user.disable_constraint.is_none() {
            settings.disable_constraint |= !model.flags.constraint;
        }
        settings.flags.constraint = !settings.disable_constraint;
        settings.flags.sleep &= model.may_sleep();
        if user.enable_joint_limit.is_none() {
            settings.enable_joint_limit &= model.flags.limit;
        }
        if user.warmstart.is_none() {
            settings.solver.warmstart &= model.flags.warmstart;
        }
        if user.islands.is_none() && !model.flags.island {
            settings.solver.islands = Switch::Off;
        }
        Ok(settings)
    }

    /// Does the same for a model whose contacts are detected.
    ///
    /// # Errors
    /// Returns the errors of [`new`](Self::new), and one if the integrator is incompatible with a feature, or if a pair
    /// of shapes that may collide is not supported.
    pub fn supported<T: Real>(model: &Model, user: RigidOptions) -> Result<Self, SimError> {
        let settings = StepSettings::new::<T>(model, user)?;
        check_discrete(model, settings.flags.sleep, settings.solver.islands)?;
        if settings.flags.constraint && settings.flags.contact {
            check_supported(model)?;
        }
        Ok(settings)
    }

    /// Returns the model with the slots for stick references that the settings require.
    #[must_use]
    pub fn adapt(&self, model: Arc<Model>) -> Arc<Model> {
        let wanted = self.stick_pairs(&model);
        if model.max_stick_pairs == wanted {
            return model;
        }
        let mut model = Arc::unwrap_or_clone(model);
        model.max_stick_pairs = wanted;
        Arc::new(model)
    }

    /// Checks that the model has the slots for stick references that the settings require.
    ///
    /// # Errors
    /// Returns an error if it does not.
    pub fn check_stick_references(&self, model: &Model) -> Result<(), SimError> {
        match self.stick_pairs(model) == model.max_stick_pairs {
            true => Ok(()),
            false if self.stiction == model.max_stick_pairs.is_some() => {
                Err(SimError::FixedOption("max_stick_pairs"))
            }
            false => Err(SimError::FixedOption("stiction")),
        }
    }

    /// Returns the number of slots for stick references that the settings require.
    fn stick_pairs(&self, model: &Model) -> Option<usize> {
        let collides = |geom: &&Geom| geom.contype != 0 || geom.conaffinity != 0;
        let moves = |geom: &&Geom| collides(geom) && !model.is_fixed(geom.body);
        self.stiction.then(|| match self.max_stick_pairs {
            0 => MIN_STICK_PAIRS + STICK_PAIRS_PER_GEOM * model.geoms.iter().filter(moves).count(),
            given => given,
        })
    }
}
