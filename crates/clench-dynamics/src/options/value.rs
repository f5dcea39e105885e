//! The values of options, and their ranges.

use clench_solver::{ConstraintSolver, Switch};
use std::fmt;

/// The shape of frictional contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrictionCone {
    /// Linearised: 2(condim − 1) edges.
    #[default]
    Pyramidal,
    /// The exact cone.
    Elliptic,
}

/// The law of friction in contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactModel {
    /// MuJoCo's convex model: sliding friction adds to the normal force.
    #[default]
    Convex,
    /// Coulomb's law: friction opposes sliding with μ times the normal force, which it does not change.
    Coulomb,
}

/// The maximum number of contacts of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MaxContacts {
    /// Buffers grow as needed.
    #[default]
    Auto,
    /// At most this many; more are reported as an overflow.
    Limit(usize),
}

macro_rules! declare_values {
    ($($(#[$doc:meta])* $variant:ident($type:ty): $description:literal, $keywords:expr;)*) => {
        /// The value of some option.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum OptionValue {
            $($(#[$doc])* $variant($type),)*
        }

        impl OptionValue {
            /// Returns the description of a value of this type.
            pub fn description(self) -> &'static str {
                match self { $(OptionValue::$variant(_) => $description,)* }
            }

            /// Returns the keywords of values of this type; a number is written in digits.
            pub fn keywords(self) -> &'static [(&'static str, OptionValue)] {
                match self { $(OptionValue::$variant(_) => $keywords,)* }
            }
        }

        $(impl From<$type> for OptionValue {
            fn from(value: $type) -> Self {
                OptionValue::$variant(value)
            }
        }

        /// Returns a value of another type as the error.
        impl TryFrom<OptionValue> for $type {
            type Error = OptionValue;
            fn try_from(value: OptionValue) -> Result<Self, OptionValue> {
                match value {
                    OptionValue::$variant(value) => Ok(value),
                    other => Err(other),
                }
            }
        })*
    };
}

declare_values! {
    /// A count.
    Count(usize): "an integer that is not negative", &[];
    /// A real number.
    Number(f64): "a number", &[];
    /// A truth value.
    Truth(bool): "true or false", &[("false", OptionValue::Truth(false)), ("true", OptionValue::Truth(true))];
    /// A choice that the model makes unless the user does.
    Choice(Switch): "auto, on or off", &[
        ("auto", OptionValue::Choice(Switch::Auto)),
        ("on", OptionValue::Choice(Switch::On)),
        ("off", OptionValue::Choice(Switch::Off)),
    ];
    /// A limit on contacts.
    Limit(MaxContacts): "auto or a number of contacts", &[("auto", OptionValue::Limit(MaxContacts::Auto))];
    /// An algorithm.
    Algorithm(ConstraintSolver): "Newton or CG", &[
        ("Newton", OptionValue::Algorithm(ConstraintSolver::Newton)),
        ("CG", OptionValue::Algorithm(ConstraintSolver::Cg)),
    ];
    /// A shape of friction cones.
    Cone(FrictionCone): "pyramidal or elliptic", &[
        ("pyramidal", OptionValue::Cone(FrictionCone::Pyramidal)),
        ("elliptic", OptionValue::Cone(FrictionCone::Elliptic)),
    ];
    /// A law of friction.
    Law(ContactModel): "convex or coulomb", &[
        ("convex", OptionValue::Law(ContactModel::Convex)),
        ("coulomb", OptionValue::Law(ContactModel::Coulomb)),
    ];
}

impl OptionValue {
    /// Returns its keyword in a list.
    pub fn keyword_in(self, keywords: &[(&'static str, OptionValue)]) -> Option<&'static str> {
        let found = keywords.iter().find(|(_, value)| *value == self);
        found.map(|&(keyword, _)| keyword)
    }
}

/// Writes the value as in text formats.
impl fmt::Display for OptionValue {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            OptionValue::Count(n) | OptionValue::Limit(MaxContacts::Limit(n)) => write!(out, "{n}"),
            OptionValue::Number(x) if x.fract() == 0.0 && x.abs() < 1e6 => write!(out, "{x}"),
            OptionValue::Number(x) => write!(out, "{x:?}"),
            other => out.write_str(other.keyword_in(other.keywords()).unwrap_or_default()),
        }
    }
}

/// The range of the number of an option.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// All values of the type.
    Any,
    /// Finite and zero or more.
    NotNegative,
    /// Finite and more than zero.
    Positive,
}

impl Range {
    /// Returns true if a value is in the range.
    pub fn holds(self, value: OptionValue) -> bool {
        let OptionValue::Number(x) = value else {
            return true;
        };
        match self {
            Range::Any => true,
            Range::NotNegative => x >= 0.0 && x.is_finite(),
            Range::Positive => x > 0.0 && x.is_finite(),
        }
    }

    /// Returns the range as text.
    pub fn text(self) -> &'static str {
        match self {
            Range::Any => "any",
            Range::NotNegative => "finite and not negative",
            Range::Positive => "finite and positive",
        }
    }
}

/// An option outside its range, or of another type.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("option {name} is {value}, but must be {range}")]
pub struct OptionError {
    /// The name of the option.
    pub name: &'static str,
    /// Its value.
    pub value: OptionValue,
    /// The allowed range.
    pub range: &'static str,
}
