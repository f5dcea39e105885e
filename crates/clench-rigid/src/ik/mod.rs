//! Inverse kinematics: positions of joints that bring objects to their goals, by damped least squares.
//!
//! Given tasks with errors e_k (goal minus present value) and weights W_k, it solves
//!
//! ```text
//! minimise over q:   ½ Σ_k |W_k e_k(q)|²     within the limits of joints
//! ```
//!
//! by the Levenberg–Marquardt method with projection onto the limits (Kanzow, Yamashita & Fukushima 2004), see
//! `search`. Like every descent method it finds a local minimum, which depends on the start; `restarts` tries further
//! starts (`halton`).
//!
//! This file defines the tasks, `equations` the linear equations of an iteration, `search` the iterations, `halton` the
//! further starts. Poses and Jacobians come from `dynamics`. Loops of equality constraints, tendon limits and
//! collisions are ignored.

mod equations;
mod halton;
mod search;

pub(crate) use search::Search;

use crate::query::{check_body, check_object};
use clench_dynamics::check::check_length;
use clench_dynamics::error::SimError;
use clench_dynamics::model::{FrameObject, Model};

/// The quantity that a task brings to a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IkTarget {
    /// The position of an object. Goal: a world position (3), m.
    Position(FrameObject),
    /// The orientation of an object. Goal: a quaternion (4). The error is the rotation vector from it to the goal, rad.
    Orientation(FrameObject),
    /// The centre of mass of a body's subtree; body 0 stands for the whole model. Goal: a world position (3), m.
    CentreOfMass(usize),
    /// All joints. Goal: positions (nq). The error is the velocity that reaches the goal in one second.
    Posture,
}

impl IkTarget {
    /// Returns the number of values of a goal.
    pub fn goal_len(self, model: &Model) -> usize {
        match self {
            IkTarget::Position(_) | IkTarget::CentreOfMass(_) => 3,
            IkTarget::Orientation(_) => 4,
            IkTarget::Posture => model.nq,
        }
    }

    /// Returns the object that the target brings to a goal, if it is one.
    pub(crate) fn object(self) -> Option<FrameObject> {
        match self {
            IkTarget::Position(object) | IkTarget::Orientation(object) => Some(object),
            IkTarget::CentreOfMass(_) | IkTarget::Posture => None,
        }
    }

    /// Returns the number of weights: one per component of the error, but a single one for an orientation, whose error
    /// components are not independent.
    pub fn weight_len(self, model: &Model) -> usize {
        match self {
            IkTarget::Position(_) | IkTarget::CentreOfMass(_) => 3,
            IkTarget::Orientation(_) => 1,
            IkTarget::Posture => model.nv,
        }
    }
}

/// A target and its weights.
#[derive(Clone, Debug, PartialEq)]
pub struct IkTask {
    /// The target.
    pub target: IkTarget,
    /// The weight of each component of the error, see [`IkTarget::weight_len`]; not negative. A component of weight 0
    /// is ignored.
    pub weights: Vec<f64>,
}

impl IkTask {
    /// Creates a task whose components all have the same weight.
    pub fn new(model: &Model, target: IkTarget, weight: f64) -> Self {
        IkTask {
            target,
            weights: vec![weight; target.weight_len(model)],
        }
    }

    /// Returns an error if the model lacks the object, or the number of weights is wrong.
    fn check_sizes(&self, model: &Model) -> Result<(), SimError> {
        match self.target {
            IkTarget::Position(object) | IkTarget::Orientation(object) => {
                check_object(model, object)?;
            }
            IkTarget::CentreOfMass(body) => check_body(model, body)?,
            IkTarget::Posture => {}
        }
        check_length("weights", self.weights.len(), self.target.weight_len(model))
    }
}

/// Options of inverse kinematics.
#[derive(Clone, Debug, PartialEq)]
pub struct IkOptions {
    /// The maximum number of iterations from one start.
    pub iterations: usize,
    /// The error, m or rad, within which a task is reached. Posture tasks are ignored here unless there are no others.
    pub tolerance: f64,
    /// The initial damping, relative to the present cost, see [`search`](self).
    pub damping: f64,
    /// The maximum motion of a dof in an iteration, m or rad. Longer steps are scaled down as a whole.
    pub max_step: f64,
    /// The maximum number of restarts if the goals are not reached, from postures spread evenly over the ranges of
    /// joints. The best result is returned, with the iterations of all starts together.
    pub restarts: usize,
    /// True if joint limits are enforced: the start is projected onto them, and no iterate leaves them.
    pub limits: bool,
    /// The dofs that may move (nv); empty for all.
    pub dofs: Vec<bool>,
}

impl Default for IkOptions {
    /// Returns at most 100 iterations of any length, to 1e-6 m and rad, all dofs within their limits.
    fn default() -> Self {
        IkOptions {
            iterations: 100,
            tolerance: 1e-6,
            damping: 1e-3,
            max_step: f64::INFINITY,
            restarts: 0,
            limits: true,
            dofs: Vec::new(),
        }
    }
}

/// The status of an inverse kinematics solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum IkStatus {
    /// Every relevant task is within the tolerance.
    Reached,
    /// No nearby posture brings the tasks closer to their goals: some goal is out of reach, or tasks conflict.
    Stationary,
    /// The iteration limit was reached.
    IterationLimit,
    /// A value became infinite or undefined, or the model of the environment lacks a geom of the tasks.
    NonFinite,
}

impl IkStatus {
    const ALL: [IkStatus; 4] = [
        IkStatus::Reached,
        IkStatus::Stationary,
        IkStatus::IterationLimit,
        IkStatus::NonFinite,
    ];

    /// Returns its name in output, such as "iteration_limit".
    pub fn name(self) -> &'static str {
        match self {
            IkStatus::Reached => "reached",
            IkStatus::Stationary => "stationary",
            IkStatus::IterationLimit => "iteration_limit",
            IkStatus::NonFinite => "non_finite",
        }
    }
}

/// The result of inverse kinematics.
#[derive(Clone, Debug, PartialEq)]
pub struct IkSolution<T> {
    /// The joint positions (nq).
    pub qpos: Vec<T>,
    /// The unweighted error of each task (one per task), m or rad.
    pub errors: Vec<T>,
    /// The number of iterations.
    pub iterations: usize,
    /// The status.
    pub status: IkStatus,
}

/// Validated tasks for a model. The goals are passed to each call.
#[derive(Clone, Debug)]
pub struct Ik {
    pub(crate) tasks: Vec<IkTask>,
    pub(crate) options: IkOptions,
    /// The number of dofs of the model.
    nv: usize,
    /// The dofs that may move, ascending.
    pub(crate) movable: Vec<u32>,
    /// Those of them that are solved for: a task depends on them.
    pub(crate) dofs: Vec<u32>,
}

impl Ik {
    /// Creates validated tasks.
    ///
    /// # Errors
    /// Returns an error if an object does not exist, a number of weights or dofs is wrong, or a weight or option is out
    /// of range.
    pub fn new(model: &Model, tasks: Vec<IkTask>, options: IkOptions) -> Result<Self, SimError> {
        for task in &tasks {
            task.check_sizes(model)?;
            let is_weight = |w: &f64| *w >= 0.0 && w.is_finite();
            if let Some(&value) = task.weights.iter().find(|w| !is_weight(w)) {
                let (field, range) = ("weight", "finite and not negative");
                return Err(SimError::OutOfRange {
                    field,
                    value,
                    range,
                });
            }
        }
        for (field, value) in [
            ("tolerance", options.tolerance),
            ("damping", options.damping),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                let range = "finite and not negative";
                return Err(SimError::OutOfRange {
                    field,
                    value,
                    range,
                });
            }
        }
        if options.max_step.is_nan() || options.max_step <= 0.0 {
            return Err(SimError::OutOfRange {
                field: "max_step",
                value: options.max_step,
                range: "positive",
            });
        }
        if !options.dofs.is_empty() {
            check_length("dofs", options.dofs.len(), model.nv)?;
        }
        let moves = |dof: &usize| options.dofs.get(*dof).is_none_or(|&moves| moves);
        let movable = Vec::from_iter((0..model.nv).filter(moves).map(|dof| dof as u32));
        let counts = |dof: u32| {
            tasks
                .iter()
                .any(|task| task.is_moved_by(model, dof as usize))
        };
        let dofs = movable.iter().copied().filter(|&dof| counts(dof));
        Ok(Ik {
            nv: model.nv,
            dofs: dofs.collect(),
            movable,
            tasks,
            options,
        })
    }

    /// Returns an error if the tasks are of a model with other objects.
    pub(crate) fn check_model(&self, model: &Model) -> Result<(), SimError> {
        check_length("dofs", self.nv, model.nv)?;
        self.tasks
            .iter()
            .try_for_each(|task| task.check_sizes(model))
    }

    /// Returns the number of goal values of all tasks together, task by task.
    pub fn goal_len(&self, model: &Model) -> usize {
        let lengths = self.tasks.iter().map(|task| task.target.goal_len(model));
        lengths.sum()
    }

    /// Returns the tasks.
    pub fn tasks(&self) -> &[IkTask] {
        &self.tasks
    }
    /// Returns the options.
    pub fn options(&self) -> &IkOptions {
        &self.options
    }
}

impl IkTask {
    /// Returns true if the task's error depends on the dof.
    fn is_moved_by(&self, model: &Model, dof: usize) -> bool {
        let in_chain = |body: usize| {
            let last = model.bodies[body].last_dof;
            last.is_some_and(|last| model.tree.row(last).contains(&(dof as u32)))
        };
        match self.target {
            IkTarget::Position(object) | IkTarget::Orientation(object) => {
                in_chain(object.body(model))
            }
            IkTarget::CentreOfMass(body) => {
                in_chain(body) || model.subtree(body).contains(&model.dofs[dof].body)
            }
            IkTarget::Posture => self.weights[dof] > 0.0,
        }
    }
}
