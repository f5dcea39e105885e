//! The iterations of all lanes together; a finished lane does not change.
//!
//! With E the cost, A and g as in `equations`, an iteration tries δ from
//!
//! ```text
//! (A + μ I) δ = g       μ = λ (2 E + ε)
//! ```
//!
//! Damping in proportion to the cost (Sugihara 2011) keeps steps short far from a goal. It fades near the goal, where
//! the iterations converge like Newton's. λ is raised if a step does not lower the cost, and lowered if the cost falls
//! as the linear model predicts. A step in which a dof moves too far is scaled as a whole, to s δ, for which the linear
//! model predicts a decrease of ½ s δ·((2 − s) g + s μ δ). Dofs at a limit against which g presses are held; a step
//! that crosses a limit is projected onto it.

use super::equations::{Equations, Scratch};
use super::halton::sample_posture;
use super::{Ik, IkSolution, IkStatus, IkTarget};
use clench_dynamics::Step;
use clench_dynamics::dynamics::frames::Frames;
use clench_dynamics::dynamics::kinematics::Computed;
use clench_dynamics::model::{JointKind, Model, Params};
use clench_dynamics::part::Part;
use clench_dynamics::stages::Positions;
use clench_dynamics::state::State;
use clench_math::{Mask, Quat, Real, Scalar, kernel};

/// ε: the minimum damping. At singular postures A alone cannot be factored.
const MIN_DAMPING: f64 = 1e-9;
/// The factor by which a failed step raises λ; a good one lowers it by `LOWER`.
const RAISE: f64 = 8.0;
const LOWER: f64 = 4.0;
/// The minimum of λ, from which few failures suffice to raise it again.
const MIN_LAMBDA: f64 = 1e-6;
/// The minimum ratio of actual to predicted decrease of a good step.
const GOOD_RATIO: f64 = 0.5;
/// The predicted decrease, relative to the cost, up to which a point counts as stationary.
const NEGLIGIBLE: f64 = 1e-10;
/// The maximum number of consecutive failed steps; more are due to rounding.
const FAILURES: f64 = 12.0;

/// The memory of a search.
#[derive(Debug)]
pub struct Search<T: Real> {
    compiled: Step<T>,
    /// The trial positions, in the end the result; mocap poses are input.
    pub state: State<T>,
    /// Goals, task by task.
    pub goals: Vec<T>,
    /// The number of iterations of each lane.
    iterations: T,
    /// The index of the [`IkStatus`].
    status: T,
    position: Positions<T>,
    all: [Part; 1],
    here: Equations<T>,
    there: Equations<T>,
    scratch: Scratch<T>,
    factor: Vec<T>,
    step: Vec<T>,
    at_limit: Vec<T::Mask>,
    /// The step over all dofs (nv).
    velocity: Vec<T>,
    /// The current iterate, while `state` holds the trial positions (nq).
    qpos: Vec<T>,
}

/// The best result of several searches.
struct Best<T: Real> {
    qpos: Vec<T>,
    here: Equations<T>,
    status: T,
}

impl<T: Real> Search<T> {
    pub fn new(model: &Model, ik: &Ik) -> Self {
        let n = ik.dofs.len();
        let here = Equations::new(ik);
        Search {
            compiled: Step::compiled(),
            state: State::new(model),
            goals: vec![T::ZERO; ik.goal_len(model)],
            iterations: T::ZERO,
            status: T::ZERO,
            position: Positions::new(model),
            all: [Part::whole(model)],
            there: here.clone(),
            scratch: Scratch::new(model),
            factor: here.matrix.clone(),
            step: vec![T::ZERO; n],
            at_limit: vec![T::Mask::splat(false); n],
            velocity: vec![T::ZERO; model.nv],
            qpos: vec![T::ZERO; model.nq],
            here,
        }
    }

    /// Returns true if the buffers fit these tasks. Nothing else remains of earlier searches.
    pub fn fits(&self, model: &Model, ik: &Ik) -> bool {
        self.goals.len() == ik.goal_len(model)
            && self.step.len() == ik.dofs.len()
            && self.here.errors.len() == ik.tasks.len()
    }

    /// Searches from the positions of `state` and leaves the result there.
    #[kernel]
    pub fn run(&mut self, model: &Model, params: &Params<T>, ik: &Ik) {
        if ik.options.limits {
            project(model, params, &ik.movable, &mut self.state.qpos);
        }
        self.iterations = T::ZERO;
        self.descend(model, params, ik, T::Mask::splat(true));
        if ik.options.restarts == 0 {
            return;
        }
        let mut best = Best {
            qpos: self.qpos.clone(),
            here: self.here.clone(),
            status: self.status,
        };
        for index in 1..=ik.options.restarts {
            let reached = best.status.eq(IkStatus::Reached.code());
            let again = !(reached | best.status.eq(IkStatus::NonFinite.code()));
            if !again.any() {
                break;
            }
            self.state.qpos.copy_from_slice(&best.qpos);
            sample_posture(model, params, ik, index, &mut self.state.qpos);
            self.descend(model, params, ik, again);
            let better = again & self.here.cost.lt(best.here.cost);
            best.here.blend(better, &self.here);
            best.status = T::select(better, self.status, best.status);
            for (best, &found) in best.qpos.iter_mut().zip(&self.qpos) {
                *best = T::select(better, found, *best);
            }
        }
        self.state.qpos.copy_from_slice(&best.qpos);
        self.here = best.here;
        self.status = best.status;
    }

    /// Searches from the positions of `state` in the lanes of `live`, and leaves the result there.
    #[inline(always)]
    fn descend(&mut self, model: &Model, params: &Params<T>, ik: &Ik, mut live: T::Mask) {
        let tolerance = T::new(ik.options.tolerance);
        let negligible = T::new(NEGLIGIBLE).max(T::splat(T::Scalar::EPSILON));
        self.evaluate(model, params, ik);
        std::mem::swap(&mut self.here, &mut self.there);
        self.qpos.copy_from_slice(&self.state.qpos);
        self.at_limit.fill(T::Mask::splat(false));
        self.status = IkStatus::IterationLimit.code();
        let mut lambda = T::new(ik.options.damping);
        let mut failures = T::ZERO;
        let finite = self.here.cost.is_finite();
        self.end(&mut live, !finite, IkStatus::NonFinite);
        let reached = self.is_reached(ik, tolerance);
        self.end(&mut live, reached, IkStatus::Reached);
        for _ in 0..ik.options.iterations {
            if !live.any() {
                break;
            }
            self.iterations = T::select(live, self.iterations + T::ONE, self.iterations);
            let damping = lambda * (self.here.cost + self.here.cost + T::new(MIN_DAMPING));
            let promised = self.try_step(model, params, ik, damping);
            let gained = self.here.cost - self.there.cost;
            let better = live & self.there.cost.lt(self.here.cost);
            let good = gained.gt(promised * T::new(GOOD_RATIO));
            self.here.blend(better, &self.there);
            for (own, &tried) in self.qpos.iter_mut().zip(&self.state.qpos) {
                *own = T::select(better, tried, *own);
            }
            let lowered = (lambda / T::new(LOWER)).max(T::new(MIN_LAMBDA));
            let raised = lambda * T::new(RAISE);
            lambda = T::select(better, T::select(good, lowered, lambda), raised);
            failures = T::select(better, T::ZERO, failures + T::ONE);
            let reached = self.is_reached(ik, tolerance);
            self.end(&mut live, reached, IkStatus::Reached);
            let idle = promised.le(self.here.cost * negligible) | failures.gt(T::new(FAILURES));
            self.end(&mut live, idle, IkStatus::Stationary);
        }
        self.state.qpos.copy_from_slice(&self.qpos);
    }

    /// Finishes the live lanes of `mask`.
    #[inline(always)]
    fn end(&mut self, live: &mut T::Mask, mask: T::Mask, status: IkStatus) {
        self.status = T::select(*live & mask, status.code(), self.status);
        *live &= !mask;
    }

    /// Takes a step from the current iterate and evaluates the trial positions. Returns the decrease of the cost that
    /// the linear model predicts.
    #[inline(always)]
    fn try_step(&mut self, model: &Model, params: &Params<T>, ik: &Ik, damping: T) -> T {
        if ik.options.limits {
            mark_at_limit(
                model,
                params,
                ik,
                &self.qpos,
                &self.here.right,
                &mut self.at_limit,
            );
        }
        let positive = (self.here).solve(damping, &self.at_limit, &mut self.factor, &mut self.step);
        let longest = (self.step.iter()).fold(T::ZERO, |longest, step| longest.max(step.abs()));
        let max_step = T::new(ik.options.max_step);
        let share = T::select(longest.gt(max_step), max_step / longest, T::ONE);
        self.velocity.fill(T::ZERO);
        let mut promised = T::ZERO;
        for ((&dof, &step), &right) in ik.dofs.iter().zip(&self.step).zip(&self.here.right) {
            let step = T::select(positive, step * share, T::ZERO);
            self.velocity[dof as usize] = step;
            let slope = (T::new(2.0) - share) * right + damping * step;
            promised += T::new(0.5) * step * slope;
        }
        self.state.qpos.copy_from_slice(&self.qpos);
        let qpos = &mut self.state.qpos;
        (self.compiled.integrate_positions)(model, qpos, &self.velocity, T::ONE);
        if ik.options.limits {
            project(model, params, &ik.dofs, &mut self.state.qpos);
        }
        self.evaluate(model, params, ik);
        T::select(positive, promised, T::splat(T::Scalar::INFINITY))
    }

    /// Builds `there` at the positions of the state.
    #[inline(always)]
    fn evaluate(&mut self, model: &Model, params: &Params<T>, ik: &Ik) {
        let pos = &mut self.position;
        let all = Computed::all(&self.all);
        (self.compiled.body_poses)(model, params, &self.state, all, pos);
        let frames = Frames { model, params, pos };
        let goals = (ik, &self.goals[..]);
        (self.there).build(frames, &self.state.qpos, goals, &mut self.scratch);
    }

    /// Returns the lanes in which every task is reached, ignoring postures unless there are no other tasks.
    #[inline(always)]
    fn is_reached(&self, ik: &Ik, tolerance: T) -> T::Mask {
        let is_posture = |target: IkTarget| target == IkTarget::Posture;
        let only_postures = ik.tasks.iter().all(|task| is_posture(task.target));
        let mut reached = T::Mask::splat(true);
        for (task, &squared) in ik.tasks.iter().zip(&self.here.errors) {
            if only_postures || !is_posture(task.target) {
                reached &= squared.le(tolerance * tolerance);
            }
        }
        reached
    }

    /// Appends the result in the form that [`IkSolution::read`] reads.
    pub fn write(&self, out: &mut Vec<T>) {
        out.extend_from_slice(&self.state.qpos);
        out.extend([self.iterations, self.status]);
        out.extend(self.here.errors.iter().map(|squared| squared.sqrt()));
    }
}

impl<S: Scalar> IkSolution<S> {
    /// Returns the width of a written solution.
    pub(crate) fn width(model: &Model, ik: &Ik) -> usize {
        model.nq + 2 + ik.tasks.len()
    }

    /// Reads the values that a search wrote, of which the first `nq` are positions.
    pub(crate) fn read(row: &[S], nq: usize) -> Self {
        let (qpos, rest) = row.split_at(nq);
        let status = rest[1].to_f64();
        // An environment whose state is not finite was not searched.
        let listed = IkStatus::ALL.get(status as usize);
        let status = listed.filter(|_| status.is_finite());
        IkSolution {
            qpos: qpos.to_vec(),
            iterations: rest[0].to_f64() as usize,
            status: status.copied().unwrap_or(IkStatus::NonFinite),
            errors: rest[2..].to_vec(),
        }
    }
}

impl IkStatus {
    #[inline(always)]
    fn code<T: Real>(self) -> T {
        T::new(f64::from(self as u8))
    }
}

/// Projects the positions of the joints of some dofs, in ascending order, onto their ranges. A ball joint is rotated
/// back about its rotation axis.
#[inline(always)]
fn project<T: Real>(model: &Model, params: &Params<T>, dofs: &[u32], qpos: &mut [T]) {
    let mut last = usize::MAX;
    for &dof in dofs {
        let j = model.dofs[dof as usize].joint;
        let joint = &model.joints[j];
        if !joint.limited || joint.kind == JointKind::Free || last == j {
            continue;
        }
        last = j;
        let [low, high] = params.jnt_range[j];
        let q = &mut qpos[joint.qpos..];
        if joint.kind == JointKind::Ball {
            let rotation = Quat::from_slice(q).to_rotation_vector();
            let (axis, angle) = rotation.normalize();
            let back = Quat::from_axis_angle(axis, high);
            Quat::select(angle.gt(high), back, Quat::from_slice(q)).write(q);
        } else {
            q[0] = q[0].max(low).min(high);
        }
    }
}

/// Marks the dofs at a limit against which `right` presses.
#[inline(always)]
fn mark_at_limit<T: Real>(
    model: &Model,
    params: &Params<T>,
    ik: &Ik,
    qpos: &[T],
    right: &[T],
    at_limit: &mut [T::Mask],
) {
    for ((&dof, &right), at_limit) in ik.dofs.iter().zip(right).zip(at_limit) {
        let j = model.dofs[dof as usize].joint;
        let joint = &model.joints[j];
        if !joint.limited || !matches!(joint.kind, JointKind::Slide | JointKind::Hinge) {
            continue;
        }
        let (q, [low, high]) = (qpos[joint.qpos], params.jnt_range[j]);
        *at_limit = (q.le(low) & right.lt(T::ZERO)) | (q.ge(high) & right.gt(T::ZERO));
    }
}
