//! `clench.Batch`.

use crate::arrays::mask;
use crate::busy::lock;
use crate::count::Count;
use crate::device::{self, Device};
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
use pyo3::exceptions::{PyAttributeError, PyIndexError, PyOverflowError, PyRuntimeWarning};
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::ffi::CString;
use std::sync::{Arc, Mutex};

/// A batch in either precision.
pub(crate) enum AnyBatch {
    F64(clench::Batch<f64>),
    F32(clench::Batch<f32>),
}

/// Evaluates an expression about a batch of whichever precision.
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
mod outputs;
mod parameters;
mod queries;
mod run;
mod status;

/// Many environments of one model, stepped side by side on all processors.
///
/// Environment i moves as a `Sim` alone would in the same precision, to the bit. One that cannot go on keeps its last good state
/// and says why in `status` and `fault`; its neighbours do not notice.
///
/// State arrays (``qpos``, ``qvel``, ``ctrl``, ...) have the environments as their first axis, and are live: a step works on their
/// very memory. Outputs that are recorded are live too, and can be read by their names: ``batch.cvel``.
///
/// Parameters
/// ----------
/// model : Model
///     The model of all environments.
/// n_envs : int
///     How many environments.
/// precision : {"64", "32"}, optional
///     Bits of every number: "64" on the processor and "32" on a graphics device unless given.
/// threads : int, optional
///     How many threads step; by default as many as there are processors. Results do not depend on it.
/// options : RigidOptions, optional
///     Options that go before those of the model.
/// record : sequence of str
///     Outputs to keep, see `record`.
/// device : str
///     What steps: "cpu"; "gpu", the first graphics device of this machine, or "gpu:" and a part of the name of one that
///     `devices` lists. A device computes the outputs that are recorded; many have no double precision, or a slow one. What is written into arrays
///     goes to it before a call, and the states come back after it; options stay what they are. Questions, such as Jacobians, are
///     answered by the processor.
///
/// Raises
/// ------
/// RuntimeError
///     No graphics device, or one that cannot be used.
/// ValueError
///     What of the model a graphics device cannot step yet, or that it has no double precision; options out of range, shapes that may meet and cannot be collided, names that no output has.
/// MemoryError
///     More environments than memory holds.
#[pyclass(frozen, extends = StateViews, module = "clench")]
pub(crate) struct Batch {
    inner: Arc<Mutex<AnyBatch>>,
    keeper: Py<Keeper>,
    recorded: Recorded,
    model: Py<Model>,
    n_envs: usize,
    precision: Bits,
    threads: usize,
    lanes: usize,
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (model, n_envs, precision = None, threads = None, *, options = None, record = Names(Vec::new()), device = Device::Processor),
           text_signature = "(model, n_envs, precision=None, threads=None, *, options=None, record=(), device='cpu')")]
    fn new(
        model: &Bound<'_, Model>,
        n_envs: Count,
        precision: Option<Bits>,
        threads: Option<Count>,
        options: Option<&RigidOptions>,
        record: Names,
        device: Device,
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
        let make = Arc::clone(model.get().inner());
        let precision = precision.unwrap_or(match device {
            Device::Processor => Bits::B64,
            Device::Graphics { .. } => Bits::B32,
        });
        let inner = py.detach(|| match (device, precision) {
            (Device::Graphics { name }, Bits::B64) => {
                device::batch(make, n_envs.0, own, name).map(AnyBatch::F64)
            }
            (Device::Graphics { name }, Bits::B32) => {
                device::batch(make, n_envs.0, own, name).map(AnyBatch::F32)
            }
            (_, Bits::B64) => clench::Batch::with_options(make, n_envs.0, own)
                .map(AnyBatch::F64)
                .map_err(sim_error),
            (_, Bits::B32) => clench::Batch::with_options(make, n_envs.0, own)
                .map(AnyBatch::F32)
                .map_err(sim_error),
        });
        let inner = Arc::new(Mutex::new(inner?));
        let keeper = Keeper::new(py, inner.clone())?;
        let batch = {
            let mut guard = lock(&inner, "batch")?;
            each!(&mut *guard, batch => {
                let views = StateViews::new(&keeper, &mut batch.state, false)?;
                (views, batch.threads(), batch.lanes())
            })
        };
        let (views, threads, lanes) = batch;
        let batch = Batch {
            inner,
            keeper: keeper.unbind(),
            recorded: Recorded::default(),
            model: model.clone().unbind(),
            n_envs: n_envs.0,
            precision,
            threads,
            lanes,
        };
        batch.keep(py, &record.0)?;
        Ok(PyClassInitializer::from(views).add_subclass(batch))
    }

    fn __getattr__(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        let Ok(output) = Output::find(name) else {
            let known = Vec::from_iter(Output::ALL.iter().map(|output| output.name()));
            return Err(no_attribute("Batch", name, &known));
        };
        let view = self.fresh(py, output)?;
        view.ok_or_else(|| PyAttributeError::new_err(not_recorded(name)))
    }

    fn __dir__(this: &Bound<'_, Self>) -> PyResult<Vec<String>> {
        let mut names: Vec<String> = this.get_type().dir()?.extract()?;
        let outputs = this.get().recorded.outputs()?;
        names.extend(outputs.iter().map(|output| output.name().to_owned()));
        Ok(names)
    }

    /// A simulation of one environment, in its state and with its parameters.
    ///
    /// Parameters
    /// ----------
    /// env : int
    ///     Which environment.
    ///
    /// Returns
    /// -------
    /// Sim
    ///     It goes its own way: no memory is shared.
    fn sim<'py>(&self, py: Python<'py>, env: &Bound<'py, PyAny>) -> PyResult<Bound<'py, Sim>> {
        let env = self.env(env)?;
        let guard = lock(&self.inner, "batch")?;
        let model = self.model.clone_ref(py);
        let sim = match &*guard {
            AnyBatch::F64(batch) => batch.sim(env).and_then(AnySim::f64),
            AnyBatch::F32(batch) => batch.sim(env).and_then(AnySim::f32),
        };
        Bound::new(py, Sim::wrap(py, sim.map_err(sim_error)?, model)?)
    }

    /// State : A copy of what the next step of every environment depends on, parameters apart.
    ///
    /// Assigning one brings all environments there, to the bit, and lets all of them run. That of a `Sim`, or of one environment
    /// (``batch.state[env]``), brings all to the same state.
    #[getter]
    fn state<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let _guard = lock(&this.get().inner, "batch")?;
        this.as_super().get().copy(this.py())
    }

    #[setter]
    fn set_state(this: &Bound<'_, Self>, state: &Bound<'_, PyAny>) -> PyResult<()> {
        let own = this.get();
        let mut guard = lock(&own.inner, "batch")?;
        this.as_super().get().take_over(state)?;
        let mut envs = 0..own.n_envs;
        each!(&mut *guard, batch => envs.try_for_each(|env| batch.revive(env))).map_err(sim_error)
    }

    /// Bring some environments to a state, and let them run.
    ///
    /// Parameters
    /// ----------
    /// state : State
    ///     One for all of them, such as ``sim.state``, or of as many environments as there are in `envs`.
    /// envs : array_like of int, optional
    ///     Which environments; by default all.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     An environment that there is not.
    /// ValueError
    ///     A state of another model, or of another number of environments. All states are then as before.
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
        this.as_super().get().take_over_rows(state, rows)?;
        let mut envs = envs.into_iter();
        each!(&mut *guard, batch => envs.try_for_each(|env| batch.revive(env))).map_err(sim_error)
    }

    /// Model : The model, without the numbers that environments have for themselves.
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<Model> {
        self.model.clone_ref(py)
    }

    /// RigidOptions : The options that were given. Assigning others counts from the next step or forward on.
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

    /// int : How many environments there are.
    #[getter]
    fn n_envs(&self) -> usize {
        self.n_envs
    }

    /// str : Bits of every number, "64" or "32".
    #[getter]
    fn precision(&self) -> &'static str {
        self.precision.name()
    }

    /// str : What steps: "cpu", or "gpu:" and the name of a graphics device.
    #[getter]
    fn device(&self) -> PyResult<String> {
        let guard = lock(&self.inner, "batch")?;
        let name = each!(&*guard, batch => batch.device());
        Ok(name.map_or_else(|| "cpu".to_owned(), |name| format!("gpu:{name}")))
    }

    /// int : How many threads step.
    #[getter]
    fn threads(&self) -> usize {
        self.threads
    }

    /// int : How many environments a thread steps side by side.
    #[getter]
    fn lanes(&self) -> usize {
        self.lanes
    }

    /// int : Bytes that an environment takes: its state, parameters of its own, recorded outputs.
    #[getter]
    fn bytes_per_env(&self) -> PyResult<usize> {
        let guard = lock(&self.inner, "batch")?;
        Ok(each!(&*guard, batch => batch.bytes_per_env()))
    }

    fn __len__(&self) -> usize {
        self.n_envs
    }

    fn __repr__(&self) -> PyResult<String> {
        let name = &self.model.get().inner().name;
        let how = match self.device()?.as_str() {
            "cpu" => format!("{} lanes, {} threads", self.lanes, self.threads),
            device => format!("on {device}"),
        };
        let (count, bits) = (self.n_envs, self.precision.name());
        Ok(format!(
            "<clench.Batch of {count} x {name:?}, {bits} bits, {how}>"
        ))
    }
}

impl Batch {
    /// The batch itself, which other threads may use.
    pub(crate) fn inner(&self) -> &Mutex<AnyBatch> {
        &self.inner
    }

    /// The same, to be kept.
    pub(crate) fn shared(&self) -> &Arc<Mutex<AnyBatch>> {
        &self.inner
    }

    /// The Python object of the model.
    pub(crate) fn py_model(&self) -> &Py<Model> {
        &self.model
    }

    /// The model, without the numbers that environments have for themselves.
    pub(crate) fn described(&self) -> &Arc<clench::Model> {
        self.model.get().inner()
    }

    /// How many environments there are.
    pub(crate) fn count(&self) -> usize {
        self.n_envs
    }

    /// The view of an output, if it is recorded, up to date but while another thread steps this batch.
    fn fresh(&self, py: Python<'_>, output: Output) -> PyResult<Option<Py<PyAny>>> {
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

    /// An environment, by its index.
    fn env(&self, index: &Bound<'_, PyAny>) -> PyResult<usize> {
        let found = match index.extract::<usize>() {
            Err(error) if !error.is_instance_of::<PyOverflowError>(index.py()) => {
                return Err(error);
            }
            found => found.ok().filter(|&env| env < self.n_envs),
        };
        let most = self.n_envs;
        let missing =
            || PyIndexError::new_err(format!("environments go from 0 to {most}, without it"));
        found.ok_or_else(missing)
    }

    /// All environments, where no mask is given.
    fn mask(&self, given: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<bool>> {
        given.map_or_else(
            || Ok(vec![true; self.n_envs]),
            |given| mask("mask", given, self.n_envs),
        )
    }

    /// Records outputs beside those that are recorded already.
    fn keep(&self, py: Python<'_>, names: &[String]) -> PyResult<()> {
        let mut guard = lock(&self.inner, "batch")?;
        let keeper = self.keeper.bind(py);
        each!(&mut *guard, batch => self.recorded.add(keeper, batch, names))
    }
}
