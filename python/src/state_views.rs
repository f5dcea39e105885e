//! Live arrays of a state.

use crate::arrays::{as_array, shape_text};
use crate::view::{Keeper, view};
use clench::Precision;
use clench::rigid::batch::{Rows, StateRows};
use clench::rigid::state::Size;
use clench::rigid::state::kind::{self, Kind};
use numpy::{Element, PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{IntoPyDict, PyDict};

/// The description of a state field for Python.
pub(crate) struct StateField {
    pub name: &'static str,
    /// The NumPy dtype; `number` is the float of the simulation's precision.
    pub dtype: &'static str,
    pub size: Size,
    /// The number of values per element.
    pub width: usize,
    /// The description of the field.
    pub doc: &'static str,
}

macro_rules! views {
    ($($group:ident { $(
        $(#[doc = $doc:literal])* $field:ident $setter:ident: $kind:ident, $size:ident, $bound:ident;
    )* })*) => {
        /// The state of a `Sim` or of all environments of a `Batch`, as NumPy arrays that share memory with the
        /// simulation: they are not copies.
        ///
        /// Each array remains the same object during the life of the simulation, and stays valid after it. Write
        /// between steps; an assignment such as ``sim.ctrl = values`` copies the values. In a `Batch` the environments
        /// are the first axis of every array.
        #[pyclass(frozen, subclass, module = "clench")]
        pub(crate) struct StateViews {
            time: Py<PyAny>,
            $($($field: Py<PyAny>,)*)*
        }

        /// The fields of a state, except the time.
        pub(crate) const FIELDS: &[StateField] = &[$($(StateField {
            name: stringify!($field),
            dtype: <<kind::$kind as Kind>::Cell<f64> as Viewed>::NAME,
            size: Size::$size,
            width: kind::$kind::WIDTH,
            doc: concat!($($doc),*),
        }),*),*];

        impl StateViews {
            /// Returns the arrays with their names.
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

            /// float or numpy.ndarray : Time, s: a number for a `Sim`, an array (n) for a `Batch`, float64 in either
            /// precision.
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
            /// Creates views of `rows`, whose memory `keeper` owns; with `single`, of the only row.
            pub(crate) fn new<S: Precision + Viewed>(
                keeper: &Bound<'_, Keeper>,
                rows: &mut StateRows<S>,
                single: bool,
            ) -> PyResult<Self> {
                let envs = if single { None } else { Some(rows.count()) };
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

/// A type of the state's values, with its NumPy counterpart.
pub(crate) trait Viewed: Sized {
    /// The NumPy type with the same bytes.
    type As: Element;
    /// The name of the type in [`StateField::dtype`].
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
/// NumPy stores a boolean as a byte.
impl Viewed for u8 {
    type As = bool;
    const NAME: &'static str = "bool";
}

/// Returns a table as an array of this shape, which has the same number of values.
fn array<E: Viewed>(
    keeper: &Bound<'_, Keeper>,
    rows: &mut Rows<E>,
    shape: &[usize],
) -> PyResult<Py<PyAny>> {
    // SAFETY: the shape is that of the table, which `keeper` owns and which is never replaced.
    let array = unsafe { view(keeper, rows.as_mut_ptr().cast::<E::As>(), shape) }?;
    Ok(array.into_any().unbind())
}

impl StateViews {
    /// Copies all arrays into a `clench.State`.
    pub(crate) fn copy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let copies = PyDict::new(py);
        for (name, array) in self.named() {
            copies.set_item(name, array.call_method0(py, intern!(py, "copy"))?)?;
        }
        // Without the checks of the constructor.
        let class = state_class(py)?;
        let state = class.call_method1(intern!(py, "__new__"), (class,))?;
        state.setattr(intern!(py, "__dict__"), copies)?;
        Ok(state)
    }

    /// Copies a `clench.State` into the arrays: one of the same shapes or, for a batch, a state of one environment for
    /// all.
    ///
    /// # Errors
    /// Returns an error if a shape or type differs. The arrays are then unchanged.
    pub(crate) fn assign_from(&self, state: &Bound<'_, PyAny>) -> PyResult<()> {
        self.assign_rows_from(state, None)
    }

    /// Copies a `clench.State` into some environments of a batch, given by their indices and number.
    ///
    /// # Errors
    /// Same as [`assign_from`](Self::assign_from).
    pub(crate) fn assign_rows_from<'py>(
        &self,
        state: &Bound<'py, PyAny>,
        envs: Option<(&Bound<'py, PyAny>, usize)>,
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
            let (to, from) = (array.bind(py), values.get_item(name)?);
            let [found, needed] = [&from, to].map(|array| array.getattr(intern!(py, "shape")));
            let from = match envs.is_none() && found?.eq(needed?)? {
                true => from,
                false => self.fit(name, from, to, envs)?,
            };
            pairs.push((to, from));
        }
        pairs.iter().try_for_each(|(to, from)| match envs {
            Some((envs, _)) => to.set_item(envs, from),
            None => to.set_item(py.Ellipsis(), from),
        })
    }

    /// Returns the values of a field for some environments, or for all, of the array `to`.
    fn fit<'py>(
        &self,
        name: &str,
        mut from: Bound<'py, PyAny>,
        to: &Bound<'py, PyAny>,
        envs: Option<(&Bound<'py, PyAny>, usize)>,
    ) -> PyResult<Bound<'py, PyAny>> {
        // States of versions without dynamic constraints have no slots for them: all slots are set to empty.
        if name.starts_with("dynamic_") && from.getattr("size")?.extract::<usize>()? == 0 {
            let rows = envs.map_or_else(|| Ok(to.clone()), |(envs, _)| to.get_item(envs))?;
            from = rows.call_method0("copy")?;
            from.call_method1("fill", (0,))?;
        }
        let found: Vec<usize> = from.getattr("shape")?.extract()?;
        let mut needed: Vec<usize> = to.getattr("shape")?.extract()?;
        if let (Some((_, count)), Some(first)) = (envs, needed.first_mut()) {
            *first = count;
        }
        let one_for_all = self.is_of_batch(to.py())? && needed.get(1..) == Some(&found[..]);
        if found == needed || one_for_all {
            return Ok(from);
        }
        let (found, needed) = (shape_text(&found), shape_text(&needed));
        Err(PyValueError::new_err(format!(
            "{name} of the state has shape {found} where {needed} is needed: is it of another model, or of another number \
             of environments?"
        )))
    }

    /// Returns true if the arrays have an axis of environments.
    fn is_of_batch(&self, py: Python<'_>) -> PyResult<bool> {
        let time = self.time.bind(py).getattr("ndim")?;
        Ok(time.extract::<usize>()? > 0)
    }
}

/// Returns true if a value is a `clench.State`.
pub(crate) fn is_state(value: &Bound<'_, PyAny>) -> PyResult<bool> {
    value.is_instance(state_class(value.py())?)
}

/// Returns the class `clench.State`.
fn state_class(py: Python<'_>) -> PyResult<&Bound<'_, PyAny>> {
    static STATE: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    STATE.import(py, "clench._state", "State")
}

/// Copies values into an array as NumPy does, but only between dtypes of the same kind, and from integers to booleans:
/// MuJoCo's `eq_active` holds integers.
fn copy_to(array: &Bound<'_, PyAny>, values: &Bound<'_, PyAny>) -> PyResult<()> {
    static COPYTO: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = array.py();
    let copyto = COPYTO.import(py, "numpy", "copyto")?;
    let copied = copyto.call1((array, values));
    let kind = |array: &Bound<'_, PyUntypedArray>| array.dtype().kind();
    if copied.is_err()
        && array.cast().is_ok_and(|to| kind(to) == b'b')
        && matches!(kind(&as_array(values)?), b'i' | b'u')
    {
        let unsafely = [("casting", "unsafe")].into_py_dict(py)?;
        return copyto.call((array, values), Some(&unsafely)).map(|_| ());
    }
    copied.map(|_| ())
}
