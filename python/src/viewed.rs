//! The target of a viewer: a simulation, or one environment of a batch at a time.

use crate::batch::{AnyBatch, Batch, each};
use crate::busy::lock;
use crate::row_sim::{AnySim, RowSim};
use crate::sim::Sim;
use clench::rigid::profile::Profile;
use clench::{Model, Precision, RigidOptions, SimError};
use clench_view::Viewed;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex};

impl<S: Precision> Viewed for RowSim<S> {
    type Scalar = S;

    fn model(&self) -> &Arc<Model> {
        self.sim.model()
    }

    fn envs(&self) -> usize {
        1
    }

    fn time(&self, _: usize) -> f64 {
        self.rows.time.row(0)[0]
    }

    fn query<R>(
        &mut self,
        _: usize,
        query: impl FnOnce(&mut clench::Sim<S>) -> R,
    ) -> Result<R, SimError> {
        self.current().map(query)
    }

    fn change(
        &mut self,
        _: usize,
        change: impl FnOnce(&mut clench::Sim<S>) -> Result<(), SimError>,
    ) -> Result<(), SimError> {
        change(self.current()?)?;
        self.rows.write(0, &self.sim.state)
    }

    fn reset(&mut self, _: usize, keyframe: Option<usize>) -> Result<(), SimError> {
        self.reset(keyframe)
    }

    fn options(&self) -> RigidOptions {
        self.sim.options()
    }

    fn set_options(&mut self, options: RigidOptions) -> Result<(), SimError> {
        self.sim.set_options(options)
    }

    fn fault(&self, _: usize) -> Option<String> {
        None
    }

    fn run_clocks(&mut self, running: bool) {
        self.sim.run_clocks(running);
    }

    fn profile(&mut self) -> Profile {
        self.sim.profile()
    }
}

/// A simulation or a batch, shared with its Python object.
pub(crate) enum Target {
    Sim(Arc<Mutex<AnySim>>),
    Batch(Arc<Mutex<AnyBatch>>),
}

/// Evaluates an expression about a target of either kind and either precision.
macro_rules! each_viewed {
    ($target:expr, $viewed:ident => $value:expr) => {
        match $target {
            Target::Sim(sim) => match &mut *lock(sim, "simulation")? {
                AnySim::F64(own) => {
                    let $viewed = &mut **own;
                    $value
                }
                AnySim::F32(own) => {
                    let $viewed = &mut **own;
                    $value
                }
            },
            Target::Batch(batch) => match &mut *lock(batch, "batch")? {
                AnyBatch::F64($viewed) => $value,
                AnyBatch::F32($viewed) => $value,
            },
        }
    };
}
pub(crate) use each_viewed;

impl Target {
    /// Returns the target of a Python object.
    ///
    /// # Errors
    /// Returns an error if the object is neither a simulation nor a batch.
    pub(crate) fn of(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(sim) = object.cast::<Sim>() {
            return Ok(Target::Sim(Arc::clone(sim.get().shared())));
        }
        if let Ok(batch) = object.cast::<Batch>() {
            return Ok(Target::Batch(Arc::clone(batch.get().shared())));
        }
        let found = object.get_type().name()?;
        Err(PyTypeError::new_err(format!(
            "a viewer needs a Sim or a Batch, not {found}"
        )))
    }

    /// Returns an error if environments have different models: the page draws the geoms of one.
    pub(crate) fn require_one_model(&self) -> PyResult<()> {
        match self {
            Target::Batch(batch)
                if each!(&*lock(batch, "batch")?, batch => batch.models().len()) > 1 =>
            {
                Err(PyValueError::new_err(
                    "a viewer needs a batch of one model: view batch.sim(env), or record environments with clench.Recording",
                ))
            }
            Target::Batch(_) | Target::Sim(_) => Ok(()),
        }
    }

    /// Returns the number of environments.
    ///
    /// # Errors
    /// Returns an error if another thread is using it.
    pub(crate) fn envs(&self) -> PyResult<usize> {
        Ok(each_viewed!(self, viewed => viewed.envs()))
    }
}
