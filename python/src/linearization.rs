//! `clench.Linearization`.

use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The linear model of a step about a state: x⁺ changes by A dx + B du, y by C dx + D du.
///
/// x holds the motion of the positions along the dofs (nv; rotations about the axes of the child, rad), then the
/// velocities (nv) and the activations (na), and with ``memory`` all else that a step changes. u holds the controls
/// (nu). y holds the sensors (nsensordata), then the chosen outputs, row after row, of the state before the step. The
/// matrices of a batch are stacked, (n, rows, columns).
#[pyclass(frozen, get_all, module = "clench")]
#[allow(non_snake_case)] // Named as in control theory.
pub(crate) struct Linearization {
    /// numpy.ndarray : ∂x⁺/∂x.
    pub(crate) A: Py<PyArrayDyn<f64>>,
    /// numpy.ndarray : ∂x⁺/∂u.
    pub(crate) B: Py<PyArrayDyn<f64>>,
    /// numpy.ndarray : ∂y/∂x.
    pub(crate) C: Py<PyArrayDyn<f64>>,
    /// numpy.ndarray : ∂y/∂u.
    pub(crate) D: Py<PyArrayDyn<f64>>,
    /// dict[str, numpy.ndarray] : ∂x⁺/∂p by parameter, with a column for each requested number.
    pub(crate) parameters: Py<PyDict>,
    /// dict[str, numpy.ndarray] : ∂y/∂p, likewise.
    pub(crate) output_parameters: Py<PyDict>,
    /// numpy.ndarray : The distance of each constraint row, in the order of `Sim.constraints`, from a change of its
    /// state (a contact that begins to slip, a limit that becomes inactive), where its force has no derivative; m/s² or
    /// rad/s², infinite for rows that always act. Of a batch, a list of arrays.
    pub(crate) switching: Py<PyAny>,
    /// numpy.ndarray or None : The bound of the error of each acceleration (the output ``qacc``), (nv,), from the
    /// duality gap that the solver leaves; None unless requested. Bounds are infinite with RK4, noslip, sleep or
    /// Coulomb's law, and do not contain rounding errors of the constraints and the mass matrix.
    pub(crate) qacc_error: Py<PyAny>,
    /// numpy.ndarray or None : The bounds of the errors of the derivatives of the accelerations, (nv, columns): by x,
    /// by u, then by the parameters; infinite at a switch. With semi-implicit Euler without implicit damping, the
    /// errors of the rows of velocities of A and B are those times the time step.
    pub(crate) error: Py<PyAny>,
    /// numpy.ndarray or None : The bounds of the errors of ``switching``. A row whose ``switching`` is smaller may have
    /// another state than in an exact solution. Of a batch, a list of arrays.
    pub(crate) reach: Py<PyAny>,
}
