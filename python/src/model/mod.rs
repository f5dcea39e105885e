//! `clench.Model`.

mod counts;
mod elements;

use crate::count::Count;
use crate::error::{load_error, sim_error};
use crate::fields;
use crate::names::no_attribute;
use crate::options::RigidOptions;
use crate::renderer::Renderers;
use clench::SaveModel;
use clench::rigid::model::{Integrator, ParamField};
use numpy::PyArray1;
use pyo3::exceptions::{PyKeyError, PyTypeError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::collections::HashMap;
use std::ffi::CString;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

/// A model: the constant data that its simulations share.
///
/// Its numbers and structure are attributes with MuJoCo's names, such as `body_mass`, `jnt_range` or `geom_bodyid`, as
/// read-only arrays; ``dir(model)`` lists all. Types are MuJoCo's integer codes, and the index -1 stands for no
/// element. Units are SI.
///
/// Examples
/// --------
/// >>> model = clench.Model.from_file("models/humanoid.xml")
/// >>> model.nv, model.body("torso").mass, model.geom_size.shape
/// (27, 14.357497305925833, (19, 3))
#[pyclass(frozen, module = "clench")]
pub(crate) struct Model(Arc<clench::Model>, Option<Source>, Mutex<Renderers>);

/// The source of a model and the arguments of its loading, which pickles store.
struct Source {
    /// The static method that loaded the model.
    method: &'static str,
    /// The arguments of the method.
    arguments: Py<PyDict>,
}

impl Model {
    /// Wraps a model, after a warning about omitted elements.
    fn with_warning(py: Python<'_>, model: clench::Model, source: Source) -> PyResult<Self> {
        if !model.omitted.is_empty() {
            let category = py.get_type::<PyUserWarning>();
            let message = format!("omitted from the model:\n{}", model.omitted.join("\n"));
            let message = CString::new(message.replace('\0', " "))?;
            PyErr::warn(py, &category, &message, 1)?;
        }
        Ok(Model(Arc::new(model), Some(source), Mutex::default()))
    }

    /// Wraps the common layout of several models.
    pub(crate) fn layout(model: &Arc<clench::Model>) -> Self {
        Model(Arc::clone(model), None, Mutex::default())
    }

    /// Returns the model itself.
    pub(crate) fn inner(&self) -> &Arc<clench::Model> {
        &self.0
    }

    /// Returns its renderers.
    #[cfg_attr(not(feature = "render"), expect(dead_code, reason = "nothing draws"))]
    pub(crate) fn renderers(&self) -> &Mutex<Renderers> {
        &self.2
    }

    /// Returns the shape of the parameter with this name.
    pub(crate) fn param_shape(&self, field: &str) -> PyResult<Vec<usize>> {
        let field = ParamField::find(field).map_err(sim_error)?;
        Ok(field.shape(&self.0))
    }
}

#[pymethods]
impl Model {
    /// Loads a model from an MJCF or URDF file.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The file; its root element determines the format. Included files are found relative to its folder.
    /// budget : float
    ///     Factor on the default limits of memory and work, for loading and for each step. The defaults are 2 GiB, 500
    ///     000 elements, 250 000 contacts, 2**25 numbers in a matrix, 2 000 000 steps to find length ranges.
    /// package_path : sequence of str or os.PathLike
    ///     Folders with packages, for mesh names in URDF files (``package://NAME/...``). The folder of the file and its
    ///     parent folders are searched after them.
    /// max_dynamic_constraints : int
    ///     Maximum number of simultaneous constraints that are added at run time (`Sim.add_weld`).
    /// floating : bool
    ///     True to free the base of a URDF robot: the one link that is attached to the world gets a free joint,
    ///     ``floating_base``.
    /// ignore_unsupported : bool
    ///     True to omit unsupported parts of an MJCF model if the rest keeps its meaning: plugins, deformable bodies,
    ///     sensors, forces and flags, but no joint, tendon or actuator. A warning and :attr:`omitted` list them.
    ///
    /// Returns
    /// -------
    /// Model
    ///
    /// Raises
    /// ------
    /// LoadError
    ///     If the file cannot be read, is not well-formed, requests something impossible, or exceeds the budget.
    #[staticmethod]
    #[pyo3(signature = (path, *, budget = 1.0, package_path = Vec::new(), floating = false, ignore_unsupported = false,
                        max_dynamic_constraints = Count(8)),
           text_signature = "(path, *, budget=1.0, package_path=(), floating=False, ignore_unsupported=False, max_dynamic_constraints=8)")]
    fn from_file(
        py: Python<'_>,
        path: PathBuf,
        budget: f64,
        package_path: Vec<PathBuf>,
        floating: bool,
        ignore_unsupported: bool,
        max_dynamic_constraints: Count,
    ) -> PyResult<Self> {
        let arguments = PyDict::new(py);
        // A path without an absolute form cannot be read either; the loader reports that.
        let absolute = std::path::absolute(&path);
        arguments.set_item("path", absolute.as_ref().unwrap_or(&path))?;
        arguments.set_item("budget", budget)?;
        arguments.set_item("package_path", &package_path)?;
        arguments.set_item("floating", floating)?;
        arguments.set_item("ignore_unsupported", ignore_unsupported)?;
        arguments.set_item("max_dynamic_constraints", max_dynamic_constraints.0)?;
        let source = Source {
            method: "from_file",
            arguments: arguments.unbind(),
        };
        let loader = clench::Loader::new()
            .budget(clench::Budget::default().times(budget))
            .package_path(package_path)
            .floating(floating)
            .ignore_unsupported(ignore_unsupported);
        let mut model = py.detach(|| loader.load(&path)).map_err(load_error)?;
        model.max_dynamic_constraints = max_dynamic_constraints.0;
        Model::with_warning(py, model, source)
    }

    /// Loads a model from the text of an MJCF or URDF file.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     The contents of the file. Included files are found relative to the working directory.
    /// budget : float
    ///     As for :meth:`from_file`.
    /// max_dynamic_constraints : int
    ///     As for :meth:`from_file`.
    /// floating : bool
    ///     As for :meth:`from_file`.
    /// ignore_unsupported : bool
    ///     As for :meth:`from_file`.
    /// assets : dict of str to bytes
    ///     Files in memory that the text names: meshes, height fields, included and attached models. Folders and letter
    ///     case of the names are ignored.
    ///
    /// Returns
    /// -------
    /// Model
    ///
    /// Raises
    /// ------
    /// LoadError
    ///     If the text is not well-formed, requests something impossible, or exceeds the budget.
    #[staticmethod]
    #[pyo3(signature = (text, *, budget = 1.0, floating = false, ignore_unsupported = false, assets = HashMap::new(), max_dynamic_constraints = Count(8)),
           text_signature = "(text, *, budget=1.0, floating=False, ignore_unsupported=False, assets={}, max_dynamic_constraints=8)")]
    fn from_xml(
        py: Python<'_>,
        text: &str,
        budget: f64,
        floating: bool,
        ignore_unsupported: bool,
        assets: HashMap<String, Vec<u8>>,
        max_dynamic_constraints: Count,
    ) -> PyResult<Self> {
        let arguments = PyDict::new(py);
        arguments.set_item("text", text)?;
        arguments.set_item("budget", budget)?;
        arguments.set_item("floating", floating)?;
        arguments.set_item("ignore_unsupported", ignore_unsupported)?;
        let files = PyDict::new(py);
        for (name, data) in &assets {
            files.set_item(name, PyBytes::new(py, data))?;
        }
        arguments.set_item("assets", files)?;
        arguments.set_item("max_dynamic_constraints", max_dynamic_constraints.0)?;
        let source = Source {
            method: "from_xml",
            arguments: arguments.unbind(),
        };
        let loader = clench::Loader::new()
            .budget(clench::Budget::default().times(budget))
            .floating(floating)
            .ignore_unsupported(ignore_unsupported)
            .assets(assets);
        let mut model = py.detach(|| loader.load_str(text)).map_err(load_error)?;
        model.max_dynamic_constraints = max_dynamic_constraints.0;
        Model::with_warning(py, model, source)
    }

    /// Rejects an invalid text, but not an incomplete one: nothing is built, and names may be undefined.
    #[staticmethod]
    fn _check(py: Python<'_>, text: &str, assets: HashMap<String, Vec<u8>>) -> PyResult<()> {
        let loader = clench::Loader::new().assets(assets);
        match py.detach(|| loader.read_str(text)) {
            Ok(_) => Ok(()),
            Err(error) if error.incomplete => Ok(()),
            Err(error) => Err(load_error(error)),
        }
    }

    /// Converts text that MuJoCo's parser accepts to strict XML with the same line numbers.
    #[staticmethod]
    fn _strict_xml(text: &str) -> String {
        clench::formats::strict_xml(text)
    }

    /// Returns the model as a self-contained MJCF file.
    ///
    /// Every number is resolved: inertials, limits and poses are explicit, angles are in radians, meshes and height
    /// fields are in the file. It loads to the same model, here and in MuJoCo; values computed during loading may
    /// differ in the last digits.
    ///
    /// Returns
    /// -------
    /// str
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If MJCF cannot express something, such as a floor of time constants that acts.
    ///
    /// Examples
    /// --------
    /// >>> robot = clench.Model.from_file("models/gripper/gripper.urdf")
    /// >>> clench.Model.from_xml(robot.to_xml()).nv
    /// 3
    fn to_xml(&self) -> PyResult<String> {
        let text = self.0.to_mjcf();
        text.map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// Returns the data of a pickle: how the model was loaded, and a checksum of the result.
    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = this.py();
        let Some(Source { method, arguments }) = &this.get().1 else {
            return Err(PyTypeError::new_err(
                "the common layout of several models cannot be pickled: pickle the batch or its models",
            ));
        };
        let module = py.import("clench._pickle")?;
        module
            .getattr("reduce_model")?
            .call1((this, method, arguments))
    }

    /// Returns the model itself, since it never changes.
    fn __copy__(this: Py<Self>) -> Py<Self> {
        this
    }
    /// Returns the model itself, since it never changes.
    #[pyo3(signature = (_memo, /))]
    fn __deepcopy__(this: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        this
    }

    /// str : Name of the model.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }
    /// list of str : Remarks of the loader, such as a solver that it replaced.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.0.notes.clone()
    }
    /// list of str : Omitted unsupported parts, each with its location in the file.
    #[getter]
    fn omitted(&self) -> Vec<String> {
        self.0.omitted.clone()
    }
    /// Returns the user's array of numbers with this name (MJCF's ``custom/numeric``).
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///
    /// Raises
    /// ------
    /// KeyError
    ///     If the model does not have the name.
    fn numeric<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let found = self
            .0
            .numeric(name)
            .ok_or_else(|| unknown("numeric", name))?;
        Ok(PyArray1::from_slice(py, found))
    }
    /// Returns the user's text with this name (MJCF's ``custom/text``).
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///
    /// Returns
    /// -------
    /// str
    ///
    /// Raises
    /// ------
    /// KeyError
    ///     If the model does not have the name.
    fn text(&self, name: &str) -> PyResult<&str> {
        self.0.text(name).ok_or_else(|| unknown("text", name))
    }
    /// Returns the user's list of elements with this name (MJCF's ``custom/tuple``).
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///
    /// Returns
    /// -------
    /// list of tuple
    ///     For each element its kind with MJCF's name, its name, and its number.
    ///
    /// Raises
    /// ------
    /// KeyError
    ///     If the model does not have the name.
    fn custom_tuple(&self, name: &str) -> PyResult<Vec<(&str, &str, f64)>> {
        let found = self.0.tuple(name).ok_or_else(|| unknown("tuple", name))?;
        let entries = found.iter();
        Ok(entries
            .map(|e| (e.kind.as_str(), e.name.as_str(), e.value))
            .collect())
    }
    /// RigidOptions : The options that the file sets, over the defaults of its format.
    #[getter]
    fn options(&self) -> RigidOptions {
        RigidOptions(self.0.options)
    }
    /// str : The integrator: "Euler", "implicitfast", "implicit", "discrete" or "RK4".
    #[getter]
    fn integrator(&self) -> &'static str {
        match self.0.integrator {
            Integrator::Euler => "Euler",
            Integrator::ImplicitFast => "implicitfast",
            Integrator::Implicit => "implicit",
            Integrator::Rk4 => "RK4",
            Integrator::Discrete => "discrete",
        }
    }

    fn __getattr__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        match fields::find(&self.0, name) {
            Some(field) => field.show(py),
            None => Err(no_attribute(
                "Model",
                name,
                &Vec::from_iter(fields::names()),
            )),
        }
    }

    fn __dir__(slf: &Bound<'_, Self>) -> PyResult<Vec<String>> {
        let mut names: Vec<String> = slf.get_type().dir()?.extract()?;
        names.extend(fields::names().map(str::to_owned));
        Ok(names)
    }

    fn __repr__(&self) -> String {
        let m = &self.0;
        format!(
            "<clench.Model \"{}\": nbody={}, njnt={}, ngeom={}, nq={}, nv={}, nu={}>",
            m.name,
            m.nbody(),
            m.joints.len(),
            m.geoms.len(),
            m.nq,
            m.nv,
            m.nu()
        )
    }
}

/// Returns the error that the model does not have this name among the user's data.
fn unknown(kind: &str, name: &str) -> PyErr {
    PyKeyError::new_err(format!("the model has no {kind} \"{name}\""))
}
