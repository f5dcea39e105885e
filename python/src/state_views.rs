//! The arrays of a state, live.

use crate::arrays::shape_text;
use crate::view::{Keeper, view};
use clench::Precision;
use clench::rigid::batch::{Rows, StateRows};
use clench::rigid::state::Size;
use clench::rigid::state::kind::{self, Kind};
use numpy::Element;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

/// What Python is told of a field of the state.
pub(crate) struct StateField {
    pub name: &'static str,
    /// NumPy's type; `number` is the float of the simulation's precision.
    pub dtype: &'static str,
    pub size: Size,
    /// How many numbers each element has.
    pub width: usize,
    /// What it is.
    pub doc: &'static str,
}

macro_rules! views {
    ($($group:ident { $(
        $(#[doc = $doc:literal])* $field:ident $setter:ident: $kind:ident, $size:ident, $bound:ident;
    )* })*) => {
        /// The state of a `Sim` or of all environments of a `Batch`, as NumPy arrays that are the memory a step works on: no
        /// copies.
        ///
        /// Each array is the same object as long as the simulation lives, and keeps its memory when it outlives the simulation.
        /// Write between steps; an assignment such as ``sim.ctrl = values`` copies the values in. In a `Batch` every array has
        /// the environments as its first axis.
        #[pyclass(frozen, subclass, module = "clench")]
        pub(crate) struct StateViews {
            time: Py<PyAny>,
            $($($field: Py<PyAny>,)*)*
        }

        /// The fields of a state, but for the time.
        pub(crate) const FIELDS: &[StateField] = &[$($(StateField {
            name: stringify!($field),
            dtype: <<kind::$kind as Kind>::Cell<f64> as Viewed>::NAME,
            size: Size::$size,
            width: kind::$kind::WIDTH,
            doc: concat!($($doc),*),
        }),*),*];

        impl StateViews {
            /// The arrays with their names.
            fn named(&self) -> Vec<(&'static str, &Py<PyAny>)> {
                vec![("time", &self.time), $($((stringify!($field), &self.$field)),*),*]
            }
        }

        #[pymethods]
        impl StateViews {
            $($(
            /// numpy.ndarray :
            $(#[doc = $doc])*
            #[getter]
            fn $field(&self, py: Python<'_>) -> Py<PyAny> {
                self.$field.clone_ref(py)
            }

            #[setter]
            fn $setter(&self, values: &Bound<'_, PyAny>) -> PyResult<()> {
                copy_to(self.$field.bind(values.py()), values)
            })*)*

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

        impl StateViews {
            /// Views of `rows`, whose memory `keeper` keeps; with `alone`, of its only row.
            pub(crate) fn new<S: Precision + Viewed>(
                keeper: &Bound<'_, Keeper>,
                rows: &mut StateRows<S>,
                alone: bool,
            ) -> PyResult<Self> {
                let envs = if alone { None } else { Some(rows.count()) };
                let shape = |of_row: &[usize]| {
                    Vec::from_iter(envs.into_iter().chain(of_row.iter().copied()))
                };
                Ok(StateViews {
                    time: array(keeper, &mut rows.time, &shape(&[]))?,
                    $($($field: {
                        let elements = rows.$field.width() / kind::$kind::WIDTH;
                        let shape = match kind::$kind::WIDTH {
                            1 => shape(&[elements]),
                            width => shape(&[elements, width]),
                        };
                        array(keeper, &mut rows.$field, &shape)?
                    },)*)*
                })
            }
        }
    };
}
clench::rigid::state_fields!(views);

/// What rows hold, as NumPy calls it.
pub(crate) trait Viewed: Sized {
    /// The number of the same bytes.
    type As: Element;
    /// What it is called in [`StateField::dtype`].
    const NAME: &'static str;
}
impl Viewed for f64 {
    type As = f64;
    const NAME: &'static str = "number";
}
impl Viewed for f32 {
    type As = f32;
    const NAME: &'static str = "number";
}
impl Viewed for i32 {
    type As = i32;
    const NAME: &'static str = "int32";
}
/// A truth value is a byte for NumPy too.
impl Viewed for u8 {
    type As = bool;
    const NAME: &'static str = "bool";
}

/// A table as an array of a shape that has as many numbers.
fn array<E: Viewed>(
    keeper: &Bound<'_, Keeper>,
    rows: &mut Rows<E>,
    shape: &[usize],
) -> PyResult<Py<PyAny>> {
    // SAFETY: the shape is that of the table, which `keeper` keeps and nothing replaces.
    let array = unsafe { view(keeper, rows.as_mut_ptr().cast::<E::As>(), shape) }?;
    Ok(array.into_any().unbind())
}

impl StateViews {
    /// A copy of all arrays, as a `clench.State`.
    pub(crate) fn copy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let copies = PyDict::new(py);
        for (name, array) in self.named() {
            copies.set_item(name, array.call_method0(py, "copy")?)?;
        }
        state_class(py)?.call((), Some(&copies))
    }

    /// Takes over a `clench.State`: of the same shapes, or, into those of a batch, that of one environment for all.
    ///
    /// # Errors
    /// Another shape or type; the arrays are then as before.
    pub(crate) fn take_over(&self, state: &Bound<'_, PyAny>) -> PyResult<()> {
        self.take_over_rows(state, None)
    }

    /// Takes over a `clench.State` into some environments of a batch: their indices, and how many there are.
    ///
    /// # Errors
    /// As [`take_over`](Self::take_over).
    pub(crate) fn take_over_rows(
        &self,
        state: &Bound<'_, PyAny>,
        envs: Option<(&Bound<'_, PyAny>, usize)>,
    ) -> PyResult<()> {
        let py = state.py();
        if !is_state(state)? {
            let found = state.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "a state must be a clench.State, not {found}"
            )));
        }
        let values = state.call_method0(intern!(py, "_arrays"))?;
        let mut pairs = Vec::new();
        for (name, array) in self.named() {
            let (to, mut from) = (array.bind(py), values.get_item(name)?);
            // States of versions that knew no constraints at run time have no slots for them: nothing is tied.
            if name.starts_with("dynamic_") && from.getattr("size")?.extract::<usize>()? == 0 {
                let rows = envs.map_or_else(|| Ok(to.clone()), |(envs, _)| to.get_item(envs))?;
                from = rows.call_method0("copy")?;
                from.call_method1("fill", (0,))?;
            }
            let (found, needed) = (from.getattr("shape")?, to.getattr("shape")?);
            let found: Vec<usize> = found.extract()?;
            let mut needed: Vec<usize> = needed.extract()?;
            if let (Some((_, count)), Some(first)) = (envs, needed.first_mut()) {
                *first = count;
            }
            let one_for_all = self.is_of_batch(py)? && needed.get(1..) == Some(&found[..]);
            if found != needed && !one_for_all {
                let (found, needed) = (shape_text(&found), shape_text(&needed));
                return Err(PyValueError::new_err(format!(
                    "{name} of the state has shape {found} where {needed} is needed: is it of another model, or of another \
                     number of environments?"
                )));
            }
            pairs.push((to, from));
        }
        pairs.iter().try_for_each(|(to, from)| match envs {
            Some((envs, _)) => to.set_item(envs, from),
            None => copy_to(to, from),
        })
    }

    /// Whether the arrays are of environments side by side.
    fn is_of_batch(&self, py: Python<'_>) -> PyResult<bool> {
        let time = self.time.bind(py).getattr("ndim")?;
        Ok(time.extract::<usize>()? > 0)
    }
}

/// Whether something is a `clench.State`.
pub(crate) fn is_state(value: &Bound<'_, PyAny>) -> PyResult<bool> {
    value.is_instance(state_class(value.py())?)
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
