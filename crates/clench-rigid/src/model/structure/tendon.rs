//! Tendons.

use std::ops::Range;

/// A fixed tendon: Σ coef · joint position.
#[derive(Clone, Debug)]
pub struct Tendon {
    /// Name, possibly empty.
    pub name: String,
    /// Joint of each term; coefficients are `params.wrap_coef` over the same range.
    pub joints: Vec<usize>,
    /// Where the coefficients start in `params.wrap_coef`.
    pub coefs: Range<usize>,
    /// Its range is a limit.
    pub limited: bool,
    /// Its total actuator force is limited.
    pub actfrclimited: bool,
    /// It may have dry friction.
    pub frictionloss: bool,
}
