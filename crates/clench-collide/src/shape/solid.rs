//! What every shape answers about itself.

use crate::ray::line::Line;
use clench_math::{Real, Vec3};

/// A shape about its own origin, in one environment or several side by side.
pub(crate) trait Solid<T: Real>: Copy {
    /// The same shape in one environment.
    type Alone: Copy;

    /// The shape of one lane.
    fn lane(&self, lane: usize) -> Self::Alone;

    /// Its size as [`ShapeKind`](crate::ShapeKind) says, m.
    fn size(&self) -> Vec3<T>;

    /// The radius in metres of a sphere about the origin that holds it.
    fn bounding_radius(&self) -> T;

    /// How far it reaches from its origin along a local unit vector d, at most: its support function, or that of a box that holds it.
    fn reach_along(&self, d: Vec3<T>) -> T;

    /// Half the lengths of the box about it along its own axes, m.
    #[inline(always)]
    fn half_lengths(&self) -> Vec3<T> {
        self.size()
    }

    /// Where a local point lies in it.
    fn contains(&self, point: Vec3<T>) -> T::Mask;

    /// How far along a local line it is hit first, infinite if nowhere, and the outward unit normal there; that of a miss means nothing.
    fn hit(&self, line: &Line<T>) -> (T, Vec3<T>);
}

/// How much room a homogeneous solid takes, and how its mass resists rotation. Textbook integrals; where MuJoCo approximates (the
/// ellipsoid's shell, a height field as a box) its approximation is used, so that a file means the same mass.
pub(crate) trait Homogeneous {
    /// Volume in m³, or with `shell` the surface in m².
    fn measure(&self, shell: bool) -> f64;

    /// Principal moments in kg m² about the origin, along the axes, of a mass in kg that is spread evenly over the volume, or with
    /// `shell` over the surface.
    fn moments(&self, mass: f64, shell: bool) -> Vec3<f64>;
}

/// Moments about an axis of symmetry z and across it.
pub(super) fn axial(across: f64, along: f64) -> Vec3<f64> {
    Vec3::new(across, across, along)
}

/// Moments from second moments ∫x² dm, ∫y² dm, ∫z² dm: about an axis, the other two add up.
pub(super) fn about_axes(second: Vec3<f64>) -> Vec3<f64> {
    Vec3::new(
        second.y + second.z,
        second.x + second.z,
        second.x + second.y,
    )
}

/// Where each coordinate is at most so far from zero.
#[inline(always)]
pub(super) fn within<T: Real>(p: Vec3<T>, half: Vec3<T>) -> T::Mask {
    p.x.abs().le(half.x) & p.y.abs().le(half.y) & p.z.abs().le(half.z)
}
