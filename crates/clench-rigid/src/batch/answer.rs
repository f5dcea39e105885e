//! Queries of the states of environments, answered in lanes.

use super::cells::Cells;
use super::env_rows::EnvRows;
use super::group::Group;
use super::shared::Shared;
use crate::ik::{Ik, Search};
use crate::query::{cast, sample};
use crate::sensor;
use crate::sensor::bodies::update as update_body_forces;
use clench_dynamics::Step;
use clench_dynamics::dynamics::chains::BodyPoint;
use clench_dynamics::dynamics::frames::{Axes, Frames, along};
use clench_dynamics::dynamics::jacobian::{point_jacobian, point_jacobian_rate, subtree_jacobian};
use clench_dynamics::geometry::{Geoms, RayFilter};
use clench_dynamics::inverse::Acceleration;
use clench_dynamics::model::{FrameObject, Model, Params};
use clench_dynamics::settings::StepSettings;
use clench_dynamics::state::State;
use clench_dynamics::workspace::Workspace;
use clench_math::{Mask, Real, Scalar, Vec3, write_lane};

/// Input values of a query.
#[derive(Clone, Copy, Debug)]
pub enum QueryInput<'a, S> {
    /// The same values for all environments.
    Shared(&'a [S]),
    /// Separate values for each environment, one after the other.
    Each(&'a [S]),
}

impl<S: Copy> QueryInput<'_, S> {
    /// Returns all values.
    pub(super) fn all(&self) -> &[S] {
        match self {
            QueryInput::Shared(values) | QueryInput::Each(values) => values,
        }
    }

    /// Returns the number of values per environment.
    pub(super) fn width(&self, count: usize) -> usize {
        match self {
            QueryInput::Shared(values) => values.len(),
            QueryInput::Each(values) => values.len() / count.max(1),
        }
    }

    fn row(&self, env: usize, width: usize) -> &[S] {
        match self {
            QueryInput::Shared(values) => values,
            QueryInput::Each(values) => &values[env * width..][..width],
        }
    }
}

/// An object, or a point of a body. Input: none, or the world position of the point.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    Object(FrameObject),
    PointOf(usize),
}

/// The kind of a query.
pub enum Query<'a, S> {
    /// A Jacobian, or its time derivative. Input: that of the place.
    Jacobian(Place),
    JacobianRate(Place),
    /// The Jacobian of the centre of mass of a subtree. No input.
    SubtreeJacobian(usize),
    /// The velocity or acceleration of an object. No input.
    Velocity(FrameObject, Axes),
    Acceleration(FrameObject, Axes),
    /// M x or M⁻¹ x. Input: x.
    MulMass,
    SolveMass,
    /// The hits of rays. Input: the rays.
    Rays {
        frame: Option<FrameObject>,
        filter: &'a RayFilter,
    },
    /// Heights of a height field. Input: positions.
    Heights {
        geom: usize,
        frame: Option<FrameObject>,
    },
    /// Inverse dynamics. Input: accelerations.
    Inverse(Acceleration),
    /// Inverse kinematics. Input: goals, and optional start positions instead of the present ones.
    Kinematics {
        ik: &'a Ik,
        start: Option<QueryInput<'a, S>>,
    },
}

impl<S> Query<'_, S> {
    /// Returns the geoms without which there is no answer.
    pub(super) fn geoms(&self) -> Vec<usize> {
        match *self {
            Query::Jacobian(Place::Object(object)) | Query::JacobianRate(Place::Object(object)) => {
                geom_of(object).into_iter().collect()
            }
            Query::Velocity(object, _) | Query::Acceleration(object, _) => {
                geom_of(object).into_iter().collect()
            }
            Query::Rays { frame, .. } => frame.and_then(geom_of).into_iter().collect(),
            Query::Heights { geom, frame } => {
                let of_frame = frame.and_then(geom_of);
                [geom].into_iter().chain(of_frame).collect()
            }
            Query::Kinematics { ik, .. } => {
                let tasks = ik.tasks().iter();
                tasks
                    .filter_map(|task| geom_of(task.target.object()?))
                    .collect()
            }
            Query::Jacobian(Place::PointOf(_))
            | Query::JacobianRate(Place::PointOf(_))
            | Query::SubtreeJacobian(_)
            | Query::MulMass
            | Query::SolveMass
            | Query::Inverse(_) => Vec::new(),
        }
    }
}

/// Returns the geom that an object is, if it is one.
fn geom_of(object: FrameObject) -> Option<usize> {
    match object {
        FrameObject::Geom(geom) => Some(geom),
        FrameObject::Inertial(_)
        | FrameObject::Body(_)
        | FrameObject::Site(_)
        | FrameObject::Camera(_) => None,
    }
}

/// A query of a group of environments.
pub struct QueryCall<'a, S: Scalar + Shared> {
    pub model: &'a Model,
    pub settings: &'a StepSettings,
    pub rows: EnvRows<'a, S>,
    pub query: Query<'a, S>,
    pub input: QueryInput<'a, S>,
    /// The number of input values per environment.
    pub width: usize,
    pub answers: Cells<'a, S>,
}

impl<S: Scalar + Shared> QueryCall<'_, S> {
    /// Appends the answer for environments whose states are in lanes, and returns the lanes in which it is valid.
    pub fn answer<T: Real<Scalar = S>>(
        &self,
        group: &Group<T>,
        (params, state, ws): (&Params<T>, &State<T>, &mut Workspace<T>),
        memory: &mut QueryMemory<T>,
        out: &mut Vec<T>,
    ) -> T::Mask {
        let QueryMemory { input, search } = memory;
        self.gather(group, &self.input, self.width, input);
        let everywhere = T::Mask::splat(true);
        if let Query::Kinematics { ik, start } = &self.query {
            let memory = search.take().filter(|memory| memory.fits(self.model, ik));
            let search = search.insert(memory.unwrap_or_else(|| Search::new(self.model, ik)));
            search.state.copy_from(state);
            if let Some(start) = start {
                self.gather(group, start, self.model.nq, &mut search.state.qpos);
            }
            search.goals.copy_from_slice(input);
            search.run(self.model, params, ik);
            search.write(out);
            return everywhere;
        }
        if let Query::Inverse(kind) = self.query {
            out.resize(self.model.nv, T::ZERO);
            let input = (&input[..], kind);
            (Step::compiled().inverse)(self.model, params, self.settings, state, input, ws, out);
            return clench_dynamics::check::good_results(state, ws);
        }
        match self.query {
            Query::Acceleration(..) => {
                ws.invalidate_poses();
                (Step::compiled().forward)(
                    self.model,
                    params,
                    self.settings,
                    state,
                    ws,
                    sensor::evaluate,
                );
                update_body_forces(self.model, params, state, ws);
            }
            Query::Jacobian(_)
            | Query::JacobianRate(_)
            | Query::SubtreeJacobian(_)
            | Query::Velocity(..)
            | Query::MulMass
            | Query::SolveMass
            | Query::Rays { .. }
            | Query::Heights { .. } => {
                (Step::compiled().position_stage)(self.model, params, state, ws);
            }
            // Answered above.
            Query::Kinematics { .. } | Query::Inverse(_) => {}
        }
        if let Query::Velocity(..) | Query::JacobianRate(_) = self.query {
            let parts = ws.sleep.computed();
            let (pos, vel) = (&ws.position, &mut ws.velocity);
            (Step::compiled().velocities)(self.model, parts, pos, &state.qvel, vel);
        }
        self.write_answer(params, ws, input, out);
        match self.query {
            Query::Acceleration(..) => {
                clench_dynamics::check::good_results(state, ws) & !ws.collision.overflow
            }
            Query::SolveMass => !ws.singular,
            Query::Jacobian(_)
            | Query::JacobianRate(_)
            | Query::SubtreeJacobian(_)
            | Query::Velocity(..)
            | Query::MulMass
            | Query::Rays { .. }
            | Query::Heights { .. }
            | Query::Kinematics { .. }
            | Query::Inverse(_) => everywhere,
        }
    }

    /// Appends the answer from the computed results.
    fn write_answer<T: Real<Scalar = S>>(
        &self,
        params: &Params<T>,
        ws: &Workspace<T>,
        input: &[T],
        out: &mut Vec<T>,
    ) {
        let (model, pos) = (self.model, &ws.position);
        let geoms = Geoms {
            model,
            params,
            position: pos,
        };
        match self.query {
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
            Query::Inverse(_) | Query::Kinematics { .. } => {}
        }
    }

    fn gather<T: Real<Scalar = S>>(
        &self,
        group: &Group<T>,
        input: &QueryInput<S>,
        width: usize,
        lanes: &mut Vec<T>,
    ) {
        lanes.resize(width, T::ZERO);
        for (lane, env) in group.fill() {
            write_lane(input.row(env, width), lane, lanes);
        }
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

pub(super) fn write_vectors<T: Real>(vectors: [Vec3<T>; 2], out: &mut Vec<T>) {
    out.extend(vectors.iter().flat_map(|vector| vector.to_array()));
}

/// Scratch memory of queries.
pub struct QueryMemory<T: Real> {
    input: Vec<T>,
    search: Option<Search<T>>,
}

impl<T: Real> QueryMemory<T> {
    pub fn new() -> Self {
        QueryMemory {
            input: Vec::new(),
            search: None,
        }
    }
}
