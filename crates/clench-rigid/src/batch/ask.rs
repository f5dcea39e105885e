//! Questions to all environments of a batch at once, answered from the states in their rows, in lanes and over threads.
//!
//! Nothing is kept of an earlier step here, so that an answer always holds for the present state, also right after a step. An
//! environment of which the state cannot be computed with gets NaN; one that does not run is asked like all others.

use super::cells::Cells;
use super::group::Group;
use super::precision::Lanewise;
use super::run::spread;
use super::stepper::EnvRows;
use super::{Batch, Precision, Rows};
use crate::check::{check_length, check_values};
use crate::dynamics::frames::Frames;
use crate::dynamics::jacobian::{point_jacobian, subtree_jacobian};
use crate::dynamics::velocity::velocities;
use crate::error::SimError;
use crate::geometry::Geoms;
use crate::ik::{Ik, IkSolution, Search};
use crate::inverse::{Acceleration, inverse};
use crate::model::{FrameObject, Model, Params};
use crate::pipeline::{forward, position_stage};
use crate::query::{
    Axes, HIT, RAY, RayFilter, along, cast, check_acceleration, check_body, check_object,
    check_places, check_rays, sample,
};
use crate::sensor::bodies::update as update_body_forces;
use crate::settings::StepSettings;
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::{Mask, Real, Vec3, write_lane};

/// Numbers of a question.
#[derive(Clone, Copy, Debug)]
pub enum Given<'a, S> {
    /// The same for all environments.
    Shared(&'a [S]),
    /// Its own for each environment, one after the other.
    Each(&'a [S]),
}

impl<S: Copy> Given<'_, S> {
    /// All numbers.
    fn all(&self) -> &[S] {
        match self {
            Given::Shared(values) | Given::Each(values) => values,
        }
    }

    /// How many numbers an environment has.
    fn width(&self, count: usize) -> usize {
        match self {
            Given::Shared(values) => values.len(),
            Given::Each(values) => values.len() / count.max(1),
        }
    }

    fn row(&self, env: usize, width: usize) -> &[S] {
        match self {
            Given::Shared(values) => values,
            Given::Each(values) => &values[env * width..][..width],
        }
    }
}

/// What is asked.
pub enum Question<'a, S> {
    /// The Jacobian of an object: given nothing.
    Jacobian(FrameObject),
    /// That of the centre of mass of a subtree, likewise.
    SubtreeJacobian(usize),
    /// The velocity of an object, or its acceleration: given nothing.
    Velocity(FrameObject, Axes),
    Acceleration(FrameObject, Axes),
    /// M x or M⁻¹ x: given x.
    MulMass,
    SolveMass,
    /// What rays hit: given the rays.
    Rays {
        frame: Option<FrameObject>,
        filter: &'a RayFilter,
    },
    /// Heights of a height field: given places.
    Heights {
        geom: usize,
        frame: Option<FrameObject>,
    },
    /// Inverse dynamics: given accelerations.
    Inverse(Acceleration),
    /// Inverse kinematics: given goals, and where to begin, if not in the present state.
    Kinematics {
        ik: &'a Ik,
        start: Option<Given<'a, S>>,
    },
}

/// A question to a group of environments.
pub struct Asking<'a, S: Lanewise> {
    pub model: &'a Model,
    pub settings: &'a StepSettings,
    pub rows: EnvRows<'a, S>,
    pub question: Question<'a, S>,
    pub given: Given<'a, S>,
    /// Numbers that an environment is given.
    pub width: usize,
    pub answers: Cells<'a, S>,
}

impl<S: Lanewise> Asking<'_, S> {
    /// Appends the answer for environments whose states are in lanes; the lanes in which it is one. `given` is room for the numbers
    /// of the question, `search` for inverse kinematics.
    pub fn answer<T: Real<Scalar = S>>(
        &self,
        group: &Group<T>,
        (params, state, ws): (&Params<T>, &State<T>, &mut Workspace<T>),
        memory: &mut AskMemory<T>,
        out: &mut Vec<T>,
    ) -> T::Mask {
        let AskMemory { given, search } = memory;
        self.gather(group, &self.given, self.width, given);
        let everywhere = T::Mask::splat(true);
        if let Question::Kinematics { ik, start } = &self.question {
            let memory = search.take().filter(|memory| memory.fits(self.model, ik));
            let search = search.insert(memory.unwrap_or_else(|| Search::new(self.model, ik)));
            search.state.copy_from(state);
            if let Some(start) = start {
                self.gather(group, start, self.model.nq, &mut search.state.qpos);
            }
            search.goals.copy_from_slice(given);
            search.run(self.model, params, ik);
            search.write(out);
            return everywhere;
        }
        if let Question::Inverse(kind) = self.question {
            out.resize(self.model.nv, T::ZERO);
            let given = (&given[..], kind);
            inverse(self.model, params, self.settings, state, given, ws, out);
            return crate::check::good_results(state, ws);
        }
        match self.question {
            Question::Acceleration(..) => {
                ws.sleep.forget();
                forward(self.model, params, self.settings, state, ws);
                update_body_forces(self.model, params, state, ws);
            }
            _ => position_stage(self.model, params, state, ws),
        }
        if let Question::Velocity(..) = self.question {
            velocities(self.model, &ws.position, &state.qvel, &mut ws.velocity);
        }
        self.look(params, ws, given, out);
        match self.question {
            Question::Acceleration(..) => {
                crate::check::good_results(state, ws) & !ws.collision.overflow
            }
            Question::SolveMass => !ws.singular,
            _ => everywhere,
        }
    }

    /// What follows from positions alone.
    fn look<T: Real<Scalar = S>>(
        &self,
        params: &Params<T>,
        ws: &Workspace<T>,
        given: &[T],
        out: &mut Vec<T>,
    ) {
        let (model, pos) = (self.model, &ws.position);
        let geoms = Geoms {
            model,
            params,
            position: pos,
        };
        match self.question {
            Question::Jacobian(object) => {
                out.resize(6 * model.nv, T::ZERO);
                let point = Frames::of(geoms).point(object);
                point_jacobian(model, pos, &point, out);
            }
            Question::SubtreeJacobian(body) => {
                out.resize(3 * model.nv, T::ZERO);
                subtree_jacobian(model, params, pos, body, out);
            }
            Question::Velocity(object, axes) => {
                let frames = Frames::of(geoms);
                let velocity = frames.velocity(object, &ws.velocity);
                write_vectors(along(frames, axes, object, velocity), out);
            }
            Question::Acceleration(object, axes) => {
                let (frames, cacc) = (Frames::of(geoms), &ws.sensors.bodies.cacc);
                let acceleration = frames.acceleration(object, &ws.velocity, cacc);
                write_vectors(along(frames, axes, object, acceleration), out);
            }
            Question::MulMass => {
                out.resize(model.nv, T::ZERO);
                ws.problem.mass.mul(&model.tree, given, out);
            }
            Question::SolveMass => {
                out.extend_from_slice(given);
                ws.problem.mass_factor.solve(&model.tree, out);
            }
            Question::Rays { frame, filter } => cast(geoms, frame, given, filter, out),
            Question::Heights { geom, frame } => sample(geoms, geom, frame, given, out),
            Question::Inverse(_) | Question::Kinematics { .. } => {}
        }
    }

    fn gather<T: Real<Scalar = S>>(
        &self,
        group: &Group<T>,
        given: &Given<S>,
        width: usize,
        lanes: &mut Vec<T>,
    ) {
        lanes.resize(width, T::ZERO);
        for (lane, env) in group.fill() {
            write_lane(given.row(env, width), lane, lanes);
        }
    }
}

fn write_vectors<T: Real>(vectors: [Vec3<T>; 2], out: &mut Vec<T>) {
    out.extend(vectors.iter().flat_map(|vector| vector.to_array()));
}

/// Room that answers take.
pub struct AskMemory<T: Real> {
    given: Vec<T>,
    search: Option<Search<T>>,
}

impl<T: Real> AskMemory<T> {
    pub fn new() -> Self {
        AskMemory {
            given: Vec::new(),
            search: None,
        }
    }
}

impl<S: Precision> Batch<S> {
    /// The Jacobian of an object in each environment (n, 6 × nv), see [`Sim::jacobian`](crate::Sim::jacobian), in the present
    /// states.
    ///
    /// # Errors
    /// An object that the model does not have; else as [`step`](Self::step).
    pub fn jacobian(&mut self, object: FrameObject) -> Result<Rows<S>, SimError> {
        check_object(&self.model, object)?;
        let width = 6 * self.model.nv;
        self.ask(Question::Jacobian(object), Given::Shared(&[]), width)
    }

    /// The Jacobian of the centre of mass of a body and all below it (n, 3 × nv), likewise, see
    /// [`Sim::subtree_jacobian`](crate::Sim::subtree_jacobian).
    ///
    /// # Errors
    /// As [`jacobian`](Self::jacobian).
    pub fn subtree_jacobian(&mut self, body: usize) -> Result<Rows<S>, SimError> {
        check_body(&self.model, body)?;
        let width = 3 * self.model.nv;
        self.ask(Question::SubtreeJacobian(body), Given::Shared(&[]), width)
    }

    /// What rays hit in each environment, likewise, see [`Sim::rays`](crate::Sim::rays). Of each ray five numbers (n, k × 5): the
    /// geom, −1 where there is none, the distance, then infinite, and the normal.
    ///
    /// # Errors
    /// A wrong number of numbers; else as [`Sim::rays`](crate::Sim::rays) and [`step`](Self::step).
    pub fn rays(
        &mut self,
        rays: Given<S>,
        frame: Option<FrameObject>,
        filter: &RayFilter,
    ) -> Result<Rows<S>, SimError> {
        let width = self.check_given("rays", &rays)?;
        check_rays(&self.model, frame, rays.all())?;
        let question = Question::Rays { frame, filter };
        self.ask(question, rays, width / RAY * HIT)
    }

    /// Heights of a height field in each environment (n, k), likewise, see [`Sim::heights`](crate::Sim::heights).
    ///
    /// # Errors
    /// A wrong number of numbers; else as [`Sim::heights`](crate::Sim::heights) and [`step`](Self::step).
    pub fn heights(
        &mut self,
        geom: usize,
        places: Given<S>,
        frame: Option<FrameObject>,
    ) -> Result<Rows<S>, SimError> {
        let width = self.check_given("places", &places)?;
        check_places(&self.model, geom, frame, places.all())?;
        self.ask(Question::Heights { geom, frame }, places, width / 2)
    }

    /// The forces along dofs (n, nv) that cause the accelerations `qacc` in the present states, see
    /// [`Sim::inverse`](crate::Sim::inverse); NaN in an environment in which that would be an error.
    ///
    /// # Errors
    /// A wrong number of accelerations, or such that are not finite, and as [`Sim::inverse`](crate::Sim::inverse) what no
    /// environment can answer; else as [`step`](Self::step).
    pub fn inverse(&mut self, qacc: Given<S>, given: Acceleration) -> Result<Rows<S>, SimError> {
        let nv = self.model.nv;
        self.check_numbers("qacc", &qacc, nv)?;
        check_acceleration(&self.model, given)?;
        self.ask(Question::Inverse(given), qacc, nv)
    }

    /// Positions of the joints that bring the tasks of `ik` to their goals in each environment, from the present states or from
    /// `start` (nq numbers an environment), see [`Sim::ik`](crate::Sim::ik).
    ///
    /// # Errors
    /// Goals or starts of a wrong number, or with numbers that are not finite; else as [`step`](Self::step).
    pub fn ik(
        &mut self,
        ik: &Ik,
        goals: Given<S>,
        start: Option<Given<S>>,
    ) -> Result<Vec<IkSolution<S>>, SimError> {
        self.check_numbers("goals", &goals, ik.goal_len(&self.model))?;
        if let Some(start) = &start {
            self.check_numbers("start", start, self.model.nq)?;
        }
        let width = IkSolution::<S>::width(&self.model, ik);
        let rows = self.ask(Question::Kinematics { ik, start }, goals, width)?;
        let nq = self.model.nq;
        Ok(rows.iter().map(|row| IkSolution::read(row, nq)).collect())
    }

    /// Finite numbers, `width` an environment.
    pub(super) fn check_numbers(
        &self,
        name: &'static str,
        given: &Given<S>,
        width: usize,
    ) -> Result<(), SimError> {
        let total = match given {
            Given::Shared(_) => width,
            Given::Each(_) => width.saturating_mul(self.count()),
        };
        check_values(name, given.all(), total)
    }

    /// As many numbers in each environment; how many.
    fn check_given(&self, name: &'static str, given: &Given<S>) -> Result<usize, SimError> {
        let width = given.width(self.count());
        if let Given::Each(values) = given {
            check_length(name, values.len(), width * self.count())?;
        }
        Ok(width)
    }

    pub(super) fn ask(
        &mut self,
        question: Question<S>,
        given: Given<S>,
        width: usize,
    ) -> Result<Rows<S>, SimError> {
        self.check_state()?;
        self.check_threads()?;
        let count = self.count();
        let mut answers = Rows::new(count, width, S::new(f64::NAN))?;
        self.order.clear();
        self.order.extend(0..count as u32);
        let (motion, inputs) = self.state.share();
        let asking = Asking {
            model: &self.model,
            settings: &self.settings,
            rows: EnvRows {
                motion,
                inputs,
                params: &self.params,
            },
            question,
            width: given.width(count),
            given,
            answers: Cells::new(&mut answers),
        };
        let (steppers, order) = (&mut self.steppers, &self.order);
        let mut all = || {
            spread(steppers, order, |stepper, group| {
                stepper.ask(group, &asking)
            })
        };
        match &self.pool {
            None => all(),
            Some(pool) => pool.install(all),
        }
        Ok(answers)
    }
}
