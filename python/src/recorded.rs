//! The outputs that a batch records, as arrays.

use crate::busy::lock;
use crate::error::sim_error;
use crate::view::{Keeper, read_only, view};
use clench::{Batch, Output, Precision};
use numpy::Element;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Mutex;

/// Live views of recorded outputs, in the order in which they were asked for. None is ever taken back, so that views stay valid.
///
/// They have a lock of their own, since they are read while the batch steps. Nothing of Python's runs while it is held: else
/// another thread could ask for it in the middle.
#[derive(Default)]
pub(crate) struct Recorded(Mutex<Vec<(Output, Py<PyAny>)>>);

impl Recorded {
    /// Which outputs there are.
    pub(crate) fn outputs(&self) -> PyResult<Vec<Output>> {
        let views = lock(&self.0, "batch")?;
        Ok(views.iter().map(|(output, _)| *output).collect())
    }

    /// The view of an output, if it is recorded.
    pub(crate) fn get(&self, py: Python<'_>, output: Output) -> PyResult<Option<Py<PyAny>>> {
        let views = lock(&self.0, "batch")?;
        let found = views.iter().find(|(recorded, _)| *recorded == output);
        Ok(found.map(|(_, array)| array.clone_ref(py)))
    }

    /// Lets `batch`, which `keeper` keeps, record outputs beside those that it records already.
    ///
    /// # Errors
    /// A name that no output has; more memory than there is. What is recorded is then as before.
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

/// What to say of an output that is not recorded.
pub(crate) fn not_recorded(name: &str) -> String {
    format!("the output \"{name}\" is not recorded: call record(\"{name}\") first")
}

/// A live view of an output that `batch` records.
fn output_view<S: Precision + Element>(
    keeper: &Bound<'_, Keeper>,
    batch: &Batch<S>,
    output: Output,
) -> PyResult<Py<PyAny>> {
    let Some(rows) = batch.output(output.name()) else {
        return Err(PyValueError::new_err(not_recorded(output.name())));
    };
    let shape = [&[batch.count()], &output.shape(batch.model())[..]].concat();
    // SAFETY: the table has this shape, lives in the batch that `keeper` keeps, and is never taken back.
    let array = unsafe { view(keeper, rows.as_ptr(), &shape) }?;
    Ok(read_only(array)?.into_any().unbind())
}
