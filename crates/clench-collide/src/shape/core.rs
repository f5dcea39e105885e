//! Convex bodies by their support functions, as a core plus a radius.
//!
//! The support function s(d) of a body is how far it reaches along the unit direction d, its gradient is the point that
//! reaches so far, and its Hessian says how that point moves as d turns: a matrix whose eigenvalues are radii of curvature.
//!
//! ```text
//! point      0                                  segment   h |d·z|
//! ellipsoid  |S d|,  S = diag(semi-axes)        cylinder  r |d across z| + h |d·z|
//! box        Σ hᵢ |dᵢ|                           hull      max v·d over its vertices v
//! ```
//!
//! A ball of radius ρ rolls freely within a body whose radii of curvature are nowhere below ρ (Blaschke's theorem), so the
//! body is a smaller convex core, s(d) − ρ, plus that ball. A sphere is a point plus a ball, a capsule a segment plus a ball,
//! an ellipsoid with ρ = (least semi-axis)² / (largest semi-axis) a core plus a ball. As long as only the balls' layers
//! overlap, the cores are apart and their distance is a convex problem with one solution.

use super::feature::Feature;
use clench_math::{Scalar, Vec3};

/// What the search for the largest gap asks of a convex core, in its own frame.
pub(crate) trait Core<S: Scalar> {
    /// The radius of the ball that is added to the core, m.
    fn radius(&self) -> S {
        S::ZERO
    }

    /// The point of the core that is furthest along `d`, a direction of any length. Of several corners or ends that are, the one further
    /// along `side`, which is `d` or next to it.
    fn support(&self, d: Vec3<S>, side: Vec3<S>) -> Vec3<S>;

    /// The feature of the core that is furthest along the unit direction `d`. Its corners come in an order that depends on the feature
    /// alone.
    fn feature(&self, d: Vec3<S>) -> Feature<S>;

    /// The Hessian of the core's support function at the unit direction `d`.
    #[inline]
    fn curvature(&self, _: Vec3<S>) -> Curvature<S> {
        Curvature::NONE
    }

    /// Whether the core is the origin alone.
    fn is_point(&self) -> bool {
        false
    }

    /// Whether the core has curved parts.
    fn is_curved(&self) -> bool {
        false
    }

    /// The point of the core that is nearest to a point, where a closed form tells.
    fn nearest(&self, _: impl FnOnce() -> Vec3<S>) -> Option<Vec3<S>> {
        None
    }

    /// The part of a point of the core that jumps where the support function has a crease: the corner of a box, the end of
    /// a segment or of a cylinder's axis. Edges and faces are spanned by differences of these.
    #[inline]
    fn corner(&self, point: Vec3<S>) -> Vec3<S> {
        point
    }

    /// The radius of the flat round cap across the z axis, if the core has one.
    fn cap(&self) -> Option<S> {
        None
    }

    /// The axes along which it has straight edges. None are told of a hull.
    fn edge_axes(&self) -> &'static [usize] {
        &[]
    }

    /// The axes across which it has flat faces. None are told of a hull.
    fn face_axes(&self) -> &'static [usize] {
        &[]
    }
}

/// How the supporting point of a core moves with the direction: the matrix λ (Q − p pᵀ) − ρ 1 with a diagonal Q.
///
/// For an ellipsoid Q = S², p = S² d / |S d| and λ = 1 / |S d|. For the cap circle of a cylinder p is the direction along it, and −λ
/// its radius over the part of d in its plane.
pub(crate) struct Curvature<S> {
    pub share: S,
    pub diagonal: Vec3<S>,
    pub flat: Vec3<S>,
    pub radius: S,
}

impl<S: Scalar> Curvature<S> {
    /// The curvature at a corner, which does not move.
    pub(crate) const NONE: Self = Curvature {
        share: S::ZERO,
        diagonal: Vec3::ZERO,
        flat: Vec3::ZERO,
        radius: S::ZERO,
    };

    /// The matrix between two vectors, uᵀ H v.
    #[inline]
    pub(crate) fn between(&self, u: Vec3<S>, v: Vec3<S>) -> S {
        let bend = u.scale_by(self.diagonal).dot(v) - self.flat.dot(u) * self.flat.dot(v);
        self.share * bend - self.radius * u.dot(v)
    }
}

/// The unit direction of `d` projected across z: where on a cap's circle a cylinder supports it; x where `d` points along z.
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
