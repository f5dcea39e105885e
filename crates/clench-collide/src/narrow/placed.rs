//! A shape where it is.

use crate::{Pose, Shape};

/// A shape where it is.
#[derive(Clone, Copy)]
pub(super) struct Placed<'a, X, T> {
    pub(super) shape: X,
    pub(super) pose: &'a Pose<T>,
}

/// A shape of any kind where it is.
pub(super) type AnyPlaced<'a, T> = Placed<'a, Shape<'a, T>, T>;

impl<'a, X: Into<Shape<'a, T>>, T> Placed<'a, X, T> {
    /// The same as a shape of any kind.
    #[inline(always)]
    pub(super) fn any(self) -> AnyPlaced<'a, T> {
        Placed {
            shape: self.shape.into(),
            pose: self.pose,
        }
    }
}
