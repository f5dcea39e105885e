//! What steps a batch: the processor, or a graphics device, as users name it.

use crate::error::sim_error;
use clench::BatchOptions;
use clench_gpu::{GpuError, GpuReal};
use pyo3::exceptions::{PyMemoryError, PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;
use std::sync::Arc;

/// `"cpu"`, `"gpu"`, or `"gpu:"` and a part of a device's name.
#[derive(Clone, PartialEq)]
pub(crate) enum Device {
    Processor,
    Graphics { name: Option<String> },
}

impl FromPyObject<'_, '_> for Device {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        let Ok(text) = object.cast::<PyString>() else {
            let found = object.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "device must be \"cpu\" or \"gpu\", a str, not {found}"
            )));
        };
        let text = text.to_str()?;
        match (text, text.strip_prefix("gpu:")) {
            ("cpu", _) => Ok(Device::Processor),
            ("gpu", _) => Ok(Device::Graphics { name: None }),
            (_, Some(name)) => Ok(Device::Graphics {
                name: Some(name.to_owned()),
            }),
            _ => Err(PyValueError::new_err(format!(
                "device is \"{text}\", but must be \"cpu\", \"gpu\", or \"gpu:\" and a part of a name that clench.devices() lists"
            ))),
        }
    }
}

/// A batch that a graphics device steps, in the precision of its numbers.
pub(crate) fn batch<S: GpuReal>(
    model: Arc<clench::Model>,
    count: usize,
    options: BatchOptions,
    name: Option<String>,
) -> PyResult<clench::Batch<S>> {
    clench_gpu::batch(model, count, options, name.as_deref()).map_err(gpu_error)
}

fn gpu_error(error: GpuError) -> PyErr {
    let text = error.to_string();
    match error {
        GpuError::Sim(error) => sim_error(error),
        GpuError::OutOfMemory { .. } => PyMemoryError::new_err(text),
        GpuError::NoDevice | GpuError::Unusable { .. } | GpuError::Lost { .. } => {
            PyRuntimeError::new_err(text)
        }
        _ => PyValueError::new_err(text),
    }
}

/// The graphics devices of this machine that can step batches, cards first.
///
/// Returns
/// -------
/// list of str
///     Their names, the first of which ``Batch(..., device="gpu")`` takes; empty where there is none.
#[pyfunction]
pub(crate) fn devices(py: Python<'_>) -> Vec<String> {
    let all = py.detach(clench_gpu::devices);
    all.into_iter().map(|device| device.name).collect()
}
