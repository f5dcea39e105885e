//! The models of a batch.

use crate::arrays::indices;
use crate::device::{self, Device, DeviceReal};
use crate::error::sim_error;
use crate::model::Model;
use clench::{BatchOptions, SimError};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::sync::Arc;

/// The models of a batch, and the model of each environment.
pub(crate) struct Models {
    pub(crate) objects: Vec<Py<Model>>,
    models: Vec<Arc<clench::Model>>,
    n_envs: usize,
    /// None if environment i has the i-th model, in turn.
    of_env: Option<Vec<usize>>,
}

impl Models {
    pub(crate) fn of(
        model: &Bound<'_, PyAny>,
        n_envs: usize,
        env_model: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let objects = match model.cast::<Model>() {
            Ok(one) => vec![one.clone().unbind()],
            Err(_) => model.extract::<Vec<Py<Model>>>().map_err(|_| {
                let found = model.get_type();
                PyTypeError::new_err(format!(
                    "model must be a Model or a sequence of Model, not {found}"
                ))
            })?,
        };
        if objects.is_empty() {
            return Err(sim_error(SimError::NoModel));
        }
        let of_env = env_model.map(|given| indices("env_model", given, objects.len()));
        let of_env = of_env.transpose()?;
        if let Some(found) = of_env.as_ref().map(Vec::len).filter(|&len| len != n_envs) {
            let text =
                format!("env_model has {found} numbers, but there are {n_envs} environments");
            return Err(PyValueError::new_err(text));
        }
        let models = objects.iter().map(|model| Arc::clone(model.get().inner()));
        Ok(Models {
            models: models.collect(),
            objects,
            n_envs,
            of_env,
        })
    }

    /// Creates the batch.
    pub(crate) fn batch<S: DeviceReal>(
        &self,
        device: Device,
        options: BatchOptions,
    ) -> PyResult<clench::Batch<S>> {
        match (device, &self.models[..]) {
            (Device::Graphics { name }, [model]) => {
                device::batch(Arc::clone(model), self.n_envs, options, name)
            }
            (Device::Graphics { .. }, _) => Err(sim_error(SimError::OneModel("a GPU"))),
            (Device::Processor, models) => match &self.of_env {
                Some(of_env) => clench::Batch::of_models(models, of_env, options),
                None => clench::Batch::of_models_in_turn(models, self.n_envs, options),
            }
            .map_err(sim_error),
        }
    }

    /// Returns the object of the batch's model: the only one, or that of the common layout.
    pub(crate) fn layout(
        &self,
        py: Python<'_>,
        layout: &Arc<clench::Model>,
    ) -> PyResult<Py<Model>> {
        match &self.objects[..] {
            [model] => Ok(model.clone_ref(py)),
            _ => Py::new(py, Model::layout(layout)),
        }
    }
}
