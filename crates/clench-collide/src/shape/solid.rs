//! The properties of every shape.

use crate::ray::line::Line;
use clench_math::{Real, Vec3};

/// A shape about its own origin, in one environment or several in parallel.
pub(crate) trait Solid<T: Real>: Copy {
    /// The same shape of one environment, in double precision.
    type InDouble: Copy;

    /// Returns the shape of one lane in double precision.
    fn lane_in_double(&self, lane: usize) -> Self::InDouble;

    /// Returns the size as defined by [`ShapeKind`](crate::ShapeKind), m.
    fn size(&self) -> Vec3<T>;

    /// Returns the radius in metres of a sphere about the origin that encloses the shape.
    fn bounding_radius(&self) -> T;

    /// Returns the support function along a local unit vector d, or an upper bound: that of an enclosing box.
    fn reach_along(&self, d: Vec3<T>) -> T;

    /// Returns half the lengths of the bounding box along the shape's axes, m.
    #[inline(always)]
    fn half_lengths(&self) -> Vec3<T> {
        self.size()
    }

    /// Returns the lanes that contain a local point.
    fn contains(&self, point: Vec3<T>) -> T::Mask;

    /// Returns the distance of the first hit along a local line, infinite if there is none, and the outward unit
    /// normal, which is meaningless for a miss.
    fn hit(&self, line: &Line<T>) -> (T, Vec3<T>);
}

/// Volume and moments of inertia of a homogeneous solid, exact except where MuJoCo approximates (the ellipsoid's shell,
/// a height field as a box), so that a model has the same mass in both.
pub(crate) trait Homogeneous {
    /// Computes the volume in m³, or with `shell` the surface area in m².
    fn measure(&self, shell: bool) -> f64;

    /// Computes the principal moments in kg m² about the origin, along the axes, of a mass in kg distributed evenly
    /// over the volume, or with `shell` over the surface.
    fn moments(&self, mass: f64, shell: bool) -> Vec3<f64>;
}

/// Returns the moments of a body symmetric about z.
pub(super) fn axial(across: f64, along: f64) -> Vec3<f64> {
    Vec3::new(across, across, along)
}

/// Returns moments from second moments ∫x² dm, ∫y² dm, ∫z² dm: about an axis, the other two add up.
pub(super) fn about_axes(second: Vec3<f64>) -> Vec3<f64> {
    Vec3::new(
        second.y + second.z,
        second.x + second.z,
        second.x + second.y,
    )
}

/// Returns the lanes with |pᵢ| ≤ halfᵢ.
#[inline(always)]
pub(super) fn within<T: Real>(p: Vec3<T>, half: Vec3<T>) -> T::Mask {
    p.x.abs().le(half.x) & p.y.abs().le(half.y) & p.z.abs().le(half.z)
}
