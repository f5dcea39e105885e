//! The device that steps a batch: the CPU or a GPU, as users name it.

use clench::BatchOptions;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;
use std::sync::Arc;

/// `"cpu"`, `"gpu"`, or `"gpu:"` followed by a part of a device's name.
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

#[cfg(feature = "gpu")]
mod graphics {
    use crate::error::sim_error;
    use clench_gpu::GpuError;
    pub(crate) use clench_gpu::GpuReal;
    use pyo3::exceptions::{PyMemoryError, PyRuntimeError, PyValueError};
    use pyo3::prelude::*;

    pub(crate) fn error(error: GpuError) -> PyErr {
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
}

#[cfg(not(feature = "gpu"))]
pub(crate) use clench::Precision as DeviceReal;
#[cfg(feature = "gpu")]
pub(crate) use graphics::GpuReal as DeviceReal;

/// Creates a batch on a GPU, with the precision of its numbers.
#[cfg(feature = "gpu")]
pub(crate) fn batch<S: graphics::GpuReal>(
    model: Arc<clench::Model>,
    count: usize,
    options: BatchOptions,
    name: Option<String>,
) -> PyResult<clench::Batch<S>> {
    clench_gpu::batch(model, count, options, name.as_deref()).map_err(graphics::error)
}

/// Returns an error that says how to build a package with GPU support.
#[cfg(not(feature = "gpu"))]
pub(crate) fn batch<S: clench::Precision>(
    _: Arc<clench::Model>,
    _: usize,
    _: BatchOptions,
    _: Option<String>,
) -> PyResult<clench::Batch<S>> {
    Err(no_devices())
}

#[cfg(not(feature = "gpu"))]
fn no_devices() -> PyErr {
    pyo3::exceptions::PyRuntimeError::new_err(without("graphics devices", "gpu"))
}

/// Returns the error message for a part that was not compiled in.
#[cfg(not(all(feature = "gpu", feature = "render", feature = "derivatives")))]
pub(crate) fn without(part: &str, feature: &str) -> String {
    format!(
        "this package was built without {part}; wheels have them, and from source \
         `pip install ./python --config-settings=build-args=--features={feature}` adds them, which takes about two more minutes on two cores"
    )
}

/// Lists the GPUs of this machine that can step batches, physical ones first.
///
/// Returns
/// -------
/// list of str
///     Their names. ``Batch(..., device="gpu")`` uses the first. Empty if there is none.
///
/// Raises
/// ------
/// RuntimeError
///     If the package was built without GPU support; the message says how to build it with that.
#[pyfunction]
pub(crate) fn devices(py: Python<'_>) -> PyResult<Vec<String>> {
    #[cfg(feature = "gpu")]
    {
        let all = py.detach(clench_gpu::devices);
        Ok(all.into_iter().map(|device| device.name).collect())
    }
    #[cfg(not(feature = "gpu"))]
    {
        let _ = py;
        Err(no_devices())
    }
}
