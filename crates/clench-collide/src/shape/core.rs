//! Convex bodies by their support functions, as a core plus a radius.
//!
//! The support function s(d) of a body is its extent along the unit direction d. Its gradient is the furthest point,
//! and its Hessian the derivative of that point with respect to d: a matrix whose eigenvalues are radii of curvature.
//!
//! ```text
//! point      0                                  segment   h |d·z|
//! ellipsoid  |S d|,  S = diag(semi-axes)        cylinder  r |d across z| + h |d·z|
//! box        Σ hᵢ |dᵢ|                           hull      max v·d over its vertices v
//! ```
//!
//! A ball of radius ρ rolls freely within a body whose radii of curvature are nowhere below ρ (Blaschke's theorem), so
//! the body is a smaller convex core, s(d) − ρ, plus that ball. A sphere is a point plus a ball, a capsule a segment
//! plus a ball, an ellipsoid with ρ = (least semi-axis)² / (largest semi-axis) a core plus a ball. If only the layers
//! of the balls overlap, the cores are apart and their distance is a convex problem with one solution.

use super::feature::Feature;
use clench_math::{Scalar, Vec3};

/// A convex core in its own frame, for the search for the largest gap.
pub(crate) trait Core<S: Scalar> {
    /// Returns the radius of the ball that is added to the core, m.
    fn radius(&self) -> S {
        S::ZERO
    }

    /// Returns the point of the core that is furthest along `d`, a direction of any length. Among several corners or
    /// ends, it returns the one further along `side`, which is `d` or near it.
    fn support(&self, d: Vec3<S>, side: Vec3<S>) -> Vec3<S>;

    /// Returns the same with the number of the corner, if the core is a polyhedron, or 0.
    #[inline]
    fn corner_along(&self, d: Vec3<S>, side: Vec3<S>) -> (Vec3<S>, u32) {
        (self.support(d, side), 0)
    }

    /// Returns the feature of the core that is furthest along the unit direction `d`. The order of its corners depends
    /// only on the feature.
    fn feature(&self, d: Vec3<S>) -> Feature<S>;

    /// Returns the Hessian of the core's support function at the unit direction `d`.
    #[inline]
    fn curvature(&self, _: Vec3<S>) -> Curvature<S> {
        Curvature::NONE
    }

    /// Returns true if the core is the origin alone.
    fn is_point(&self) -> bool {
        false
    }

    /// Returns true if the core has curved parts.
    fn is_curved(&self) -> bool {
        false
    }

    /// Returns the point of the core nearest to a point, if there is a closed form.
    fn nearest(&self, _: impl FnOnce() -> Vec3<S>) -> Option<Vec3<S>> {
        None
    }

    /// Returns the component of a point of the core that jumps at creases of the support function: the corner of a box,
    /// the end of a segment or of a cylinder's axis. Their differences span edges and faces.
    #[inline]
    fn corner(&self, point: Vec3<S>) -> Vec3<S> {
        point
    }

    /// Returns the radius of the flat round cap across the z axis, if the core has one.
    fn cap(&self) -> Option<S> {
        None
    }

    /// Returns the axes along which it has straight edges; none for a hull.
    fn edge_axes(&self) -> &'static [usize] {
        &[]
    }

    /// Returns the axes across which it has flat faces; none for a hull.
    fn face_axes(&self) -> &'static [usize] {
        &[]
    }
}

/// The derivative of a core's support point with respect to the direction: the matrix λ (Q − p pᵀ) − ρ 1 with a
/// diagonal Q.
///
/// For an ellipsoid Q = S², p = S² d / |S d| and λ = 1 / |S d|. For the cap circle of a cylinder p is the tangent of
/// the circle, and −λ its radius over the length of d in its plane.
pub(crate) struct Curvature<S> {
    pub share: S,
    pub diagonal: Vec3<S>,
    pub flat: Vec3<S>,
    pub radius: S,
}

impl<S: Scalar> Curvature<S> {
    /// The curvature of a corner, which does not move.
    pub(crate) const NONE: Self = Curvature {
        share: S::ZERO,
        diagonal: Vec3::ZERO,
        flat: Vec3::ZERO,
        radius: S::ZERO,
    };

    /// Returns the bilinear form uᵀ H v.
    #[inline]
    pub(crate) fn between(&self, u: Vec3<S>, v: Vec3<S>) -> S {
        let bend = u.scale_by(self.diagonal).dot(v) - self.flat.dot(u) * self.flat.dot(v);
        self.share * bend - self.radius * u.dot(v)
    }
}

/// Returns the unit direction of `d` projected across z, where a cylinder's cap circle supports it; x if `d` is along
/// z.
#[inline]
pub(crate) fn radial_direction<S: Scalar>(d: Vec3<S>) -> (S, S) {
    let level = (d.x * d.x + d.y * d.y).sqrt();
    if level > S::MIN_POSITIVE {
        let inverse = S::ONE / level;
        (d.x * inverse, d.y * inverse)
    } else {
        (S::ONE, S::ZERO)
    }
}
