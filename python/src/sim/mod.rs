//! `clench.Sim`.

mod dynamic;
mod parameters;
mod queries;

use crate::busy::{in_portions, lock};
use crate::count::Count;
use crate::differentiated::Memory;
use crate::error::sim_error;
use crate::kind::Kind;
use crate::model::Model;
use crate::names::no_attribute;
use crate::options::RigidOptions;
use crate::precision::Bits;
use crate::row_sim::{AnySim, each_sim};
use crate::state_views::StateViews;
use crate::stats::SolverStats;
use crate::view::{Keeper, read_only};
use clench::Output;
use clench::math::Scalar;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PySlice;
use std::sync::{Arc, Mutex};

/// Returns the range of a sensor's values in `sensordata`.
pub(crate) fn sensor_numbers<'py>(
    py: Python<'py>,
    model: &clench::Model,
    which: &Bound<'_, PyAny>,
) -> PyResult<Bound<'py, PySlice>> {
    let numbers = &model.sensors[Kind::Sensor.find(model, which)?].numbers;
    Ok(PySlice::new(
        py,
        numbers.start as isize,
        numbers.end as isize,
        1,
    ))
}

/// A simulation of a model: one environment.
///
/// State arrays (``qpos``, ``qvel``, ``ctrl``, ...) are live: write them between steps. Derived quantities are read as
/// copies: outputs by name, such as ``sim.xpos`` (see `clench.OUTPUTS`), `contacts`, `constraints`, and the results of
/// `ray`, `distance` and `mass_matrix`. After a step they are, as in MuJoCo, those of the step's start. Before the
/// first step, or if positions, velocities, mocap poses or parameters were written since, they are computed from the
/// current state on demand. New controls and applied forces take effect at the next step or `forward`.
///
/// Parameters
/// ----------
/// model : Model
///     The model.
/// options : RigidOptions, optional
///     Options that take precedence over those of the model.
/// precision : {"64", "32"}
///     Bits of every number.
/// threads : int
///     Number of threads that share the work of each step; see `threads`.
///
/// Raises
/// ------
/// ValueError
///     If an option or the number of threads is out of range, or shapes that can collide have no collision function.
#[pyclass(frozen, extends = StateViews, module = "clench")]
pub(crate) struct Sim {
    inner: Arc<Mutex<AnySim>>,
    model: Py<Model>,
    /// The model with the slots for stick references that the options require.
    layout: Arc<clench::Model>,
    precision: Bits,
    /// The memory of derivatives, created on demand.
    linearizer: Mutex<Memory>,
}

impl Sim {
    /// Returns the simulation itself, which other threads may use.
    pub(crate) fn inner(&self) -> &Mutex<AnySim> {
        &self.inner
    }

    /// Returns a shared reference to the simulation.
    pub(crate) fn shared(&self) -> &Arc<Mutex<AnySim>> {
        &self.inner
    }

    /// Returns the memory of derivatives.
    pub(crate) fn linearizer(&self) -> &Mutex<Memory> {
        &self.linearizer
    }

    /// Returns the Python object of the model.
    pub(crate) fn py_model(&self) -> &Py<Model> {
        &self.model
    }

    /// Returns the model, without the parameters that are set in this simulation.
    pub(crate) fn described(&self) -> &Arc<clench::Model> {
        &self.layout
    }

    /// Creates the Python object of a simulation.
    pub(crate) fn wrap(
        py: Python<'_>,
        sim: AnySim,
        model: Py<Model>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let precision = sim.precision();
        let inner = Arc::new(Mutex::new(sim));
        let keeper = Keeper::new(py, inner.clone())?;
        let (views, layout) = {
            let mut guard = lock(&inner, "simulation")?;
            each_sim!(&mut *guard, own => {
                let views = StateViews::new(&keeper, &mut own.rows, true)?;
                (views, Arc::clone(own.sim.model()))
            })
        };
        Ok(PyClassInitializer::from(views).add_subclass(Sim {
            inner,
            model,
            layout,
            precision,
            linearizer: Mutex::default(),
        }))
    }
}

#[pymethods]
impl Sim {
    #[new]
    #[pyo3(signature = (model, options = None, *, precision = Bits::B64, threads = Count(1)),
           text_signature = "(model, options=None, *, precision='64', threads=1)")]
    fn new(
        model: &Bound<'_, Model>,
        options: Option<&RigidOptions>,
        precision: Bits,
        threads: Count,
    ) -> PyResult<PyClassInitializer<Self>> {
        let options = options.copied().unwrap_or_default();
        let (py, own) = (model.py(), model.clone().unbind());
        let (inner, given) = (Arc::clone(model.get().inner()), options.0);
        let sim = match precision {
            Bits::B64 => clench::Sim::with_options(inner, given).and_then(AnySim::f64),
            Bits::B32 => clench::Sim::with_options(inner, given).and_then(AnySim::f32),
        };
        let mut sim = sim.map_err(sim_error)?;
        each_sim!(&mut sim, own => own.sim.set_threads(threads.0)).map_err(sim_error)?;
        Sim::wrap(py, sim, own)
    }

    /// Advances the simulation.
    ///
    /// Other Python threads run meanwhile.
    ///
    /// Parameters
    /// ----------
    /// n : int
    ///     Number of time steps, with the same controls and applied forces except for changes by `control`.
    /// control : callable, optional
    ///     A function that is called in each step with this simulation, after the quantities that depend on positions
    ///     and velocities are computed, and before forces are: it writes `ctrl` or applied forces. Its return value is
    ///     ignored; an exception ends the call.
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     If the state is not finite, the motion diverges (also if positions, velocities or accelerations exceed
    ///     1e10), or the mass matrix is singular. The state is then that before the failed step. With the option
    ///     `autoreset`, the step is done from the initial state instead, which includes controls and applied forces,
    ///     and counts in `resets`.
    /// BusyError
    ///     While another thread is in a call of this simulation.
    #[pyo3(signature = (n = Count(1), control = None), text_signature = "($self, n=1, control=None)")]
    fn step(this: &Bound<'_, Self>, n: Count, control: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let (own, py) = (this.get(), this.py());
        if let Some(control) = control {
            return (0..n.0).try_for_each(|_| {
                own.step1(py)?;
                control.call1((this,))?;
                py.check_signals()?;
                own.step2(py)
            });
        }
        let mut guard = lock(&own.inner, "simulation")?;
        let any = &mut *guard;
        in_portions(py, n.0, |steps| {
            each_sim!(any, own => own.step(steps)).map_err(sim_error)
        })
    }

    /// Does the first half of a step: computes all quantities that depend only on positions and velocities, which can
    /// then be read; like ``mj_step1``.
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     As for `step`.
    fn step1(&self, py: Python<'_>) -> PyResult<()> {
        let mut guard = lock(&self.inner, "simulation")?;
        let any = &mut *guard;
        py.detach(|| each_sim!(any, own => own.step1()))
            .map_err(sim_error)
    }

    /// Does the second half of a step, with the current controls and applied forces; like ``mj_step2``, but with any
    /// integrator.
    ///
    /// After `step1`, the two halves equal a `step`, to the bit. If anything else was written in between, or `step1`
    /// was not called, it does the whole step.
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     As for `step`.
    fn step2(&self, py: Python<'_>) -> PyResult<()> {
        let mut guard = lock(&self.inner, "simulation")?;
        let any = &mut *guard;
        py.detach(|| each_sim!(any, own => own.step2()))
            .map_err(sim_error)
    }

    /// Computes everything that depends on the state, and does not change the state.
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     As for `step`.
    fn forward(&self, py: Python<'_>) -> PyResult<()> {
        let mut guard = lock(&self.inner, "simulation")?;
        let any = &mut *guard;
        py.detach(|| each_sim!(any, own => own.current()?.forward()))
            .map_err(sim_error)
    }

    /// Resets the simulation to the initial state or to a keyframe.
    ///
    /// Parameters
    /// ----------
    /// keyframe : str or int, optional
    ///     A keyframe of the model, by name or index. Quantities that it does not store are as in the initial state.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the model does not have the keyframe.
    /// IndexError
    ///     If the index is negative or too large.
    #[pyo3(signature = (keyframe = None))]
    fn reset(&self, keyframe: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let find = |which| Kind::Keyframe.find(self.model.get().inner(), which);
        let key = keyframe.map(find).transpose()?;
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => own.reset(key)).map_err(sim_error)
    }

    /// Returns an output of the last step or forward, or of the state.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     The name of the output; see `clench.OUTPUTS`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray or float
    ///     A read-only copy.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no output has the name.
    fn output<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let output = Output::find(name).map_err(sim_error)?;
        let shape = output.shape(self.model.get().inner());
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => {
            let values = own.current().and_then(|sim| sim.output(name)).map_err(sim_error)?;
            if shape.is_empty() {
                return Ok(values[0].to_f64().into_pyobject(py)?.into_any());
            }
            let array = PyArray1::from_vec(py, values).reshape(shape)?;
            Ok(read_only(array)?.into_any())
        })
    }

    /// Returns the values of one sensor: its part of `sensordata`.
    ///
    /// Parameters
    /// ----------
    /// which : str or int
    ///     The name or index of the sensor.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     A read-only copy.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no sensor has the name.
    /// IndexError
    ///     If the index is negative or too large.
    fn sensor<'py>(
        &self,
        py: Python<'py>,
        which: &Bound<'_, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let numbers = sensor_numbers(py, self.model.get().inner(), which)?;
        self.output(py, "sensordata")?.get_item(numbers)
    }

    fn __getattr__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        if Output::find(name).is_err() {
            let known = Vec::from_iter(Output::ALL.iter().map(|output| output.name()));
            return Err(no_attribute("Sim", name, &known));
        }
        self.output(py, name)
    }

    fn __dir__(this: &Bound<'_, Self>) -> PyResult<Vec<String>> {
        let mut names: Vec<String> = this.get_type().dir()?.extract()?;
        names.extend(Output::ALL.iter().map(|output| output.name().to_owned()));
        Ok(names)
    }

    /// SolverStats : Statistics of the last solve; with the Runge-Kutta integrator, of the last stage.
    #[getter]
    fn solver_stats(&self) -> PyResult<SolverStats> {
        let guard = lock(&self.inner, "simulation")?;
        Ok(each_sim!(&*guard, own => own.sim.stats()).into())
    }

    /// int : Number of steps that restarted from the initial state, with the option `autoreset`.
    #[getter]
    fn resets(&self) -> PyResult<u64> {
        let guard = lock(&self.inner, "simulation")?;
        Ok(each_sim!(&*guard, own => own.sim.resets()))
    }

    /// bool : True if the last step or forward found more contacts than `max_contacts` allows, and dropped some.
    #[getter]
    fn contact_overflow(&self) -> PyResult<bool> {
        let guard = lock(&self.inner, "simulation")?;
        Ok(each_sim!(&*guard, own => own.sim.contact_overflow()))
    }

    /// Switches an equality constraint on or off.
    ///
    /// Parameters
    /// ----------
    /// which : str or int
    ///     The equality, by name or index.
    /// active : bool
    ///     True to make it active. `eq_active` shows all switches.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the model does not have the name.
    /// IndexError
    ///     If the index is negative or too large.
    fn set_equality(
        this: &Bound<'_, Self>,
        which: &Bound<'_, PyAny>,
        active: bool,
    ) -> PyResult<()> {
        let index = Kind::Equality.find(this.get().model.get().inner(), which)?;
        this.getattr("eq_active")?.set_item(index, active)
    }

    /// State : A copy of everything that the next step depends on, except parameters.
    ///
    /// Assigning a state restores it, to the bit.
    #[getter]
    fn state<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let _guard = lock(&this.get().inner, "simulation")?;
        this.as_super().get().copy(this.py())
    }

    #[setter]
    fn set_state(this: &Bound<'_, Self>, state: &Bound<'_, PyAny>) -> PyResult<()> {
        let _guard = lock(&this.get().inner, "simulation")?;
        this.as_super().get().assign_from(state)
    }

    /// Model : The model.
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<Model> {
        self.model.clone_ref(py)
    }

    /// RigidOptions : The options that were set. Assigned options take effect at the next step or forward.
    #[getter]
    fn options(&self) -> PyResult<RigidOptions> {
        let guard = lock(&self.inner, "simulation")?;
        Ok(RigidOptions(each_sim!(&*guard, own => own.sim.options())))
    }

    #[setter]
    fn set_options(&self, options: &RigidOptions) -> PyResult<()> {
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => own.sim.set_options(options.0)).map_err(sim_error)
    }

    /// int : Number of threads that share the work of each step and forward pass, 1 to 1024. Results do not depend on
    /// it. More threads help for scenes of many bodies, whose steps take a millisecond or more; use `Batch` for many
    /// environments.
    #[getter]
    fn threads(&self) -> PyResult<usize> {
        let guard = lock(&self.inner, "simulation")?;
        Ok(each_sim!(&*guard, own => own.sim.threads()))
    }

    #[setter]
    fn set_threads(&self, threads: Count) -> PyResult<()> {
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => own.sim.set_threads(threads.0)).map_err(sim_error)
    }

    /// str : Bits of every number, "64" or "32".
    #[getter]
    fn precision(&self) -> &'static str {
        self.precision.name()
    }

    fn __repr__(&self) -> String {
        let name = &self.model.get().inner().name;
        format!("<clench.Sim of {name:?}, {} bits>", self.precision.name())
    }
}
