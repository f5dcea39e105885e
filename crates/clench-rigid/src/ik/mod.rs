//! Inverse kinematics: positions of joints that bring objects to their goals, by damped least squares.
//!
//! Of tasks with errors e_k (goal less present value) and weights W_k
//!
//! ```text
//! minimise over q:   ½ Σ_k |W_k e_k(q)|²     within the limits of joints
//! ```
//!
//! by the method of Levenberg and Marquardt with projection onto the limits (Kanzow, Yamashita & Fukushima 2004), see `search`.
//! Like every method that goes downhill it ends in the minimum of the valley where it began: other starts may end elsewhere, and
//! `restarts` tries some (`halton`).
//!
//! What lives here: the tasks (this file), the linear equations of an iteration (`equations`), the iterations (`search`), other starts
//! (`halton`). Poses and Jacobians come from `dynamics`. Loops of equality constraints, tendon limits and collisions are not looked at.

mod equations;
mod halton;
mod search;

pub(crate) use search::Search;

use crate::query::{check_body, check_object};
use clench_dynamics::check::check_length;
use clench_dynamics::error::SimError;
use clench_dynamics::model::{FrameObject, Model};

/// What is brought to a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IkTarget {
    /// The position of an object. Goal: a place in the world (3), m.
    Position(FrameObject),
    /// The orientation of an object. Goal: a quaternion (4). Its error is the rotation vector that is left, rad.
    Orientation(FrameObject),
    /// The centre of mass of a body and all below it; that of the world is that of everything. Goal: a place (3), m.
    CentreOfMass(usize),
    /// All joints. Goal: positions (nq). Its error is the velocity that leads there in a second.
    Posture,
}

impl IkTarget {
    /// How many numbers a goal has.
    pub fn goal_len(self, model: &Model) -> usize {
        match self {
            IkTarget::Position(_) | IkTarget::CentreOfMass(_) => 3,
            IkTarget::Orientation(_) => 4,
            IkTarget::Posture => model.nq,
        }
    }

    /// How many weights it has: one a component of its error, but one in all for orientations, whose error is no vector of
    /// independent parts.
    pub fn weight_len(self, model: &Model) -> usize {
        match self {
            IkTarget::Position(_) | IkTarget::CentreOfMass(_) => 3,
            IkTarget::Orientation(_) => 1,
            IkTarget::Posture => model.nv,
        }
    }
}

/// A target and how much it counts.
#[derive(Clone, Debug, PartialEq)]
pub struct IkTask {
    /// What is brought to a goal.
    pub target: IkTarget,
    /// The weight of each component of its error, see [`IkTarget::weight_len`]; not negative. A component of weight 0
    /// does not count.
    pub weights: Vec<f64>,
}

impl IkTask {
    /// A target of which every component has the same weight.
    pub fn new(model: &Model, target: IkTarget, weight: f64) -> Self {
        IkTask {
            target,
            weights: vec![weight; target.weight_len(model)],
        }
    }
}

/// How inverse kinematics are computed.
#[derive(Clone, Debug, PartialEq)]
pub struct IkOptions {
    /// The most iterations from one start.
    pub iterations: usize,
    /// The error, m or rad, below which a task that counts is done. A posture is never waited for unless there is nothing else.
    pub tolerance: f64,
    /// Damping at the start, in parts of the present cost, see [`search`](self).
    pub damping: f64,
    /// The most that any dof moves in an iteration, m or rad: longer steps are shortened as a whole.
    pub max_step: f64,
    /// How often the search begins anew where it did not reach the goals, from postures spread evenly over the ranges of joints. The
    /// best of all ends is what comes out, and iterations are those of all together.
    pub restarts: usize,
    /// Whether the limits of joints are kept: the start is moved within them, and no iterate leaves them.
    pub limits: bool,
    /// The dofs that may move (nv); all if it is empty.
    pub dofs: Vec<bool>,
}

impl Default for IkOptions {
    /// At most 100 iterations of any length, to 1e-6 m and rad, all dofs within their limits.
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

/// How inverse kinematics ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum IkStatus {
    /// Every task that counts is within the tolerance.
    Reached,
    /// Nothing near brings the tasks closer to their goals together: some goal is out of reach, or tasks contradict each other.
    Stationary,
    /// The iteration limit came first.
    IterationLimit,
    /// A number became infinite or undefined.
    NonFinite,
}

impl IkStatus {
    const ALL: [IkStatus; 4] = [
        IkStatus::Reached,
        IkStatus::Stationary,
        IkStatus::IterationLimit,
        IkStatus::NonFinite,
    ];

    /// Its name in output, such as "iteration_limit".
    pub fn name(self) -> &'static str {
        match self {
            IkStatus::Reached => "reached",
            IkStatus::Stationary => "stationary",
            IkStatus::IterationLimit => "iteration_limit",
            IkStatus::NonFinite => "non_finite",
        }
    }
}

/// What inverse kinematics found.
#[derive(Clone, Debug, PartialEq)]
pub struct IkSolution<T> {
    /// Positions of the joints (nq).
    pub qpos: Vec<T>,
    /// How large each task's error is there, without its weights (as many as tasks): m or rad.
    pub errors: Vec<T>,
    /// Iterations.
    pub iterations: usize,
    /// How it ended.
    pub status: IkStatus,
}

/// Tasks for a model, checked: which goals they have is said at each call.
#[derive(Clone, Debug)]
pub struct Ik {
    pub(crate) tasks: Vec<IkTask>,
    pub(crate) options: IkOptions,
    /// The dofs that are solved for, ascending.
    pub(crate) dofs: Vec<u32>,
}

impl Ik {
    /// # Errors
    /// Tasks of objects that the model does not have, numbers of weights or dofs that it does not take, weights or options out of
    /// their range.
    pub fn new(model: &Model, tasks: Vec<IkTask>, options: IkOptions) -> Result<Self, SimError> {
        for task in &tasks {
            match task.target {
                IkTarget::Position(object) | IkTarget::Orientation(object) => {
                    check_object(model, object)?;
                }
                IkTarget::CentreOfMass(body) => check_body(model, body)?,
                IkTarget::Posture => {}
            }
            check_length("weights", task.weights.len(), task.target.weight_len(model))?;
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
        let may_move = Vec::from_iter((0..model.nv).filter(moves));
        let counts = |dof: &usize| tasks.iter().any(|task| task.is_moved_by(model, *dof));
        let dofs = may_move.into_iter().filter(counts);
        Ok(Ik {
            dofs: dofs.map(|dof| dof as u32).collect(),
            tasks,
            options,
        })
    }

    /// How many numbers the goals of all tasks have together, task after task.
    pub fn goal_len(&self, model: &Model) -> usize {
        let lengths = self.tasks.iter().map(|task| task.target.goal_len(model));
        lengths.sum()
    }

    /// The tasks.
    pub fn tasks(&self) -> &[IkTask] {
        &self.tasks
    }
    /// The options.
    pub fn options(&self) -> &IkOptions {
        &self.options
    }
}

impl IkTask {
    /// Whether the task's error depends on a dof.
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
