//! Shapes with their poses.

use crate::pose::Pose;
use crate::shape::Shape;

/// A shape and its pose.
#[derive(Clone, Copy)]
pub(super) struct Placed<'a, X, T> {
    pub(super) shape: X,
    pub(super) pose: &'a Pose<T>,
}

/// A shape of any kind and its pose.
pub(super) type AnyPlaced<'a, T> = Placed<'a, Shape<'a, T>, T>;

impl<'a, X: Into<Shape<'a, T>>, T> Placed<'a, X, T> {
    /// Converts to a shape of any kind.
    #[inline(always)]
    pub(super) fn any(self) -> AnyPlaced<'a, T> {
        Placed {
            shape: self.shape.into(),
            pose: self.pose,
        }
    }
}
