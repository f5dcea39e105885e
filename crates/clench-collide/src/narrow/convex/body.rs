//! The bodies of the search for the largest gap: shapes, or the ground below a triangle of terrain.

use super::polyhedron::Polyhedron;
use super::prism::Prism;
use crate::shape::{
    Capsule, Core, Cuboid, Curvature, Cylinder, EllipsoidCore, Feature, Mesh, Shape, Sphere,
};
use clench_math::{Scalar, Vec3};

/// A convex body in its own frame, as a core plus a ball.
#[derive(Clone)]
pub(super) struct Body<'a, S> {
    core: AnyCore<'a, S>,
    /// The radius of the ball that is added to the core, m.
    pub radius: S,
    /// The radius of a sphere about the origin that encloses the body, m.
    pub bounding_radius: S,
}

#[derive(Clone)]
enum AnyCore<'a, S> {
    Point(Sphere<S>),
    Segment(Capsule<S>),
    Ellipsoid(EllipsoidCore<S>),
    Cylinder(Cylinder<S>),
    Box(Cuboid<S>),
    Hull(Mesh<'a, S>),
    /// The ground below a triangle of a height field.
    Prism(&'a Prism<S>),
}

/// Evaluates an expression for each variant of [`AnyCore`], with the core bound to a name.
macro_rules! of_core {
    ($body:expr, $core:ident => $answer:expr) => {
        match &$body.core {
            AnyCore::Point($core) => $answer,
            AnyCore::Segment($core) => $answer,
            AnyCore::Ellipsoid($core) => $answer,
            AnyCore::Cylinder($core) => $answer,
            AnyCore::Box($core) => $answer,
            AnyCore::Hull($core) => $answer,
            AnyCore::Prism($core) => $answer,
        }
    };
}

impl<'a, S: Scalar> Body<'a, S> {
    /// Creates the body of a bounded convex shape; a point for any other.
    pub(super) fn new(shape: &Shape<'a, S>) -> Self {
        let core = match *shape {
            Shape::Plane(_) | Shape::HeightField(_) => AnyCore::Point(Sphere { radius: S::ZERO }),
            Shape::Sphere(sphere) => AnyCore::Point(sphere),
            Shape::Capsule(capsule) => AnyCore::Segment(capsule),
            Shape::Ellipsoid(ellipsoid) => AnyCore::Ellipsoid(ellipsoid.core()),
            Shape::Cylinder(cylinder) => AnyCore::Cylinder(cylinder),
            Shape::Box(cuboid) => AnyCore::Box(cuboid),
            Shape::Mesh(mesh) => AnyCore::Hull(mesh),
        };
        Body::of_core(core, shape.bounding_radius())
    }

    /// Creates the body below a triangle.
    pub(super) fn of_prism(prism: &'a Prism<S>) -> Self {
        Body::of_core(AnyCore::Prism(prism), prism.bounding_radius())
    }

    fn of_core(core: AnyCore<'a, S>, bounding_radius: S) -> Self {
        let mut body = Body {
            core,
            radius: S::ZERO,
            bounding_radius,
        };
        body.radius = of_core!(body, core => core.radius());
        body
    }

    /// Returns the core if it is a polyhedron of which corners, edges and faces have numbers.
    pub(super) fn polyhedron(&self) -> Option<Polyhedron<'a, S>> {
        match self.core {
            AnyCore::Segment(capsule) => Some(Polyhedron::Segment(capsule.half_length)),
            AnyCore::Box(cuboid) => Some(Polyhedron::Box(cuboid.half_lengths)),
            AnyCore::Hull(mesh) => mesh.hull.map(Polyhedron::Hull),
            AnyCore::Point(_)
            | AnyCore::Ellipsoid(_)
            | AnyCore::Cylinder(_)
            | AnyCore::Prism(_) => None,
        }
    }

    /// Returns the cylinder if the body is one.
    pub(super) fn as_cylinder(&self) -> Option<&Cylinder<S>> {
        match &self.core {
            AnyCore::Cylinder(cylinder) => Some(cylinder),
            _ => None,
        }
    }

    /// See [`Core::is_point`].
    pub(super) fn is_point(&self) -> bool {
        of_core!(self, core => core.is_point())
    }
    /// See [`Core::is_curved`].
    pub(super) fn is_curved(&self) -> bool {
        of_core!(self, core => core.is_curved())
    }
    /// See [`Core::nearest`].
    pub(super) fn nearest(&self, point: impl FnOnce() -> Vec3<S>) -> Option<Vec3<S>> {
        of_core!(self, core => core.nearest(point))
    }
    /// See [`Core::support`].
    #[inline]
    pub(super) fn support(&self, d: Vec3<S>, side: Vec3<S>) -> Vec3<S> {
        of_core!(self, core => core.support(d, side))
    }
    /// See [`Core::corner_along`].
    #[inline]
    pub(super) fn corner_along(&self, d: Vec3<S>, side: Vec3<S>) -> (Vec3<S>, u32) {
        of_core!(self, core => core.corner_along(d, side))
    }
    /// See [`Core::feature`].
    pub(super) fn feature(&self, d: Vec3<S>) -> Feature<S> {
        of_core!(self, core => core.feature(d))
    }
    /// See [`Core::curvature`].
    #[inline]
    pub(super) fn curvature(&self, d: Vec3<S>) -> Curvature<S> {
        of_core!(self, core => core.curvature(d))
    }
    /// See [`Core::corner`].
    #[inline]
    pub(super) fn corner(&self, point: Vec3<S>) -> Vec3<S> {
        of_core!(self, core => core.corner(point))
    }
    /// See [`Core::cap`].
    pub(super) fn cap(&self) -> Option<S> {
        of_core!(self, core => core.cap())
    }
    /// See [`Core::edge_axes`].
    pub(super) fn edge_axes(&self) -> &'static [usize] {
        of_core!(self, core => core.edge_axes())
    }
    /// See [`Core::face_axes`].
    pub(super) fn face_axes(&self) -> &'static [usize] {
        of_core!(self, core => core.face_axes())
    }
}
