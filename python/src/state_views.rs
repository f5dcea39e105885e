//! The arrays of a state, live.

use crate::view::{Keeper, view};
use clench::rigid::batch::StateRows;
use clench::{Model, Precision};
use numpy::Element;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

macro_rules! views {
    ($($(#[$doc:meta])* $field:ident $setter:ident;)*) => {
        /// The state of a `Sim` or of all environments of a `Batch`, as NumPy arrays that are the memory a step works on: no
        /// copies.
        ///
        /// Each array is the same object as long as the simulation lives, and keeps its memory when it outlives the simulation.
        /// Write between steps; an assignment such as ``sim.ctrl = values`` copies the values in. In a `Batch` every array has
        /// the environments as its first axis.
        #[pyclass(frozen, subclass, module = "clench")]
        pub(crate) struct StateViews {
            time: Py<PyAny>,
            $($field: Py<PyAny>,)*
        }

        impl StateViews {
            /// The arrays with their names.
            fn named(&self) -> Vec<(&'static str, &Py<PyAny>)> {
                vec![("time", &self.time), $((stringify!($field), &self.$field)),*]
            }
        }

        #[pymethods]
        impl StateViews {
            $($(#[$doc])*
            #[getter]
            fn $field(&self, py: Python<'_>) -> Py<PyAny> {
                self.$field.clone_ref(py)
            }

            #[setter]
            fn $setter(&self, values: &Bound<'_, PyAny>) -> PyResult<()> {
                copy_to(self.$field.bind(values.py()), values)
            })*

            /// float or numpy.ndarray : Time, s: a number for a `Sim`, an array (n) for a `Batch`, float64 in every precision.
            #[getter]
            fn time<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                let time = self.time.bind(py);
                match time.getattr("ndim")?.extract()? {
                    0 => time.call_method0("item"),
                    _ => Ok(time.clone()),
                }
            }

            #[setter]
            fn set_time(&self, values: &Bound<'_, PyAny>) -> PyResult<()> {
                copy_to(self.time.bind(values.py()), values)
            }
        }
    };
}
views! {
    /// numpy.ndarray : Position coordinates (nq).
    qpos set_qpos;
    /// numpy.ndarray : Velocities (nv).
    qvel set_qvel;
    /// numpy.ndarray : Activations of actuators (na).
    act set_act;
    /// numpy.ndarray : Controls of actuators (nu).
    ctrl set_ctrl;
    /// numpy.ndarray : Forces that you apply along degrees of freedom (nv), N or N m.
    qfrc_applied set_qfrc_applied;
    /// numpy.ndarray : Forces and torques that you apply to bodies at their centres of mass, world axes (nbody, 6): the force
    /// first.
    xfrc_applied set_xfrc_applied;
    /// numpy.ndarray : Positions of mocap bodies (nmocap, 3), m.
    mocap_pos set_mocap_pos;
    /// numpy.ndarray : Orientations of mocap bodies (nmocap, 4), unit quaternions, w first.
    mocap_quat set_mocap_quat;
    /// numpy.ndarray : Which equality constraints are on (neq), bool.
    eq_active set_eq_active;
    /// numpy.ndarray : Acceleration of the previous step, where the solver starts (nv).
    qacc_warmstart set_qacc_warmstart;
}

impl StateViews {
    /// Views of `rows`, whose memory `keeper` keeps; with `alone`, of its only row.
    pub(crate) fn new<S: Precision + Element>(
        keeper: &Bound<'_, Keeper>,
        rows: &mut StateRows<S>,
        model: &Model,
        alone: bool,
    ) -> PyResult<Self> {
        let count = rows.count();
        let shape = |of_row: &[usize]| {
            let envs = if alone { None } else { Some(count) };
            Vec::from_iter(envs.into_iter().chain(of_row.iter().copied()))
        };
        let (nbody, nmocap) = (model.nbody(), model.nmocap);
        // SAFETY: the shapes are those of the tables, which `keeper` keeps and nothing replaces. NumPy's booleans are bytes too.
        macro_rules! array {
            ($field:ident $(as $number:ty)? $(, $size:expr)*) => {
                unsafe { view(keeper, rows.$field.as_mut_ptr()$(.cast::<$number>())?, &shape(&[$($size),*])) }?
                    .into_any()
                    .unbind()
            };
        }
        Ok(StateViews {
            time: array!(time),
            qpos: array!(qpos, model.nq),
            qvel: array!(qvel, model.nv),
            act: array!(act, model.na),
            ctrl: array!(ctrl, model.nu()),
            qfrc_applied: array!(qfrc_applied, model.nv),
            xfrc_applied: array!(xfrc_applied, nbody, 6),
            mocap_pos: array!(mocap_pos, nmocap, 3),
            mocap_quat: array!(mocap_quat, nmocap, 4),
            eq_active: array!(eq_active as bool, model.equalities.len()),
            qacc_warmstart: array!(qacc_warmstart, model.nv),
        })
    }

    /// A copy of all arrays, as a `clench.State`.
    pub(crate) fn copy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let copies = PyDict::new(py);
        for (name, array) in self.named() {
            copies.set_item(name, array.call_method0(py, "copy")?)?;
        }
        state_class(py)?.call((), Some(&copies))
    }

    /// Takes over a `clench.State` of the same shapes.
    ///
    /// # Errors
    /// Another shape or type; the arrays are then as before.
    pub(crate) fn take_over(&self, state: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = state.py();
        if !state.is_instance(state_class(py)?)? {
            let found = state.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "a state must be a clench.State, not {found}"
            )));
        }
        let values = state.call_method0(intern!(py, "_arrays"))?;
        let mut pairs = Vec::new();
        for (name, array) in self.named() {
            let (to, from) = (array.bind(py), values.get_item(name)?);
            let (found, needed) = (from.getattr("shape")?, to.getattr("shape")?);
            if !found.eq(&needed)? {
                return Err(PyValueError::new_err(format!(
                    "{name} of the state has shape {found} where {needed} is needed: is it of another model, or of another \
                     number of environments?"
                )));
            }
            pairs.push((to, from));
        }
        pairs.iter().try_for_each(|(to, from)| copy_to(to, from))
    }
}

/// `clench.State`.
fn state_class(py: Python<'_>) -> PyResult<&Bound<'_, PyAny>> {
    static STATE: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    STATE.import(py, "clench._state", "State")
}

/// Copies values into an array as NumPy would, but only numbers of the same kind.
fn copy_to(array: &Bound<'_, PyAny>, values: &Bound<'_, PyAny>) -> PyResult<()> {
    static COPYTO: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let copyto = COPYTO.import(array.py(), "numpy", "copyto")?;
    copyto.call1((array, values)).map(|_| ())
}
