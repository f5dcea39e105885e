//! The user options. A table has a row for each option; the struct, its checks, the flags of the program, MJCF's
//! `<option>` and Python's class follow from it.

mod table;
mod value;

pub use value::{ContactModel, FrictionCone, MaxContacts, OptionError, OptionValue, Range};

use clench_solver::{ConstraintSolver, SolverOptions, Switch};

/// The flag of the program that sets an option.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Argument {
    /// A flag followed by the value.
    Value(&'static str),
    /// A flag that implies a value, and its help text.
    Sets(&'static str, OptionValue, &'static str),
}

/// The location of an option in MJCF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mjcf {
    /// An attribute of `<option>` with the value as text.
    Attribute(&'static str),
    /// An attribute of `<option>` with its own keywords. The first keyword of a value is the one that is written.
    Words(&'static str, &'static [(&'static str, OptionValue)]),
    /// An attribute of `<flag>`, and the values of "disable" and "enable".
    Flag(&'static str, [OptionValue; 2]),
    /// The data of a `<text>` in `<custom>`, which MuJoCo stores and ignores.
    Text(&'static str),
    /// Not in MJCF.
    Nowhere,
}

macro_rules! declare_options {
    ($($group:ident {$(
        $(#[doc = $doc:literal])*
        $name:ident: $type:ident = $default:expr $(=> $single:expr)?, $range:ident, $argument:expr, $mjcf:expr;
    )*})*) => {
        /// Options of the constraint model and its solver. Every field records whether it was set, so that the user's
        /// options take precedence over the file and the file over its format's defaults: `user.or(file).or(format)`.
        ///
        /// ```
        /// use clench_dynamics::options::RigidOptions;
        /// let user = RigidOptions::new().iterations(10);
        /// let file = RigidOptions::new().iterations(100).impratio(10.0);
        /// let both = user.or(file);
        /// assert_eq!((both.iterations, both.impratio, both.ls_iterations), (Some(10), Some(10.0), None));
        /// ```
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct RigidOptions {
            $($( $(#[doc = $doc])* pub $name: Option<$type>, )*)*
        }

        impl RigidOptions {
            $($( $(#[doc = $doc])*
            #[must_use]
            pub fn $name(mut self, value: $type) -> Self {
                self.$name = Some(value);
                self
            } )*)*

            /// Takes from `lower` the options that are not set here.
            #[must_use]
            pub fn or(self, lower: RigidOptions) -> Self {
                RigidOptions { $($( $name: self.$name.or(lower.$name), )*)* }
            }

            /// Returns the value of an option that is set.
            pub fn get(&self, option: RigidOption) -> Option<OptionValue> {
                match option {
                    $($( RigidOption::$name => self.$name.map(OptionValue::from), )*)*
                }
            }

            /// Sets an option.
            ///
            /// # Errors
            /// Returns an error, and sets nothing, if the type is wrong or the value is out of range.
            pub fn set(&mut self, option: RigidOption, value: OptionValue) -> Result<(), OptionError> {
                match option {
                    $($( RigidOption::$name => {
                        let own = value.try_into().map_err(|value| OptionError {
                            name: option.name(),
                            value,
                            range: option.default(false).description(),
                        })?;
                        option.check(value)?;
                        self.$name = Some(own);
                    } )*)*
                }
                Ok(())
            }
        }

        /// An option.
        #[allow(non_camel_case_types)] // Named as the fields are.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum RigidOption {
            $($( $(#[doc = $doc])* $name, )*)*
        }

        impl RigidOption {
            /// Every option, those of the solver first.
            pub const ALL: &[RigidOption] = &[$($( RigidOption::$name, )*)*];

            /// Returns the name.
            pub fn name(self) -> &'static str {
                match self { $($( RigidOption::$name => stringify!($name), )*)* }
            }

            /// Returns the description and the default.
            pub fn sentence(self) -> &'static str {
                match self { $($( RigidOption::$name => concat!($($doc),*).trim_ascii(), )*)* }
            }

            /// Returns the default value.
            pub fn default(self, single_precision: bool) -> OptionValue {
                match self {
                    $($( RigidOption::$name => {
                        let value: $type = $( if single_precision { $single } else )? { $default };
                        value.into()
                    } )*)*
                }
            }

            /// Returns the range of its numbers.
            pub fn range(self) -> Range {
                match self { $($( RigidOption::$name => Range::$range, )*)* }
            }

            /// Returns the flag of the program that sets it.
            pub fn argument(self) -> Argument {
                use Argument::{Value, Sets};
                use OptionValue::Truth;
                match self { $($( RigidOption::$name => $argument, )*)* }
            }

            /// Returns its location in MJCF.
            pub fn mjcf(self) -> Mjcf {
                use Mjcf::{Attribute, Flag, Nowhere, Text, Words};
                use OptionValue::{Algorithm, Choice, Truth};
                match self { $($( RigidOption::$name => $mjcf, )*)* }
            }
        }
    };
}

crate::rigid_options!(declare_options);

macro_rules! declare_solver_part {
    (
        solver {$(
            $(#[$doc:meta])*
            $name:ident: $type:ident = $default:expr $(=> $single:expr)?, $range:ident, $argument:expr, $mjcf:expr;
        )*}
        step $step:tt
    ) => {
        impl RigidOptions {
            /// Returns the options that the solver reads.
            pub fn solver(self) -> SolverOptions {
                SolverOptions { $( $name: self.$name, )* }
            }
        }
    };
}

crate::rigid_options!(declare_solver_part);

impl RigidOptions {
    /// Creates options with nothing set.
    pub fn new() -> Self {
        Self::default()
    }

    /// # Errors
    /// Returns an error for the first option that is out of its range.
    pub fn check(&self) -> Result<(), OptionError> {
        let set = |&option: &RigidOption| Some((option, self.get(option)?));
        let mut all = RigidOption::ALL.iter().filter_map(set);
        all.try_for_each(|(option, value)| option.check(value))
    }
}

impl RigidOption {
    /// # Errors
    /// Returns an error if the value is out of the range.
    pub fn check(self, value: OptionValue) -> Result<(), OptionError> {
        match self.range().holds(value) {
            true => Ok(()),
            false => Err(OptionError {
                name: self.name(),
                value,
                range: self.range().text(),
            }),
        }
    }
}
