//! The numbers of joints and tendons that reach the parameters unchanged, as the table of
//! [`element_numbers`](clench_dynamics::element_numbers) lists them.

use clench_dynamics::model::{ParamField, Params};

/// The dimension of a number, which determines its scaling if a file scales lengths and masses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberDimension {
    /// A coordinate: a length or an angle.
    Coordinate,
    /// A force or torque along a coordinate.
    Force,
    /// A stiffness, a damping or an inertia along a coordinate.
    ForcePerCoordinate,
}

/// The valid values of a number of a description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberRange {
    Finite,
    NotNegative,
}

/// A row of the table.
#[derive(Debug)]
pub struct ElementNumber {
    /// The attribute in MJCF.
    pub name: &'static str,
    /// The parameter.
    pub param: ParamField,
    /// The dimension.
    pub dimension: NumberDimension,
    pub(super) range: NumberRange,
}

/// Appends the numbers of a description to the parameters.
pub(super) fn push(rows: &[ElementNumber], numbers: &[f64], params: &mut Params<f64>) {
    for (row, &number) in rows.iter().zip(numbers) {
        params.push(row.param, number);
    }
}

/// Declares a part of the table, and the functions that return its numbers of a description.
macro_rules! declare_numbers {
    ($spec:ident $(#[$about:meta])* $rows:ident $get:ident $get_mut:ident:
     $($name:ident: $param:ident, $range:ident, $rule:ident, $dimension:ident;)*) => {
        $(#[$about])*
        pub static $rows: [ElementNumber; [$(stringify!($name)),*].len()] = [$(ElementNumber {
            name: stringify!($name),
            param: ParamField::$param,
            dimension: NumberDimension::$dimension,
            range: NumberRange::$range,
        }),*];

        impl $spec {
            #[doc = concat!("Returns the numbers of [`", stringify!($rows), "`].")]
            pub fn $get(&self) -> [f64; $rows.len()] {
                [$(self.$name),*]
            }
            #[doc = concat!("Returns the numbers of [`", stringify!($rows), "`] for changes.")]
            pub fn $get_mut(&mut self) -> [&mut f64; $rows.len()] {
                [$(&mut self.$name),*]
            }
        }
    };
}
pub(super) use declare_numbers;
