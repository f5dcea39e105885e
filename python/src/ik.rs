//! Inverse kinematics of `Sim` and `Batch`.

use crate::answer::answer;
use crate::arrays::{mask, numbers};
use crate::batch::{AnyBatch, Batch, each};
use crate::busy::lock;
use crate::count::Count;
use crate::error::sim_error;
use crate::ik_targets::{ComTarget, FrameTarget, PostureTarget};
use crate::kind::Kind;
use crate::one_or_many::one_or_many;
use crate::row_sim::{AnySim, each_sim};
use crate::sim::Sim;
use crate::table::Table;
use crate::target::{Choice, Choices};
use clench::{Ik, IkOptions, IkSolution, IkStatus, IkTarget, IkTask, Model, Precision, QueryInput};
use numpy::{Element, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// The result of inverse kinematics. In a batch the environments are the first axis.
#[pyclass(frozen, get_all, module = "clench")]
pub(crate) struct IkResult {
    /// numpy.ndarray : Positions of the joints (nq,).
    qpos: Py<PyAny>,
    /// numpy.ndarray : Remaining error of each goal, without its cost (goals,), m or rad, in the order of the targets;
    /// a frame's position precedes its orientation. The error of a posture is the norm of the velocity that reaches it
    /// in one second.
    errors: Py<PyAny>,
    /// int or numpy.ndarray : Number of iterations; int64 in a batch.
    iterations: Py<PyAny>,
    /// int or numpy.ndarray : Outcome, a code of `IkStatus`; int8 in a batch.
    status: Py<PyAny>,
    /// bool or numpy.ndarray : True if all goals except postures are reached within the tolerance.
    reached: Py<PyAny>,
}

/// The goals of all targets: tasks, and goal values in a precision.
struct Goals<S> {
    tasks: Vec<IkTask>,
    tables: Vec<(Table<S>, usize)>,
}

impl<S: Precision + Element> Goals<S> {
    fn of(model: &Model, targets: &Bound<'_, PyAny>, n: Option<usize>) -> PyResult<Self> {
        let mut goals = Goals {
            tasks: Vec::new(),
            tables: Vec::new(),
        };
        for target in targets.try_iter()? {
            goals.add(model, &target?, n)?;
        }
        Ok(goals)
    }

    fn add(&mut self, model: &Model, given: &Bound<'_, PyAny>, n: Option<usize>) -> PyResult<()> {
        let py = given.py();
        if let Ok(frame) = given.cast::<FrameTarget>() {
            let frame = frame.get();
            let chosen = [
                &frame.body,
                &frame.body_com,
                &frame.geom,
                &frame.site,
                &frame.camera,
            ];
            let chosen = chosen.map(|which| which.as_ref().map(|which| which.bind(py)));
            let object = Choices(chosen).one(model)?;
            if let Some(position) = &frame.position {
                let cost = frame.position_cost.bind(py);
                let target = IkTarget::Position(object);
                self.push(model, target, ("position", position.bind(py)), cost, n)?;
            }
            if let Some(quat) = &frame.quat {
                let cost = frame.orientation_cost.into_pyobject(py)?.into_any();
                let target = IkTarget::Orientation(object);
                self.push(model, target, ("quat", quat.bind(py)), &cost, n)?;
            }
            return Ok(());
        }
        if let Ok(com) = given.cast::<ComTarget>() {
            let com = com.get();
            let body = Kind::Body.find(model, com.body.bind(py))?;
            let goal = ("position", com.position.bind(py));
            return self.push(
                model,
                IkTarget::CentreOfMass(body),
                goal,
                com.cost.bind(py),
                n,
            );
        }
        if let Ok(posture) = given.cast::<PostureTarget>() {
            let posture = posture.get();
            let goal = ("qpos", posture.qpos.bind(py));
            return self.push(model, IkTarget::Posture, goal, posture.cost.bind(py), n);
        }
        let found = given.get_type().name()?;
        Err(PyTypeError::new_err(format!(
            "targets are FrameTarget, ComTarget and PostureTarget, not {found}"
        )))
    }

    fn push(
        &mut self,
        model: &Model,
        target: IkTarget,
        (name, goal): (&str, &Bound<'_, PyAny>),
        cost: &Bound<'_, PyAny>,
        n: Option<usize>,
    ) -> PyResult<()> {
        let cost = numbers::<f64>("cost", cost)?;
        let weights = match (cost.shape(), cost.as_slice()?) {
            ([], &[one]) => vec![one; target.weight_len(model)],
            (_, all) => all.to_vec(),
        };
        let width = target.goal_len(model);
        self.tasks.push(IkTask { target, weights });
        (self.tables).push((Table::row_of(name, goal, width, n)?, width));
        Ok(())
    }

    /// Returns all goals of an environment.
    fn row(&self, env: usize) -> Vec<S> {
        let rows = self
            .tables
            .iter()
            .map(|(table, width)| table.row(env, *width));
        rows.flatten().copied().collect()
    }

    /// Returns the goals of all `n` environments, and true if they differ between environments.
    fn all(&self, n: usize) -> (Vec<S>, bool) {
        match self.tables.iter().any(|(table, _)| table.is_each()) {
            true => ((0..n).flat_map(|env| self.row(env)).collect(), true),
            false => (self.row(0), false),
        }
    }
}

one_or_many! {
    /// Solves inverse kinematics: finds joint positions that bring targets to their goals, by damped least squares
    /// within the joint limits.
    ///
    /// Minimises half the sum of the squared errors times their costs, descending from the start: other starts may lead
    /// to other minima. Equality constraints, tendon limits and collisions are ignored. The state is not changed:
    /// assign ``sim.qpos[:] = result.qpos``. A `Batch` solves for every environment.
    ///
    /// Parameters
    /// ----------
    /// targets : iterable of FrameTarget, ComTarget and PostureTarget
    ///     The targets and their goals, which in a `Batch` may have the environments (n) as first axis.
    /// start : array_like, optional
    ///     Initial positions, (nq,) or in a `Batch` also (n, nq); by default those of the current state.
    /// iterations : int
    ///     Maximum number of iterations from one start.
    /// tolerance : float
    ///     The error, m or rad, below which a goal counts as reached. Postures do not have to be reached if there are
    ///     other targets.
    /// damping : float
    ///     Initial damping, relative to the current cost; it adapts.
    /// max_step : float, optional
    ///     Maximum motion of any dof in an iteration, m or rad; by default unlimited. With one iteration, it limits how
    ///     far a control loop moves towards its goals.
    /// limits : bool
    ///     True to keep joints in their ranges; a start outside is moved inside.
    /// dofs : array_like of bool, optional
    ///     Mask of the dofs that may move (nv,); by default all.
    /// restarts : int
    ///     Number of new starts if the goals are not reached, from postures spread evenly over the ranges of the
    ///     joints. The best result is returned.
    ///
    /// Returns
    /// -------
    /// IkResult
    ///     The positions and their errors, of a `Batch` with the environments as first axis: NaN and status NON_FINITE
    ///     where the environment's model lacks a geom of the targets.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the model does not have an object, a shape is wrong, or a number is not finite.
    #[pyo3(signature = (targets, *, start = None, iterations = Count(100), tolerance = 1e-6, damping = 1e-3,
                        max_step = None, limits = true, dofs = None, restarts = Count(0)),
           text_signature = "($self, targets, *, start=None, iterations=100, tolerance=1e-06, damping=0.001, max_step=None, limits=True, dofs=None, restarts=0)")]
    fn ik<'py>(
        &self,
        py: Python<'py>,
        targets: &Bound<'py, PyAny>,
        start: Choice<'_, 'py>,
        iterations: Count,
        tolerance: f64,
        damping: f64,
        max_step: Option<f64>,
        limits: bool,
        dofs: Choice<'_, 'py>,
        restarts: Count,
    ) -> PyResult<IkResult> {
        let dofs = dofs.map(|dofs| mask("dofs", dofs, self.described().nv)).transpose()?;
        let options = IkOptions {
            iterations: iterations.0,
            restarts: restarts.0,
            tolerance,
            damping,
            max_step: max_step.unwrap_or(f64::INFINITY),
            limits,
            dofs: dofs.unwrap_or_default(),
        };
        self.search(py, (targets, start), options)
    }
}

impl Sim {
    fn search<'py>(
        &self,
        py: Python<'py>,
        (targets, start): (&Bound<'py, PyAny>, Choice<'_, 'py>),
        options: IkOptions,
    ) -> PyResult<IkResult> {
        let model = self.described();
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let goals = Goals::of(model, targets, None)?;
            let start = start.map(|start| Table::row_of("start", start, model.nq, None)).transpose()?;
            let values = goals.row(0);
            let ik = Ik::new(model, goals.tasks, options).map_err(sim_error)?;
            let sim = own.current().map_err(sim_error)?;
            let found = py.detach(|| {
                sim.ik(&ik, &values, start.as_ref().map(|start| start.row(0, model.nq)))
            });
            let found = found.map_err(sim_error)?;
            Ok(IkResult {
                iterations: found.iterations.into_pyobject(py)?.into_any().unbind(),
                status: (found.status as i64).into_pyobject(py)?.into_any().unbind(),
                reached: is_reached(found.status).into_pyobject(py)?.to_owned().into_any().unbind(),
                errors: answer(py, found.errors, &[ik.tasks().len()], None)?.unbind(),
                qpos: answer(py, found.qpos, &[model.nq], None)?.unbind(),
            })
        })
    }
}

impl Batch {
    fn search<'py>(
        &self,
        py: Python<'py>,
        (targets, start): (&Bound<'py, PyAny>, Choice<'_, 'py>),
        options: IkOptions,
    ) -> PyResult<IkResult> {
        let (model, n) = (self.described(), self.count());
        let mut guard = lock(self.inner(), "batch")?;
        each!(&mut *guard, batch => {
            let goals = Goals::of(model, targets, Some(n))?;
            let start = start.map(|start| Table::row_of("start", start, model.nq, Some(n))).transpose()?;
            let (values, each) = goals.all(n);
            let values = if each { QueryInput::Each(&values) } else { QueryInput::Shared(&values) };
            let ik = Ik::new(model, goals.tasks, options).map_err(sim_error)?;
            let found = py.detach(|| batch.ik(&ik, values, start.as_ref().map(Table::input)));
            many(py, &found.map_err(sim_error)?, model.nq, ik.tasks().len())
        })
    }
}

fn is_reached(status: IkStatus) -> bool {
    status == IkStatus::Reached
}

/// Collects the results of all environments.
fn many<S: Precision + Element>(
    py: Python<'_>,
    found: &[IkSolution<S>],
    nq: usize,
    goals: usize,
) -> PyResult<IkResult> {
    let n = found.len();
    let qpos = found.iter().flat_map(|found| found.qpos.iter().copied());
    let errors = found.iter().flat_map(|found| found.errors.iter().copied());
    let iterations = found.iter().map(|found| found.iterations as i64);
    let status = found.iter().map(|found| found.status as i8);
    let reached = found.iter().map(|found| is_reached(found.status));
    Ok(IkResult {
        qpos: answer(py, qpos.collect(), &[n, nq], None)?.unbind(),
        errors: answer(py, errors.collect(), &[n, goals], None)?.unbind(),
        iterations: answer(py, iterations.collect(), &[n], None)?.unbind(),
        status: answer(py, status.collect(), &[n], None)?.unbind(),
        reached: answer(py, reached.collect(), &[n], None)?.unbind(),
    })
}
