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

use super::prism::Prism;
use crate::{Asset, Hull, Shape, ShapeKind};
use clench_math::{Scalar, Vec3};

/// A shape in its own frame.
#[derive(Clone)]
pub(super) struct Body<'a, S> {
    kind: ShapeKind,
    size: Vec3<S>,
    /// Of the ball that is added to the core, m.
    pub radius: S,
    /// Of a sphere about the origin that holds the body, m.
    pub bounding_radius: S,
    /// Of a mesh.
    pub hull: Option<&'a Hull>,
    /// Of a height field, the prism under the triangle at hand.
    prism: Option<&'a Prism<S>>,
}

impl<'a, S: Scalar> Body<'a, S> {
    /// The body of a bounded convex shape; a point for any other.
    pub(super) fn new(shape: &Shape<'a, S>) -> Self {
        let size = shape.size;
        let radius = match shape.kind {
            ShapeKind::Sphere | ShapeKind::Capsule => size.x,
            ShapeKind::Ellipsoid => {
                let least = size.x.min(size.y).min(size.z);
                let most = size.x.max(size.y).max(size.z);
                least * (least / most.max(S::MIN_POSITIVE))
            }
            _ => S::ZERO,
        };
        Body {
            kind: shape.kind,
            size,
            radius,
            bounding_radius: crate::bounding_radius(shape),
            hull: match shape.asset {
                Asset::Hull(hull) => Some(hull),
                _ => None,
            },
            prism: None,
        }
    }

    /// One triangle of a height field.
    pub(super) fn of_prism(prism: &'a Prism<S>) -> Self {
        Body {
            kind: ShapeKind::HeightField,
            size: Vec3::ZERO,
            radius: S::ZERO,
            bounding_radius: prism.bounding_radius(),
            hull: None,
            prism: Some(prism),
        }
    }

    /// Whether the core is but the origin.
    pub(super) fn is_point(&self) -> bool {
        self.kind == ShapeKind::Sphere
    }

    /// The point of the core that is nearest to a point, for the kinds whose size gives it in closed form.
    pub(super) fn nearest(&self, point: impl FnOnce() -> Vec3<S>) -> Option<Vec3<S>> {
        let s = self.size;
        let within = |x: S, half: S| x.clamp(-half, half);
        match self.kind {
            ShapeKind::Capsule => Some(Vec3::new(S::ZERO, S::ZERO, within(point().z, s.y))),
            ShapeKind::Box => {
                let p = point();
                Some(Vec3::new(
                    within(p.x, s.x),
                    within(p.y, s.y),
                    within(p.z, s.z),
                ))
            }
            ShapeKind::Cylinder => {
                let p = point();
                let level = (p.x * p.x + p.y * p.y).sqrt();
                let share = (s.x / level.max(S::MIN_POSITIVE)).min(S::ONE);
                Some(Vec3::new(p.x * share, p.y * share, within(p.z, s.y)))
            }
            _ => None,
        }
    }

    /// Whether the core has curved parts.
    pub(super) fn curved(&self) -> bool {
        matches!(self.kind, ShapeKind::Ellipsoid | ShapeKind::Cylinder)
    }

    /// The point of the core that is furthest along `d`, a direction of any length. Of several corners or ends that are, the one further
    /// along `side`, which is `d` or next to it.
    #[inline]
    pub(super) fn support(&self, d: Vec3<S>, side: Vec3<S>) -> Vec3<S> {
        let s = self.size;
        match self.kind {
            ShapeKind::Capsule => Vec3::new(S::ZERO, S::ZERO, s.y.copysign(side.z)),
            ShapeKind::Ellipsoid => {
                let scaled = d.scale_by(s);
                let length = scaled.norm().max(S::MIN_POSITIVE);
                let unit = d * (S::ONE / d.norm().max(S::MIN_POSITIVE));
                scaled.scale_by(s) * (S::ONE / length) - unit * self.radius
            }
            ShapeKind::Cylinder => {
                let (x, y) = radial_direction(d);
                Vec3::new(x * s.x, y * s.x, s.y.copysign(side.z))
            }
            ShapeKind::Box => Vec3::new(
                s.x.copysign(side.x),
                s.y.copysign(side.y),
                s.z.copysign(side.z),
            ),
            ShapeKind::Mesh => self.vertex(side).map_or(Vec3::ZERO, |(_, vertex)| vertex),
            ShapeKind::HeightField => self.prism.map_or(Vec3::ZERO, |p| p.support(side)),
            ShapeKind::Plane | ShapeKind::Sphere => Vec3::ZERO,
        }
    }

    /// The vertex of the hull that is furthest along `d`, with its number.
    #[inline]
    pub(super) fn vertex(&self, d: Vec3<S>) -> Option<(usize, Vec3<S>)> {
        let hull = self.hull?;
        let vertex = hull.support(Vec3::from_array(d.to_array().map(S::to_f64)));
        Some((vertex, Vec3::from_f64(hull.vertices()[vertex].to_array())))
    }

    /// The Hessian of the core's support function at the unit direction `d`.
    #[inline]
    pub(super) fn curvature(&self, d: Vec3<S>) -> Curvature<S> {
        let s = self.size;
        match self.kind {
            ShapeKind::Ellipsoid => {
                let scaled = d.scale_by(s);
                let inverse = S::ONE / scaled.norm().max(S::MIN_POSITIVE);
                Curvature {
                    share: inverse,
                    diagonal: s.scale_by(s),
                    flat: scaled.scale_by(s) * inverse,
                    radius: self.radius,
                }
            }
            ShapeKind::Cylinder => {
                let (x, y) = radial_direction(d);
                let level = (d.x * d.x + d.y * d.y).sqrt().max(S::EPSILON);
                Curvature {
                    share: -s.x / level,
                    flat: Vec3::new(-y, x, S::ZERO),
                    ..Curvature::NONE
                }
            }
            _ => Curvature::NONE,
        }
    }

    /// Of a point of the core, the part that jumps where the support function has a crease: the corner of a box, the end of
    /// a segment or of a cylinder's axis. Edges and faces are spanned by differences of these.
    #[inline]
    pub(super) fn corner(&self, point: Vec3<S>) -> Vec3<S> {
        match self.kind {
            ShapeKind::Ellipsoid => Vec3::ZERO,
            ShapeKind::Cylinder => Vec3::new(S::ZERO, S::ZERO, point.z),
            _ => point,
        }
    }

    /// The radius of the flat round cap across the z axis, if the body has one.
    pub(super) fn cap(&self) -> Option<S> {
        (self.kind == ShapeKind::Cylinder).then_some(self.size.x)
    }

    /// The axes along which it has straight edges. None are told of a hull.
    pub(super) fn edge_axes(&self) -> &'static [usize] {
        match self.kind {
            ShapeKind::Box => &[0, 1, 2],
            ShapeKind::Cylinder | ShapeKind::Capsule => &[2],
            _ => &[],
        }
    }
    /// The axes across which it has flat faces. None are told of a hull.
    pub(super) fn face_axes(&self) -> &'static [usize] {
        match self.kind {
            ShapeKind::Box => &[0, 1, 2],
            ShapeKind::Cylinder => &[2],
            _ => &[],
        }
    }

    pub(super) fn kind(&self) -> ShapeKind {
        self.kind
    }
    pub(super) fn size(&self) -> Vec3<S> {
        self.size
    }
    pub(super) fn prism(&self) -> Option<&'a Prism<S>> {
        self.prism
    }
}

/// How the supporting point of a core moves with the direction: the matrix λ (Q − p pᵀ) − ρ 1 with a diagonal Q.
///
/// Of an ellipsoid Q = S², p = S² d / |S d| and λ = 1 / |S d|. Of the cap circle of a cylinder p is the direction along it, and −λ
/// its radius over the part of d in its plane.
pub(super) struct Curvature<S> {
    share: S,
    diagonal: Vec3<S>,
    flat: Vec3<S>,
    radius: S,
}

impl<S: Scalar> Curvature<S> {
    /// Of a corner.
    const NONE: Self = Curvature {
        share: S::ZERO,
        diagonal: Vec3::ZERO,
        flat: Vec3::ZERO,
        radius: S::ZERO,
    };

    /// The matrix between two vectors, uᵀ H v.
    #[inline]
    pub(super) fn between(&self, u: Vec3<S>, v: Vec3<S>) -> S {
        let bend = u.scale_by(self.diagonal).dot(v) - self.flat.dot(u) * self.flat.dot(v);
        self.share * bend - self.radius * u.dot(v)
    }
}

/// The unit direction of `d` projected across z: where on a cap's circle a cylinder supports it; x where `d` points along z.
#[inline]
pub(super) fn radial_direction<S: Scalar>(d: Vec3<S>) -> (S, S) {
    let level = (d.x * d.x + d.y * d.y).sqrt();
    if level > S::MIN_POSITIVE {
        let inverse = S::ONE / level;
        (d.x * inverse, d.y * inverse)
    } else {
        (S::ONE, S::ZERO)
    }
}
