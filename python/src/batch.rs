//! `clench.Batch`.

use crate::arrays::{indices, mask, shaped};
use crate::busy::{in_portions, lock};
use crate::count::Count;
use crate::error::sim_error;
use crate::kind::Kind;
use crate::model::Model;
use crate::names::{Names, no_attribute};
use crate::options::RigidOptions;
use crate::precision::Bits;
use crate::recorded::{Recorded, not_recorded};
use crate::rollout::rollout;
use crate::row_sim::AnySim;
use crate::sim::{Sim, sensor_numbers};
use crate::state_views::StateViews;
use crate::view::Keeper;
use clench::{BatchOptions, EnvStatus, Fault, Output};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::{PyAttributeError, PyIndexError, PyOverflowError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PySlice, PyTuple};
use std::sync::{Arc, Mutex};

/// A batch in either precision.
enum AnyBatch {
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
/// precision : {"64", "32"}
///     Bits of every number.
/// threads : int, optional
///     How many threads step; by default as many as there are processors. Results do not depend on it.
/// options : RigidOptions, optional
///     Options that go before those of the model.
/// record : sequence of str
///     Outputs to keep, see `record`.
///
/// Raises
/// ------
/// ValueError
///     Options out of range, shapes that may meet and cannot be collided, names that no output has.
/// MemoryError
///     More environments than memory holds.
#[pyclass(frozen, extends = StateViews, module = "clench")]
pub(crate) struct Batch {
    inner: Arc<Mutex<AnyBatch>>,
    keeper: Py<Keeper>,
    recorded: Recorded,
    model: Py<Model>,
    options: RigidOptions,
    n_envs: usize,
    precision: Bits,
    threads: usize,
    lanes: usize,
}

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (model, n_envs, precision = Bits::B64, threads = None, *, options = None, record = Names(Vec::new())),
           text_signature = "(model, n_envs, precision='64', threads=None, *, options=None, record=())")]
    fn new(
        model: &Bound<'_, Model>,
        n_envs: Count,
        precision: Bits,
        threads: Option<Count>,
        options: Option<&RigidOptions>,
        record: Names,
    ) -> PyResult<PyClassInitializer<Self>> {
        let py = model.py();
        let options = options.copied().unwrap_or_default();
        let own = BatchOptions {
            options: options.0,
            threads: threads.map(|count| count.0),
            ..BatchOptions::default()
        };
        let make = Arc::clone(model.get().inner());
        let inner = py.detach(|| {
            Ok(match precision {
                Bits::B64 => AnyBatch::F64(clench::Batch::with_options(make, n_envs.0, own)?),
                Bits::B32 => AnyBatch::F32(clench::Batch::with_options(make, n_envs.0, own)?),
            })
        });
        let inner = Arc::new(Mutex::new(inner.map_err(sim_error)?));
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
            options,
            n_envs: n_envs.0,
            precision,
            threads,
            lanes,
        };
        batch.keep(py, &record.0)?;
        Ok(PyClassInitializer::from(views).add_subclass(batch))
    }

    /// Advances every running environment.
    ///
    /// Other Python threads run meanwhile; what they write to the arrays of this batch meets the step half-way. With the option
    /// `autoreset` an environment that diverges does the step from the initial state instead, controls and applied forces
    /// included, which counts in `resets`.
    ///
    /// Parameters
    /// ----------
    /// n : int
    ///     How many time steps, with the same controls and applied forces.
    ///
    /// Returns
    /// -------
    /// int
    ///     How many environments failed in this call.
    ///
    /// Raises
    /// ------
    /// BusyError
    ///     While another thread is in a call of this batch.
    /// ClenchError
    ///     In a process forked from the one that made this batch, if it has several threads: a fork does not copy them.
    #[pyo3(signature = (n = Count(1)), text_signature = "($self, n=1)")]
    fn step(&self, py: Python<'_>, n: Count) -> PyResult<usize> {
        let mut guard = lock(&self.inner, "batch")?;
        let any = &mut *guard;
        let mut failed = 0;
        in_portions(py, n.0, |steps| {
            let summary = each!(any, batch => batch.step_n(steps));
            failed += summary.map_err(sim_error)?.failed;
            Ok(())
        })?;
        Ok(failed)
    }

    /// Computes the recorded outputs that follow from the states, and leaves the states alone.
    ///
    /// Parameters
    /// ----------
    /// mask : array_like of bool, optional
    ///     Which environments (n); by default all. The outputs of the others stay as they are.
    ///
    /// Returns
    /// -------
    /// int
    ///     How many environments failed in this call.
    #[pyo3(signature = (mask = None))]
    fn forward(&self, py: Python<'_>, mask: Option<&Bound<'_, PyAny>>) -> PyResult<usize> {
        let chosen = self.mask(mask)?;
        let mut guard = lock(&self.inner, "batch")?;
        let any = &mut *guard;
        let summary = py.detach(|| each!(any, batch => batch.forward_mask(&chosen)));
        Ok(summary.map_err(sim_error)?.failed)
    }

    /// Puts environments into their initial state, or that of a keyframe, and lets them run.
    ///
    /// Parameters
    /// ----------
    /// mask : array_like of bool, optional
    ///     Which environments (n); by default all.
    /// keyframe : str or int, optional
    ///     A keyframe of the model, by name or index.
    #[pyo3(signature = (mask = None, keyframe = None))]
    fn reset(
        &self,
        py: Python<'_>,
        mask: Option<&Bound<'_, PyAny>>,
        keyframe: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let chosen = self.mask(mask)?;
        let find = |which| Kind::Keyframe.find(self.model.get().inner(), which);
        let key = keyframe.map(find).transpose()?;
        let mut guard = lock(&self.inner, "batch")?;
        let any = &mut *guard;
        let envs = (0..self.n_envs).filter(|&env| chosen[env]);
        let done = py.detach(|| {
            each!(any, batch => envs.into_iter().try_for_each(|env| match key {
                None => batch.reset(env),
                Some(key) => batch.reset_to_keyframe(env, key),
            }))
        });
        done.map_err(sim_error)
    }

    /// Lets environments run on from the states in their rows.
    ///
    /// Parameters
    /// ----------
    /// mask : array_like of bool, optional
    ///     Which environments (n); by default all.
    #[pyo3(signature = (mask = None))]
    fn revive(&self, mask: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let chosen = self.mask(mask)?;
        let mut guard = lock(&self.inner, "batch")?;
        let mut envs = (0..self.n_envs).filter(|&env| chosen[env]);
        each!(&mut *guard, batch => envs.try_for_each(|env| batch.revive(env))).map_err(sim_error)
    }

    /// numpy.ndarray : Whether each environment runs (n), and if not why: codes of `EnvStatus`, int8. A copy.
    #[getter]
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i8>>> {
        let guard = lock(&self.inner, "batch")?;
        let codes = each!(&*guard, batch => batch.statuses().iter().map(code));
        Ok(PyArray1::from_iter(py, codes))
    }

    /// numpy.ndarray : Which environments run (n), bool. A copy.
    #[getter]
    fn running<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let guard = lock(&self.inner, "batch")?;
        let statuses = each!(&*guard, batch => batch.statuses());
        let runs = statuses.iter().map(|status| *status == EnvStatus::Running);
        Ok(PyArray1::from_iter(py, runs))
    }

    /// numpy.ndarray : How often each environment started over from the initial state (n), with the option `autoreset`, int64. A
    /// copy.
    #[getter]
    fn resets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let guard = lock(&self.inner, "batch")?;
        let resets = each!(&*guard, batch => batch.resets());
        let counts = resets.iter().map(|&count| count as i64);
        Ok(PyArray1::from_iter(py, counts))
    }

    /// Why an environment cannot go on.
    ///
    /// Parameters
    /// ----------
    /// env : int
    ///     Which environment.
    ///
    /// Returns
    /// -------
    /// str or None
    ///     None if it runs.
    fn fault(&self, env: &Bound<'_, PyAny>) -> PyResult<Option<String>> {
        let env = self.env(env)?;
        let guard = lock(&self.inner, "batch")?;
        Ok(match each!(&*guard, batch => batch.status(env)) {
            EnvStatus::Running => None,
            EnvStatus::Failed(fault) => Some(fault.to_string()),
        })
    }

    /// Gives environments numbers of their own in place of the model's.
    ///
    /// What follows directly is computed with it (``body_subtreemass`` from ``body_mass``, ``geom_rbound`` from ``geom_size``);
    /// quaternions and axes are normalized. The numbers stay when an environment is reset.
    ///
    /// Parameters
    /// ----------
    /// field : str
    ///     A parameter of the model, such as ``"body_mass"`` or ``"geom_friction"``; see `clench.PARAMETERS`.
    /// values : array_like
    ///     The whole field for each environment: its shape in the model after an axis over environments.
    /// envs : array_like of int, optional
    ///     Which environments; by default all.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A name that no parameter has, a wrong shape, or numbers that the field cannot have. All is then as before.
    #[pyo3(signature = (field, values, envs = None))]
    fn randomize(
        &self,
        field: &str,
        values: &Bound<'_, PyAny>,
        envs: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let envs = match envs {
            Some(envs) => indices("envs", envs, self.n_envs)?,
            None => Vec::from_iter(0..self.n_envs),
        };
        let shape = self.model.get().param_shape(field)?;
        let mut guard = lock(&self.inner, "batch")?;
        each!(&mut *guard, batch => {
            let values = shaped(field, values, &[&[envs.len()], &shape[..]].concat())?;
            batch.randomize(field, &envs, values.as_slice()?).map_err(sim_error)
        })
    }

    /// The numbers of a parameter as each environment has them.
    ///
    /// Parameters
    /// ----------
    /// field : str
    ///     A parameter of the model.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     A copy: the field's shape in the model after an axis over environments.
    fn param<'py>(&self, py: Python<'py>, field: &str) -> PyResult<Bound<'py, PyAny>> {
        let shape = self.model.get().param_shape(field)?;
        let guard = lock(&self.inner, "batch")?;
        each!(&*guard, batch => {
            let mut all = Vec::new();
            for env in 0..self.n_envs {
                all.append(&mut batch.param(field, env).map_err(sim_error)?);
            }
            let shape = [&[self.n_envs], &shape[..]].concat();
            Ok(PyArray1::from_vec(py, all).reshape(shape)?.into_any())
        })
    }

    /// Keeps outputs from now on, beside those that are kept already.
    ///
    /// They are computed at once. Every step and forward leaves them as of its last forward pass, as MuJoCo leaves its fields: those
    /// that follow from positions are of the start of the last time step (with the Runge-Kutta integrator, of its last stage).
    /// Where positions, velocities, mocap poses or parameters of an environment were written since, asking for an output by
    /// name (`output`, ``batch.xpos``) computes that environment's anew. Rows of environments that do not run stay as they are.
    ///
    /// Parameters
    /// ----------
    /// *names : str
    ///     Names of outputs, see `clench.OUTPUTS`.
    #[pyo3(signature = (*names))]
    fn record(&self, py: Python<'_>, names: Vec<String>) -> PyResult<()> {
        self.keep(py, &names)
    }

    /// tuple of str : The outputs that are recorded.
    #[getter]
    fn outputs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let outputs = self.recorded.outputs()?;
        PyTuple::new(py, outputs.iter().map(|output| output.name()))
    }

    /// A recorded output.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     A live view that cannot be written, with environments as first axis.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     An output that is not recorded.
    fn output(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        let output = Output::find(name).map_err(sim_error)?;
        let view = self.fresh(py, output)?;
        view.ok_or_else(|| PyValueError::new_err(not_recorded(name)))
    }

    /// What one sensor measured in every environment: its part of `sensordata`, which must be recorded.
    ///
    /// Parameters
    /// ----------
    /// which : str or int
    ///     Its name or index.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     A live view that cannot be written, with environments as first axis.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A name that no sensor has, or `sensordata` is not recorded.
    /// IndexError
    ///     A number that is negative or too large.
    fn sensor<'py>(
        &self,
        py: Python<'py>,
        which: &Bound<'_, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let numbers = sensor_numbers(py, self.model.get().inner(), which)?;
        let all = self.output(py, "sensordata")?.into_bound(py);
        all.get_item((PySlice::full(py), numbers))
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

    /// Steps all running environments and records outputs after each step.
    ///
    /// Other Python threads run meanwhile. Ctrl-C is looked at now and then, and loses what was recorded.
    ///
    /// Parameters
    /// ----------
    /// initial : array_like, optional
    ///     States to start from (n, 1 + nq + nv + na): time, positions, velocities, activations. All environments then run, and
    ///     the solver starts anew, so that what comes out depends on no earlier step. By default they go on from where they are.
    /// ctrl : array_like, optional
    ///     Controls of each step, for all (steps, nu) or each (n, steps, nu) environment. By default those in `ctrl`, which
    ///     stay as they are in any case.
    /// record : sequence of str
    ///     Outputs to record, see `clench.OUTPUTS`.
    /// steps : int, optional
    ///     How many steps; needed only without `ctrl`.
    ///
    /// Returns
    /// -------
    /// dict of str to numpy.ndarray
    ///     Each output (n, steps, ...). Steps that an environment did not do are NaN.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Wrong shapes; names that no output has. The states are then as before.
    #[pyo3(signature = (initial = None, ctrl = None, record = None, steps = None),
           text_signature = "($self, initial=None, ctrl=None, record=('qpos', 'qvel'), steps=None)")]
    fn rollout<'py>(
        &self,
        py: Python<'py>,
        initial: Option<&Bound<'py, PyAny>>,
        ctrl: Option<&Bound<'py, PyAny>>,
        record: Option<Names>,
        steps: Option<Count>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let record = record.map_or_else(|| vec!["qpos".into(), "qvel".into()], |names| names.0);
        let steps = steps.map(|count| count.0);
        let mut guard = lock(&self.inner, "batch")?;
        each!(&mut *guard, batch => rollout(py, batch, initial, ctrl, &record, steps))
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
        let (model, options) = (self.model.clone_ref(py), self.options);
        let sim = match &*guard {
            AnyBatch::F64(batch) => batch.sim(env).and_then(AnySim::f64),
            AnyBatch::F32(batch) => batch.sim(env).and_then(AnySim::f32),
        };
        Bound::new(py, Sim::wrap(py, sim.map_err(sim_error)?, model, options)?)
    }

    /// State : A copy of what the next step of every environment depends on, parameters apart.
    ///
    /// Assigning one brings all environments there, to the bit, and lets all of them run.
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

    /// Model : The model, without the numbers that environments have for themselves.
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<Model> {
        self.model.clone_ref(py)
    }

    /// RigidOptions : The options that were given.
    #[getter]
    fn options(&self) -> RigidOptions {
        self.options
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

    fn __repr__(&self) -> String {
        let name = &self.model.get().inner().name;
        format!(
            "<clench.Batch of {} x {name:?}, {} bits, {} lanes, {} threads>",
            self.n_envs,
            self.precision.name(),
            self.lanes,
            self.threads
        )
    }
}

impl Batch {
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

/// The code of `clench.EnvStatus`.
fn code(status: &EnvStatus) -> i8 {
    match status {
        EnvStatus::Running => 0,
        EnvStatus::Failed(Fault::NotFinite { .. }) => 1,
        EnvStatus::Failed(Fault::Singular { .. }) => 2,
        EnvStatus::Failed(Fault::Diverged { .. }) => 3,
        EnvStatus::Failed(Fault::ContactOverflow { .. }) => 4,
        EnvStatus::Failed(Fault::OverBudget { .. }) => 5,
    }
}
