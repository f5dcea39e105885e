//! `clench.RigidOptions`: which options were set, each checked as it is.

use crate::option_values::{
    Show, algorithm, boolean, cone, count, limit, not_negative, positive, switch,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// Options of the constraint model and its solver.
///
/// What is set here wins over the model's file, the file over the defaults below. What is not set is None.
///
/// Parameters
/// ----------
/// constraint_solver : {"Newton", "CG"}, optional
///     Algorithm that minimises; "Newton" by default.
/// iterations : int, optional
///     Most iterations of a solve; 50 by default, 100 in models from MJCF.
/// tolerance : float, optional
///     A solve stops where gradient and last improvement ("CG": the duality gap), over mean inertia times nv, are below;
///     1e-8 by default, 1e-5 in single precision. Zero asks for the working precision.
/// ls_iterations : int, optional
///     Most evaluations of a line search; 50 by default.
/// ls_tolerance : float, optional
///     Precision of a line search relative to `tolerance`; 0.01 by default.
/// constraint_timeconst : float, optional
///     Shortest time constant in seconds that a constraint may have; 0.01 by default, none in models from MJCF.
/// enable_joint_limit : bool, optional
///     Whether joint limits act; True by default.
/// disable_constraint : bool, optional
///     Whether all constraints are left out; False by default.
/// sparse_solve : bool or "auto", optional
///     Whether the Hessian is kept sparse; decided by the model by default.
/// noslip_iterations : int, optional
///     Most sweeps that remove the slip of friction after a solve; 0 by default.
/// noslip_tolerance : float, optional
///     Sweeps stop where their improvement, over mean inertia times nv, is below; 1e-6 by default.
/// max_contacts : int or "auto", optional
///     Most contacts of a step; as many as there are by default.
/// friction_cone : {"pyramidal", "elliptic"}, optional
///     Shape of frictional contacts; "pyramidal" by default.
/// impratio : float, optional
///     Ratio of friction to normal impedance in elliptic contacts; 1 by default.
/// islands : bool or "auto", optional
///     Whether uncoupled parts are solved separately; where the model has more than one tree by default.
/// warmstart : bool, optional
///     Whether a solve starts from the last acceleration; True by default.
/// autoreset : bool, optional
///     Whether a simulation that diverges goes on from its initial state, and counts it in ``resets``; False by default: it
///     raises an error, and an environment of a batch stands still.
///
/// Raises
/// ------
/// ValueError
///     An option outside its range.
/// TypeError
///     An option of the wrong type, or one that does not exist.
///
/// Examples
/// --------
/// >>> clench.RigidOptions(iterations=20, friction_cone="elliptic")
/// RigidOptions(iterations=20, friction_cone='elliptic')
#[pyclass(frozen, eq, module = "clench")]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RigidOptions(pub(crate) clench::RigidOptions);

macro_rules! options {
    ($($(#[$doc:meta])* $name:ident: $read:ident;)*) => {
        #[pymethods]
        impl RigidOptions {
            #[new]
            #[pyo3(signature = (*, $($name=None),*))]
            #[allow(clippy::too_many_arguments)] // By name, in Python.
            fn new($($name: Option<&Bound<'_, PyAny>>),*) -> PyResult<Self> {
                Ok(RigidOptions(clench::RigidOptions {
                    $($name: $name.map(|value| $read(stringify!($name), value)).transpose()?,)*
                }))
            }

            $($(#[$doc])*
            #[getter]
            fn $name<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
                self.0.$name.map(|value| value.show(py)).transpose()
            })*

            fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
                let set = self.set(py)?;
                let show = |(name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
                    Ok(format!("{name}={}", value.repr()?))
                };
                let shown: Vec<String> = set.iter().map(show).collect::<PyResult<_>>()?;
                Ok(format!("RigidOptions({})", shown.join(", ")))
            }

            fn __getnewargs_ex__<'py>(
                &self,
                py: Python<'py>,
            ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
                Ok((PyTuple::empty(py), self.set(py)?))
            }
        }

        impl RigidOptions {
            /// What is set, in order.
            fn set<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
                let set = PyDict::new(py);
                $(if let Some(value) = self.0.$name {
                    set.set_item(stringify!($name), value.show(py)?)?;
                })*
                Ok(set)
            }
        }
    };
}

options! {
    /// str or None : Algorithm that minimises: "Newton" or "CG".
    constraint_solver: algorithm;
    /// int or None : Most iterations of a solve.
    iterations: count;
    /// float or None : Where a solve stops.
    tolerance: not_negative;
    /// int or None : Most evaluations of a line search.
    ls_iterations: count;
    /// float or None : Precision of a line search relative to `tolerance`.
    ls_tolerance: not_negative;
    /// float or None : Shortest time constant (s) that a constraint may have.
    constraint_timeconst: not_negative;
    /// bool or None : Whether joint limits act.
    enable_joint_limit: boolean;
    /// bool or None : Whether all constraints are left out.
    disable_constraint: boolean;
    /// bool or str or None : Whether the Hessian is kept sparse: True, False or "auto".
    sparse_solve: switch;
    /// int or None : Most sweeps that remove the slip of friction after a solve.
    noslip_iterations: count;
    /// float or None : Where sweeps stop.
    noslip_tolerance: not_negative;
    /// int or str or None : Most contacts of a step: a number or "auto".
    max_contacts: limit;
    /// str or None : Shape of frictional contacts: "pyramidal" or "elliptic".
    friction_cone: cone;
    /// float or None : Ratio of friction to normal impedance in elliptic contacts.
    impratio: positive;
    /// bool or str or None : Whether uncoupled parts are solved separately: True, False or "auto".
    islands: switch;
    /// bool or None : Whether a solve starts from the last acceleration.
    warmstart: boolean;
    /// bool or None : Whether a simulation that diverges goes on from its initial state.
    autoreset: boolean;
}
