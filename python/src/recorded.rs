//! The outputs that a batch records, as arrays.

use crate::busy::lock;
use crate::error::sim_error;
use crate::view::{Keeper, read_only, view};
use clench::{Batch, Output, Precision};
use numpy::Element;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Mutex;

/// Live views of recorded outputs, in the order in which they were requested. None is ever removed, so that views stay
/// valid.
///
/// They have a separate lock, since they are read while the batch steps. No Python code runs while it is held, because
/// another thread could request it meanwhile.
#[derive(Default)]
pub(crate) struct Recorded(Mutex<Vec<(Output, Py<PyAny>)>>);

impl Recorded {
    /// Returns the recorded outputs.
    pub(crate) fn outputs(&self) -> PyResult<Vec<Output>> {
        let views = lock(&self.0, "batch")?;
        Ok(views.iter().map(|(output, _)| *output).collect())
    }

    /// Returns the view of an output if it is recorded.
    pub(crate) fn get(&self, py: Python<'_>, output: Output) -> PyResult<Option<Py<PyAny>>> {
        let views = lock(&self.0, "batch")?;
        let found = views.iter().find(|(recorded, _)| *recorded == output);
        Ok(found.map(|(_, array)| array.clone_ref(py)))
    }

    /// Makes `batch`, which `keeper` keeps alive, record outputs in addition to those that it records already.
    ///
    /// # Errors
    /// Returns an error if no output has a name or memory is insufficient. The recorded outputs are then unchanged.
    pub(crate) fn add<S: Precision + Element>(
        &self,
        keeper: &Bound<'_, Keeper>,
        batch: &mut Batch<S>,
        names: &[String],
    ) -> PyResult<()> {
        let mut all = self.outputs()?;
        let old = all.len();
        for name in names {
            let output = Output::find(name).map_err(sim_error)?;
            if !all.contains(&output) {
                all.push(output);
            }
        }
        let names = Vec::from_iter(all.iter().map(|output| output.name()));
        batch.record(&names).map_err(sim_error)?;
        for &output in &all[old..] {
            let array = output_view(keeper, batch, output)?;
            lock(&self.0, "batch")?.push((output, array));
        }
        Ok(())
    }
}

/// Returns the message for an output that is not recorded.
pub(crate) fn not_recorded(name: &str) -> String {
    format!("the output \"{name}\" is not recorded: call record(\"{name}\") first")
}

/// Creates a live view of an output that `batch` records.
fn output_view<S: Precision + Element>(
    keeper: &Bound<'_, Keeper>,
    batch: &Batch<S>,
    output: Output,
) -> PyResult<Py<PyAny>> {
    let Some(rows) = batch.output(output.name()) else {
        return Err(PyValueError::new_err(not_recorded(output.name())));
    };
    let shape = [&[batch.count()], &output.shape(batch.model())[..]].concat();
    // SAFETY: the table has this shape, lives in the batch that `keeper` keeps alive, and is never removed.
    let array = unsafe { view(keeper, rows.as_ptr(), &shape) }?;
    Ok(read_only(array)?.into_any().unbind())
}
