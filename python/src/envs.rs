//! The environments that a call is about.

use crate::batch::Batch;
use crate::model::Model;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// A model of environments.
#[cfg_attr(not(feature = "render"), expect(dead_code, reason = "nothing draws"))]
pub(crate) struct Scene {
    pub(crate) model: Py<Model>,
    /// The places of its environments in a call.
    pub(crate) slots: Vec<usize>,
    /// Its geoms in the common layout of several models.
    pub(crate) geoms: Vec<usize>,
}

/// The environments that a call is about, and whether they are a list.
#[cfg_attr(not(feature = "render"), expect(dead_code, reason = "nothing draws"))]
pub(crate) struct Envs {
    pub(crate) of: Vec<usize>,
    pub(crate) list: bool,
}

impl Envs {
    /// Reads an argument: an index, several, or none for all.
    pub(crate) fn new(batch: &Batch, envs: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        if let Some(envs) = envs {
            match batch.env(envs) {
                Err(error) if error.is_instance_of::<PyTypeError>(envs.py()) => {}
                env => {
                    return Ok(Envs {
                        of: vec![env?],
                        list: false,
                    });
                }
            }
        }
        Ok(Envs {
            of: batch.chosen(envs)?,
            list: true,
        })
    }
}
