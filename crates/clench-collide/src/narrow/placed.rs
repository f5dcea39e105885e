//! A shape where it is.

use crate::{Pose, Shape};

/// A shape where it is.
#[derive(Clone, Copy)]
pub(super) struct Placed<'a, T> {
    pub(super) shape: &'a Shape<'a, T>,
    pub(super) pose: &'a Pose<T>,
}
