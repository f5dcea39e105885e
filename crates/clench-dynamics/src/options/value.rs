//! The values that options can have, and what they may be.

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

/// How many contacts a step may hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MaxContacts {
    /// Buffers grow as needed.
    #[default]
    Auto,
    /// At most this many; more are reported as an overflow.
    Limit(usize),
}

macro_rules! declare_values {
    ($($(#[$doc:meta])* $variant:ident($type:ty): $what:literal, $words:expr;)*) => {
        /// The value of some option.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum OptionValue {
            $($(#[$doc])* $variant($type),)*
        }

        impl OptionValue {
            /// What a value of this type is, in a sentence.
            pub fn what(self) -> &'static str {
                match self { $(OptionValue::$variant(_) => $what,)* }
            }

            /// The words that values of this type have in text; a number is its digits.
            pub fn words(self) -> &'static [(&'static str, OptionValue)] {
                match self { $(OptionValue::$variant(_) => $words,)* }
            }
        }

        $(impl From<$type> for OptionValue {
            fn from(value: $type) -> Self {
                OptionValue::$variant(value)
            }
        }

        /// Gives a value of another type back.
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
    /// A number of things.
    Count(usize): "an integer that is not negative", &[];
    /// A real number.
    Number(f64): "a number", &[];
    /// Yes or no.
    Truth(bool): "true or false", &[("false", OptionValue::Truth(false)), ("true", OptionValue::Truth(true))];
    /// A choice that the model makes unless the user does.
    Choice(Switch): "auto, on or off", &[
        ("auto", OptionValue::Choice(Switch::Auto)),
        ("on", OptionValue::Choice(Switch::On)),
        ("off", OptionValue::Choice(Switch::Off)),
    ];
    /// A bound on contacts.
    Limit(MaxContacts): "auto or a number of contacts", &[("auto", OptionValue::Limit(MaxContacts::Auto))];
    /// An algorithm.
    Algorithm(ConstraintSolver): "Newton or CG", &[
        ("Newton", OptionValue::Algorithm(ConstraintSolver::Newton)),
        ("CG", OptionValue::Algorithm(ConstraintSolver::Cg)),
    ];
    /// A shape of contacts.
    Cone(FrictionCone): "pyramidal or elliptic", &[
        ("pyramidal", OptionValue::Cone(FrictionCone::Pyramidal)),
        ("elliptic", OptionValue::Cone(FrictionCone::Elliptic)),
    ];
}

impl OptionValue {
    /// The word for it among `words`.
    pub fn word(self, words: &[(&'static str, OptionValue)]) -> Option<&'static str> {
        let found = words.iter().find(|(_, value)| *value == self);
        found.map(|&(word, _)| word)
    }
}

/// As it is written in text.
impl fmt::Display for OptionValue {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            OptionValue::Count(n) | OptionValue::Limit(MaxContacts::Limit(n)) => write!(out, "{n}"),
            OptionValue::Number(x) if x.fract() == 0.0 && x.abs() < 1e6 => write!(out, "{x}"),
            OptionValue::Number(x) => write!(out, "{x:?}"),
            other => out.write_str(other.word(other.words()).unwrap_or_default()),
        }
    }
}

/// What the number of an option may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// All that its type can hold.
    Any,
    /// Finite and zero or more.
    NotNegative,
    /// Finite and more than zero.
    Positive,
}

impl Range {
    /// Whether a value lies in it.
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

    /// The range in words.
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
    /// Which option.
    pub name: &'static str,
    /// Its value.
    pub value: OptionValue,
    /// What it may be.
    pub range: &'static str,
}
