//! `clench.solve`: the convex problem without bodies.

use crate::arrays::{numbers, require_finite, require_shape, shape_text};
use crate::block::Block;
use crate::error::problem_error;
use crate::options::RigidOptions;
use crate::stats::SolverStats;
use clench::solver::{PlainBlock, Problem, ProblemError, Settings, Solver};
use numpy::{PyArray1, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// The maximum asymmetry of M relative to its largest entry. Rounding errors are about 1e-16 for each sum.
const SYMMETRIC: f64 = 1e-10;

/// Solves the convex problem of constrained dynamics, without bodies, joints or contacts.
///
/// The accelerations `qacc` minimise::
///
///     (qacc - a_unc).T @ M @ (qacc - a_unc) / 2  +  sum of cost(jacobian @ qacc - aref) over the blocks
///
/// Parameters
/// ----------
/// M : array_like, (nv, nv)
///     Mass matrix: symmetric, positive definite.
/// a_unc : array_like, (nv,)
///     The accelerations without constraints.
/// blocks : iterable of Block
///     The constraints.
/// options : RigidOptions, optional
///     Options of the solver. Only these have an effect: `constraint_solver`, `iterations`, `tolerance`, those of its
///     line search and of noslip, `sparse_solve`.
///
/// Returns
/// -------
/// Solution
///     Accelerations, forces, and their accuracy.
///
/// Raises
/// ------
/// ValueError
///     If shapes do not fit, a number is not finite, M is not symmetric or not positive definite, or a block is
///     invalid.
/// TypeError
///     If an argument is not an array of numbers, or a block is not a Block.
///
/// Examples
/// --------
/// Two unit masses; the second may not accelerate to the left.
///
/// >>> limit = clench.Block("one_sided", [0.0, 1.0], aref=0.0, R=0.25)
/// >>> clench.solve([[1.0, 0.0], [0.0, 1.0]], [-1.0, -1.0], [limit]).qacc
/// array([-1. , -0.2])
#[pyfunction]
#[pyo3(signature = (M, a_unc, blocks, options=None))]
#[allow(non_snake_case)] // M, as in the formulas.
pub(crate) fn solve<'py>(
    py: Python<'py>,
    M: &Bound<'py, PyAny>,
    a_unc: &Bound<'py, PyAny>,
    blocks: &Bound<'py, PyAny>,
    options: Option<&RigidOptions>,
) -> PyResult<Solution> {
    let acceleration = vector("a_unc", a_unc)?;
    let mass = mass_matrix(M, acceleration.len())?;
    let blocks = plain_blocks(blocks, acceleration.len())?;
    let settings = options.map_or_else(Settings::default, |options| {
        options.0.solver().resolve::<f64>()
    });
    let (problem, solver) = py
        .detach(|| minimise(&mass, &acceleration, &blocks, &settings))
        .map_err(problem_error)?;
    Solution::new(py, &problem, &solver)
}

fn minimise(
    mass: &[f64],
    acceleration: &[f64],
    blocks: &[PlainBlock<f64>],
    settings: &Settings,
) -> Result<(Problem<f64>, Solver<f64>), ProblemError> {
    let problem = Problem::from_arrays(mass, acceleration, blocks)?;
    let mut solver = Solver::compiled(problem.tree());
    solver.solve(&problem, settings, None)?;
    Ok((problem, solver))
}

/// The result of :func:`clench.solve`.
#[pyclass(frozen, get_all, module = "clench")]
pub(crate) struct Solution {
    /// numpy.ndarray : The accelerations of least cost (nv).
    qacc: Py<PyArray1<f64>>,
    /// list of numpy.ndarray : The force of each block along its rows (dim): the negative gradient of its cost.
    forces: Vec<Py<PyArray1<f64>>>,
    /// numpy.ndarray : All forces along the degrees of freedom (nv): the sum of ``jacobian.T @ force``.
    qfrc_constraint: Py<PyArray1<f64>>,
    /// str : Outcome; see :attr:`SolverStats.status`. After "non_finite" the numbers are not usable.
    status: &'static str,
    /// float : The duality gap, an upper bound of cost minus minimum. With noslip, it is that of the solution before
    /// the noslip sweeps.
    certificate: f64,
    /// SolverStats : Statistics of the solve.
    stats: Py<SolverStats>,
}

impl Solution {
    fn new(py: Python<'_>, problem: &Problem<f64>, solver: &Solver<f64>) -> PyResult<Self> {
        let array = |numbers: &[f64]| PyArray1::from_slice(py, numbers).unbind();
        let stats = SolverStats::from(solver.stats().lane(0));
        Ok(Solution {
            qacc: array(solver.qacc()),
            forces: (problem.blocks())
                .map(|block| array(&solver.force()[block.rows()]))
                .collect(),
            qfrc_constraint: array(solver.qfrc_constraint()),
            status: stats.status(),
            certificate: stats.gap(),
            stats: Py::new(py, stats)?,
        })
    }
}

#[pymethods]
impl Solution {
    fn __repr__(&self, py: Python<'_>) -> String {
        format!(
            "Solution(status='{}', certificate={:.1e}, nv={}, blocks={})",
            self.status,
            self.certificate,
            self.qacc.bind(py).len(),
            self.forces.len()
        )
    }
}

fn vector(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let array = numbers::<f64>(name, value)?;
    require_shape(name, array.shape(), &[array.len()])?;
    let values = array.as_slice()?;
    require_finite(name, values)?;
    Ok(values.to_vec())
}

fn mass_matrix(value: &Bound<'_, PyAny>, nv: usize) -> PyResult<Vec<f64>> {
    let array = numbers::<f64>("M", value)?;
    if *array.shape() != [nv, nv] {
        return Err(PyValueError::new_err(format!(
            "M has shape {}, but a_unc has {nv} numbers",
            shape_text(array.shape())
        )));
    }
    let values = array.as_slice()?;
    require_finite("M", values)?;
    let largest = values
        .iter()
        .fold(0.0_f64, |largest, x| largest.max(x.abs()));
    for i in 0..nv {
        for j in 0..i {
            let (lower, upper) = (values[i * nv + j], values[j * nv + i]);
            if (lower - upper).abs() > SYMMETRIC * largest {
                return Err(PyValueError::new_err(format!(
                    "M is not symmetric: M[{i}, {j}] is {lower}, M[{j}, {i}] is {upper}"
                )));
            }
        }
    }
    Ok(values.to_vec())
}

fn plain_blocks(blocks: &Bound<'_, PyAny>, nv: usize) -> PyResult<Vec<PlainBlock<f64>>> {
    let mut plain = Vec::new();
    for (i, block) in blocks.try_iter()?.enumerate() {
        let block = block?;
        let Ok(block) = block.cast::<Block>() else {
            let found = block.get_type().name()?;
            let text = format!("blocks[{i}] must be a Block, not {found}");
            return Err(PyTypeError::new_err(text));
        };
        let block = block.get();
        if block.nv() != nv {
            return Err(PyValueError::new_err(format!(
                "blocks[{i}] has a jacobian of {} columns, but a_unc has {nv} numbers",
                block.nv()
            )));
        }
        plain.push(block.plain().clone());
    }
    Ok(plain)
}
