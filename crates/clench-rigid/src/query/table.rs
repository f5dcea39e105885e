//! The table of queries: the checks of each, the results that it needs, and its answer. [`Sim`](crate::Sim) and
//! [`Batch`](crate::Batch) answer from it.

use super::cast::{HIT, RAY, cast, sample};
use super::checks::{check_acceleration, check_body, check_object, check_places, check_rays};
use super::input::QueryInput;
use crate::validity::Computed;
use clench_dynamics::Step;
use clench_dynamics::dynamics::chains::BodyPoint;
use clench_dynamics::dynamics::frames::{Axes, Frames, along};
use clench_dynamics::dynamics::jacobian::{point_jacobian, point_jacobian_rate, subtree_jacobian};
use clench_dynamics::error::SimError;
use clench_dynamics::geometry::{Geoms, RayFilter};
use clench_dynamics::inverse::Acceleration;
use clench_dynamics::model::{FrameObject, Model, Params};
use clench_dynamics::workspace::Workspace;
use clench_math::{Real, Scalar, Vec3};

/// An object, or a point of a body.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    /// The position of an object. No input.
    Object(FrameObject),
    /// The point of a body. Input: its present position in the world, m.
    PointOf(usize),
}

/// A query, whose answer is numbers. The methods of [`Sim`](crate::Sim) and [`Batch`](crate::Batch) of the same names
/// say what they mean.
#[derive(Clone, Copy, Debug)]
pub enum Query<'a> {
    /// The Jacobian of a place (6 × nv). Input: that of the place.
    Jacobian(Place),
    /// Its time derivative.
    JacobianRate(Place),
    /// The Jacobian of the centre of mass of a body's subtree (3 × nv). No input.
    SubtreeJacobian(usize),
    /// The velocity of an object, linear, then angular (6). No input.
    Velocity(FrameObject, Axes),
    /// Its acceleration.
    Acceleration(FrameObject, Axes),
    /// M x (nv). Input: x.
    MulMass,
    /// M⁻¹ x (nv). Input: x.
    SolveMass,
    /// The hits of rays (k × 5): the geom, or −1; the distance, or infinity; the normal. Input: origins and directions
    /// (k × 6).
    Rays {
        /// The object in whose coordinates the rays are.
        frame: Option<FrameObject>,
        /// The geoms that can be hit.
        filter: &'a RayFilter,
    },
    /// Heights of a height field (k). Input: x and y (k × 2).
    Heights {
        /// The geom that is the height field.
        geom: usize,
        /// The object that the positions are relative to.
        frame: Option<FrameObject>,
    },
    /// Inverse dynamics: forces along dofs (nv). Input: accelerations.
    Inverse(Acceleration),
}

impl Query<'_> {
    /// Returns the geoms without which there is no answer.
    pub(crate) fn geoms(self) -> Vec<usize> {
        match self {
            Query::Jacobian(Place::Object(object))
            | Query::JacobianRate(Place::Object(object))
            | Query::Velocity(object, _)
            | Query::Acceleration(object, _) => geom_of(object).into_iter().collect(),
            Query::Rays { frame, .. } => frame.and_then(geom_of).into_iter().collect(),
            Query::Heights { geom, frame } => {
                let of_frame = frame.and_then(geom_of);
                [geom].into_iter().chain(of_frame).collect()
            }
            Query::Jacobian(Place::PointOf(_))
            | Query::JacobianRate(Place::PointOf(_))
            | Query::SubtreeJacobian(_)
            | Query::MulMass
            | Query::SolveMass
            | Query::Inverse(_) => Vec::new(),
        }
    }

    /// Checks the objects and the input of `count` environments. Returns the number of values of an answer.
    pub(crate) fn check<S: Scalar>(
        self,
        model: &Model,
        input: &QueryInput<S>,
        count: usize,
    ) -> Result<usize, SimError> {
        let nv = model.nv;
        match self {
            Query::Jacobian(place) | Query::JacobianRate(place) => {
                match place {
                    Place::Object(object) => check_object(model, object)?,
                    Place::PointOf(body) => {
                        check_body(model, body)?;
                        input.check("point", 3, count)?;
                    }
                }
                Ok(6 * nv)
            }
            Query::SubtreeJacobian(body) => check_body(model, body).map(|()| 3 * nv),
            Query::Velocity(object, _) | Query::Acceleration(object, _) => {
                check_object(model, object).map(|()| 6)
            }
            Query::MulMass | Query::SolveMass => input.check("x", nv, count).map(|()| nv),
            Query::Rays { frame, .. } => {
                let width = input.checked_width("rays", count)?;
                check_rays(model, frame, input.all())?;
                Ok(width / RAY * HIT)
            }
            Query::Heights { geom, frame } => {
                let width = input.checked_width("places", count)?;
                check_places(model, geom, frame, input.all())?;
                Ok(width / 2)
            }
            Query::Inverse(kind) => {
                input.check("qacc", nv, count)?;
                check_acceleration(model, kind).map(|()| nv)
            }
        }
    }

    /// Returns the results of a state that the answer is computed from.
    pub(crate) fn requires(self) -> Computed {
        match self {
            Query::Jacobian(_)
            | Query::SubtreeJacobian(_)
            | Query::MulMass
            | Query::SolveMass
            | Query::Rays { .. }
            | Query::Heights { .. } => Computed::Positions,
            Query::JacobianRate(_) | Query::Velocity(..) | Query::Acceleration(..) => {
                Computed::Everything
            }
            Query::Inverse(_) => Computed::Nothing,
        }
    }

    /// Appends the answer from the computed results, except that of inverse dynamics, which have a pass of their own.
    pub(crate) fn write<T: Real>(
        self,
        (model, params, ws): (&Model, &Params<T>, &Workspace<T>),
        input: &[T],
        out: &mut Vec<T>,
    ) {
        let pos = &ws.position;
        let geoms = Geoms {
            model,
            params,
            position: pos,
        };
        match self {
            Query::Jacobian(place) => {
                out.resize(6 * model.nv, T::ZERO);
                let point = body_point(geoms, place, input);
                point_jacobian(model, pos, &point, out);
            }
            Query::JacobianRate(place) => {
                out.resize(6 * model.nv, T::ZERO);
                let point = body_point(geoms, place, input);
                point_jacobian_rate(model, (pos, &ws.velocity), &point, out);
            }
            Query::SubtreeJacobian(body) => {
                out.resize(3 * model.nv, T::ZERO);
                subtree_jacobian(model, params, pos, body, out);
            }
            Query::Velocity(object, axes) => {
                let frames = Frames::of(geoms);
                let velocity = frames.velocity(object, &ws.velocity);
                write_vectors(along(frames, axes, object, velocity), out);
            }
            Query::Acceleration(object, axes) => {
                let (frames, cacc) = (Frames::of(geoms), &ws.sensors.bodies.cacc);
                let acceleration = frames.acceleration(object, &ws.velocity, cacc);
                write_vectors(along(frames, axes, object, acceleration), out);
            }
            Query::MulMass => {
                out.resize(model.nv, T::ZERO);
                (Step::compiled().mul)(ws.mass(), &model.tree, input, out);
            }
            Query::SolveMass => {
                out.extend_from_slice(input);
                (Step::compiled().solve)(ws.mass_factor(), &model.tree, out);
            }
            Query::Rays { frame, filter } => cast(geoms, frame, input, filter, out),
            Query::Heights { geom, frame } => sample(geoms, geom, frame, input, out),
            Query::Inverse(_) => {}
        }
    }
}

/// Returns the geom that an object is, if it is one.
pub(crate) fn geom_of(object: FrameObject) -> Option<usize> {
    match object {
        FrameObject::Geom(geom) => Some(geom),
        FrameObject::Inertial(_)
        | FrameObject::Body(_)
        | FrameObject::Site(_)
        | FrameObject::Camera(_) => None,
    }
}

/// Returns the point at a place; `input` is its input.
fn body_point<T: Real>(geoms: Geoms<'_, T>, place: Place, input: &[T]) -> BodyPoint<T> {
    match place {
        Place::Object(object) => Frames::of(geoms).point(object),
        Place::PointOf(body) => {
            BodyPoint::new(geoms.model, geoms.position, body, Vec3::from_slice(input))
        }
    }
}

fn write_vectors<T: Real>(vectors: [Vec3<T>; 2], out: &mut Vec<T>) {
    for vector in vectors {
        out.extend_from_slice(&vector.to_array());
    }
}
