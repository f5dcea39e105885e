//! `clench.Batch`.

use crate::arrays::mask;
use crate::batch_models::Models;
use crate::busy::lock;
use crate::count::{Count, Index, check_env};
use crate::device::Device;
use crate::differentiated::BatchMemory;
use crate::error::sim_error;
use crate::model::Model;
use crate::names::{Names, no_attribute};
use crate::options::RigidOptions;
use crate::precision::Bits;
use crate::recorded::{Recorded, not_recorded};
use crate::row_sim::AnySim;
use crate::sim::Sim;
use crate::state_views::StateViews;
use crate::view::Keeper;
use clench::math::Instructions;
use clench::{BatchOptions, Output};
use pyo3::exceptions::{PyAttributeError, PyRuntimeWarning};
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::ffi::CString;
use std::sync::{Arc, Mutex};

/// A batch in either precision.
pub(crate) enum AnyBatch {
    F64(clench::Batch<f64>),
    F32(clench::Batch<f32>),
}

/// Evaluates an expression about a batch of either precision.
macro_rules! each {
    ($any:expr, $batch:ident => $value:expr) => {
        match $any {
            AnyBatch::F64($batch) => $value,
            AnyBatch::F32($batch) => $value,
        }
    };
}
pub(crate) use each;

mod dynamic;
mod models;
mod outputs;
mod parameters;
mod queries;
mod run;
mod status;

/// Many environments of one model or of several, stepped in parallel on all CPU cores.
///
/// Environment i moves exactly as a single `Sim` would in the same precision, to the bit. An environment that fails
/// keeps its last good state and reports the reason in `status` and `fault`; the others are not affected.
///
/// State arrays (``qpos``, ``qvel``, ``ctrl``, ...) have the environments as their first axis. They are live: they
/// share memory with the simulation. Recorded outputs are live too, and can be read by name: ``batch.cvel``.
///
/// Parameters
/// ----------
/// model : Model or sequence of Model
///     The model of all environments, or several models. These have the same bodies, joints, sites, cameras, tendons,
///     actuators, sensors and constraints, and the same names of joints, actuators and sensors; geoms, meshes, height
///     fields and all numbers may differ. `Batch.model` is then their common layout, see `geoms_of`.
/// n_envs : int
///     Number of environments.
/// precision : {"64", "32"}, optional
///     Bits of every number; by default "64" on the CPU and "32" on a GPU.
/// threads : int, optional
///     Number of threads; by default the number of CPU cores. Results do not depend on it.
/// options : RigidOptions, optional
///     Options that take precedence over those of the model.
/// record : sequence of str
///     Outputs to record; see `record`.
/// device : str
///     The device that steps: "cpu"; "gpu", the first GPU of this machine; or "gpu:" and a part of a name that
///     `devices` lists. A GPU computes the recorded outputs; many GPUs have slow double precision or none. Arrays are
///     copied to it before a call, and the states back after it; options do not change. The CPU computes queries, such
///     as Jacobians.
/// env_model : array_like of int, optional
///     The model of each environment (n), an index; by default environment i has model ``i % len(model)``.
///
/// Raises
/// ------
/// RuntimeError
///     If there is no GPU, or it cannot be used.
/// ValueError
///     If the GPU cannot step the model yet or has no double precision, an option is out of range, shapes that can
///     collide have no collision function, no output has a name, or models differ in more than geoms and numbers. Of
///     several models, if a GPU or the option `stiction` is wanted.
/// MemoryError
///     If memory is insufficient for the environments.
#[pyclass(frozen, extends = StateViews, module = "clench")]
pub(crate) struct Batch {
    inner: Arc<Mutex<AnyBatch>>,
    keeper: Py<Keeper>,
    recorded: Recorded,
    /// The model, or the common layout of several.
    model: Py<Model>,
    models: Vec<Py<Model>>,
    /// The same with the slots for stick references that the options require.
    layout: Arc<clench::Model>,
    n_envs: usize,
    precision: Bits,
    device: String,
    threads: usize,
    lanes: usize,
    /// The memory of derivatives, created on demand.
    linearizer: Mutex<BatchMemory>,
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (model, n_envs, precision = None, threads = None, *, options = None, record = Names(Vec::new()), device = Device::Processor, env_model = None),
           text_signature = "(model, n_envs, precision=None, threads=None, *, options=None, record=(), device='cpu', env_model=None)")]
    #[allow(clippy::too_many_arguments)] // They are keywords.
    fn new(
        model: &Bound<'_, PyAny>,
        n_envs: Count,
        precision: Option<Bits>,
        threads: Option<Count>,
        options: Option<&RigidOptions>,
        record: Names,
        device: Device,
        env_model: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let py = model.py();
        if let (Device::Processor, Some(advice)) = (&device, Instructions::advice()) {
            let category = py.get_type::<PyRuntimeWarning>();
            let advice = CString::new(advice)?;
            PyErr::warn(py, &category, &advice, 1)?;
        }
        let options = options.copied().unwrap_or_default();
        let own = BatchOptions {
            options: options.0,
            threads: threads.map(|count| count.0),
            ..BatchOptions::default()
        };
        let models = Models::of(model, n_envs.0, env_model)?;
        let precision = precision.unwrap_or(match device {
            Device::Processor => Bits::B64,
            Device::Graphics { .. } => Bits::B32,
        });
        let inner = py.detach(|| match precision {
            Bits::B64 => models.batch(device, own).map(AnyBatch::F64),
            Bits::B32 => models.batch(device, own).map(AnyBatch::F32),
        });
        let inner = Arc::new(Mutex::new(inner?));
        let keeper = Keeper::new(py, inner.clone())?;
        let batch = {
            let mut guard = lock(&inner, "batch")?;
            each!(&mut *guard, batch => {
                let views = StateViews::new(&keeper, &mut batch.state, false)?;
                let device = batch.device().map_or_else(|| "cpu".to_owned(), |name| format!("gpu:{name}"));
                (views, device, batch.threads(), batch.lanes(), Arc::clone(batch.model()))
            })
        };
        let (views, device, threads, lanes, layout) = batch;
        let batch = Batch {
            inner,
            keeper: keeper.unbind(),
            recorded: Recorded::default(),
            model: models.layout(py, &layout)?,
            models: models.objects,
            layout,
            n_envs: n_envs.0,
            precision,
            device,
            threads,
            lanes,
            linearizer: Mutex::default(),
        };
        batch.record_outputs(py, &record.0)?;
        Ok(PyClassInitializer::from(views).add_subclass(batch))
    }

    fn __getattr__(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        let Ok(output) = Output::find(name) else {
            let names = Vec::from_iter(Output::ALL.iter().map(|output| output.name()));
            return Err(no_attribute("Batch", name, &names));
        };
        let view = self.current_view(py, output)?;
        view.ok_or_else(|| PyAttributeError::new_err(not_recorded(name)))
    }

    fn __dir__(this: &Bound<'_, Self>) -> PyResult<Vec<String>> {
        let mut names: Vec<String> = this.get_type().dir()?.extract()?;
        let outputs = this.get().recorded.outputs()?;
        names.extend(outputs.iter().map(|output| output.name().to_owned()));
        Ok(names)
    }

    /// Returns a simulation of one environment, with its state and parameters.
    ///
    /// Parameters
    /// ----------
    /// env : int
    ///     The index of the environment.
    ///
    /// Returns
    /// -------
    /// Sim
    ///     A separate simulation: no memory is shared.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If there is no such environment.
    fn sim<'py>(&self, py: Python<'py>, env: &Bound<'py, PyAny>) -> PyResult<Bound<'py, Sim>> {
        let env = self.env(env)?;
        let guard = lock(&self.inner, "batch")?;
        let model = self.model_of(&guard, env).clone_ref(py);
        let sim = match &*guard {
            AnyBatch::F64(batch) => batch.sim(env).and_then(AnySim::f64),
            AnyBatch::F32(batch) => batch.sim(env).and_then(AnySim::f32),
        };
        Bound::new(py, Sim::wrap(py, sim.map_err(sim_error)?, model)?)
    }

    /// State : A copy of everything that the next step of every environment depends on, except parameters.
    ///
    /// Assigning a state restores all environments, to the bit, and sets all of them running. The state of a `Sim`, or
    /// of one environment (``batch.state[env]``), is copied to all.
    #[getter]
    fn state<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let _guard = lock(&this.get().inner, "batch")?;
        this.as_super().get().copy(this.py())
    }

    #[setter]
    fn set_state(this: &Bound<'_, Self>, state: &Bound<'_, PyAny>) -> PyResult<()> {
        let own = this.get();
        let mut guard = lock(&own.inner, "batch")?;
        this.as_super().get().assign_from(state)?;
        let mut envs = 0..own.n_envs;
        each!(&mut *guard, batch => envs.try_for_each(|env| batch.revive(env))).map_err(sim_error)
    }

    /// Sets the state of some environments, and sets them running.
    ///
    /// Parameters
    /// ----------
    /// state : State
    ///     A single state for all of them, such as ``sim.state``, or one with as many environments as there are in
    ///     `envs`.
    /// envs : array_like of int, optional
    ///     Indices of environments; by default all.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If an environment does not exist.
    /// ValueError
    ///     If the state is of another model or of another number of environments. The states do not change then.
    #[pyo3(name = "set_state", signature = (state, envs = None))]
    fn bring_to(
        this: &Bound<'_, Self>,
        state: &Bound<'_, PyAny>,
        envs: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        if envs.is_none() {
            return Self::set_state(this, state);
        }
        let own = this.get();
        let envs = own.chosen(envs)?;
        let mut guard = lock(&own.inner, "batch")?;
        let rows = PyList::new(this.py(), &envs)?;
        let rows = Some((rows.as_any(), envs.len()));
        this.as_super().get().assign_rows_from(state, rows)?;
        let mut envs = envs.into_iter();
        each!(&mut *guard, batch => envs.try_for_each(|env| batch.revive(env))).map_err(sim_error)
    }

    /// Model : The model, without the parameters that are set per environment. Of several models it is the common
    /// layout: on each body, in order, the geoms that any model needs there, with the numbers of the first model.
    /// Arrays over geoms, such as outputs and parameters, are in this layout; `geoms_of` returns the geoms of one
    /// model. A geom whose type differs between models is several of the layout, so that its name is an error.
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<Model> {
        self.model.clone_ref(py)
    }

    /// RigidOptions : The options that were set. Assigned options take effect at the next step or forward.
    #[getter]
    fn options(&self) -> PyResult<RigidOptions> {
        let guard = lock(&self.inner, "batch")?;
        Ok(RigidOptions(
            each!(&*guard, batch => batch.options().options),
        ))
    }

    #[setter]
    fn set_options(&self, options: &RigidOptions) -> PyResult<()> {
        let mut guard = lock(&self.inner, "batch")?;
        each!(&mut *guard, batch => batch.set_options(options.0)).map_err(sim_error)
    }

    /// int : Number of environments.
    #[getter]
    fn n_envs(&self) -> usize {
        self.n_envs
    }

    /// str : Bits of every number, "64" or "32".
    #[getter]
    fn precision(&self) -> &'static str {
        self.precision.name()
    }

    /// str : The device that steps: "cpu", or "gpu:" and the name of the GPU.
    #[getter]
    fn device(&self) -> &str {
        &self.device
    }

    /// int : Number of threads.
    #[getter]
    pub(crate) fn threads(&self) -> usize {
        self.threads
    }

    /// int : Number of environments that a thread steps side by side.
    #[getter]
    fn lanes(&self) -> usize {
        self.lanes
    }

    /// int : Memory per environment in bytes: its state, its own parameters and recorded outputs.
    #[getter]
    fn bytes_per_env(&self) -> PyResult<usize> {
        let guard = lock(&self.inner, "batch")?;
        Ok(each!(&*guard, batch => batch.bytes_per_env()))
    }

    fn __len__(&self) -> usize {
        self.n_envs
    }

    fn __repr__(&self) -> String {
        let name = &self.model.get().inner().name;
        let execution = match self.device() {
            "cpu" => format!("{} lanes, {} threads", self.lanes, self.threads),
            device => format!("on {device}"),
        };
        let (count, bits) = (self.n_envs, self.precision.name());
        format!("<clench.Batch of {count} x {name:?}, {bits} bits, {execution}>")
    }
}

impl Batch {
    /// Returns the batch itself, which other threads may use.
    pub(crate) fn inner(&self) -> &Mutex<AnyBatch> {
        &self.inner
    }

    /// Returns the memory of derivatives.
    pub(crate) fn linearizer(&self) -> &Mutex<BatchMemory> {
        &self.linearizer
    }

    /// Returns a shared reference to the batch.
    pub(crate) fn shared(&self) -> &Arc<Mutex<AnyBatch>> {
        &self.inner
    }

    /// Returns the model, without the parameters that are set per environment.
    pub(crate) fn described(&self) -> &Arc<clench::Model> {
        &self.layout
    }

    /// Returns the number of environments.
    pub(crate) fn count(&self) -> usize {
        self.n_envs
    }

    /// Returns the view of an output if it is recorded, up to date unless another thread is stepping this batch.
    fn current_view(&self, py: Python<'_>, output: Output) -> PyResult<Option<Py<PyAny>>> {
        let view = self.recorded.get(py, output)?;
        if view.is_some()
            && let Ok(mut guard) = lock(&self.inner, "batch")
        {
            let any = &mut *guard;
            let done = py.detach(|| each!(any, batch => batch.refresh()));
            done.map_err(sim_error)?;
        }
        Ok(view)
    }

    /// Converts an index to that of an environment.
    pub(crate) fn env(&self, index: &Bound<'_, PyAny>) -> PyResult<usize> {
        let Index(env) = index.extract()?;
        check_env(env, self.n_envs)?;
        Ok(env)
    }

    /// Converts a mask; by default it covers all environments.
    fn mask(&self, given: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<bool>> {
        given.map_or_else(
            || Ok(vec![true; self.n_envs]),
            |given| mask("mask", given, self.n_envs),
        )
    }

    /// Records outputs in addition to those that are recorded already.
    fn record_outputs(&self, py: Python<'_>, names: &[String]) -> PyResult<()> {
        let mut guard = lock(&self.inner, "batch")?;
        let keeper = self.keeper.bind(py);
        each!(&mut *guard, batch => self.recorded.add(keeper, batch, names))
    }
}
