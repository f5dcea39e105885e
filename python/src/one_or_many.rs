//! Calls that `Sim` and `Batch` share: each is written once, and answered for one environment or for many.

use crate::answer::{answer, each_row};
use crate::arrays::require_finite;
use crate::batch::{AnyBatch, Batch, each};
use crate::busy::lock;
use crate::error::sim_error;
use crate::row_sim::{AnySim, each_sim};
use crate::scan::{RayHits, rays};
use crate::sim::Sim;
use crate::table::Table;
use crate::target::Choice;
use clench::{Precision, Query};
use numpy::Element;
use pyo3::prelude::*;

/// Writes methods once for `Sim` and `Batch`. Each class has functions of the same names that they call.
macro_rules! one_or_many {
    ($($methods:tt)*) => {
        #[pymethods]
        #[allow(clippy::too_many_arguments)] // They are keywords.
        impl $crate::sim::Sim {
            $($methods)*
        }

        #[pymethods]
        #[allow(clippy::too_many_arguments)] // They are keywords.
        impl $crate::batch::Batch {
            $($methods)*
        }
    };
}
pub(crate) use one_or_many;

/// The input of a query: numbers with their name for messages and the width of a row.
pub(crate) enum Input<'a, 'py> {
    None,
    /// A row, or one for each environment.
    Row(&'static str, &'a Bound<'py, PyAny>, usize),
    /// Any number of rows, or as many for each environment.
    Rows(&'static str, &'a Bound<'py, PyAny>, usize),
    /// The origins and directions of rays.
    Rays(&'a Bound<'py, PyAny>, &'a Bound<'py, PyAny>),
}

impl Input<'_, '_> {
    /// Reads the numbers for `n` environments, or for one. Returns the first dimensions of the answer, too.
    fn read<S: Precision + Element>(&self, n: Option<usize>) -> PyResult<(Table<S>, Vec<usize>)> {
        let mut lead = n.map_or_else(Vec::new, |n| vec![n]);
        let table = match *self {
            Input::None => Table::empty(),
            Input::Row(name, values, width) => {
                let row = Table::<S>::row_of(name, values, width, n)?;
                if n.is_none() {
                    // The message names the number that is not finite.
                    require_finite(name, &Vec::from_iter(row.values.iter().map(|x| x.to_f64())))?;
                }
                row
            }
            Input::Rows(name, values, width) => Table::rows_of(name, values, width, n)?,
            Input::Rays(origins, directions) => rays(origins, directions, n)?,
        };
        if let Input::Rows(..) | Input::Rays(..) = self {
            lead.push(table.rows);
        }
        Ok((table, lead))
    }
}

/// The form of an answer.
pub(crate) enum Form<'a, 'py> {
    /// An array with these last dimensions, new or `out`.
    Array(&'a [usize], Choice<'a, 'py>),
    /// The hits of rays.
    Hits,
}

/// Converts the numbers of an answer; `lead` are its dimensions before those of one environment and row.
fn export<'py, S: Precision + Element>(
    py: Python<'py>,
    numbers: Vec<S>,
    lead: &[usize],
    form: Form<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    match form {
        Form::Array(last, out) if lead.is_empty() => answer(py, numbers, last, out),
        Form::Array(last, out) => answer(py, numbers, &[lead, last].concat(), out),
        Form::Hits => Ok(Bound::new(py, RayHits::new(py, &numbers, lead)?)?.into_any()),
    }
}

impl Sim {
    /// Returns the number of environments, for arrays with an axis of them: none.
    pub(crate) fn envs(&self) -> Option<usize> {
        None
    }

    /// Answers a query.
    pub(crate) fn answer<'py>(
        &self,
        py: Python<'py>,
        query: Query<'_>,
        input: &Input<'_, 'py>,
        form: Form<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let (input, lead) = input.read(None)?;
            let mut found = Vec::new();
            let done = own.current().and_then(|sim| sim.answer(query, &input.values, &mut found));
            done.map_err(sim_error)?;
            export(py, found, &lead, form)
        })
    }

    /// Answers a query that replaces a row of dofs by another: each of any number of rows.
    pub(crate) fn replace<'py>(
        &self,
        _: Python<'py>,
        query: Query<'_>,
        (name, rows): (&'static str, &Bound<'py, PyAny>),
    ) -> PyResult<Bound<'py, PyAny>> {
        let nv = self.described().nv;
        let mut guard = lock(self.inner(), "simulation")?;
        each_sim!(&mut *guard, own => {
            let sim = own.current().map_err(sim_error)?;
            let mut found = Vec::new();
            each_row(name, rows, nv, |row| {
                sim.answer(query, row, &mut found)?;
                row.copy_from_slice(&found);
                Ok(())
            })
        })
    }
}

impl Batch {
    /// Returns the number of environments, for arrays with an axis of them.
    pub(crate) fn envs(&self) -> Option<usize> {
        Some(self.count())
    }

    /// Answers a query in every environment.
    pub(crate) fn answer<'py>(
        &self,
        py: Python<'py>,
        query: Query<'_>,
        input: &Input<'_, 'py>,
        form: Form<'_, 'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut guard = lock(self.inner(), "batch")?;
        each!(&mut *guard, batch => {
            let (input, lead) = input.read(self.envs())?;
            let found = py.detach(|| batch.answer(query, input.input())).map_err(sim_error)?;
            export(py, found.as_slice().to_vec(), &lead, form)
        })
    }

    /// Answers a query that replaces a row of dofs by another: one row in every environment.
    pub(crate) fn replace<'py>(
        &self,
        py: Python<'py>,
        query: Query<'_>,
        (name, rows): (&'static str, &Bound<'py, PyAny>),
    ) -> PyResult<Bound<'py, PyAny>> {
        let nv = self.described().nv;
        let (input, shape) = (Input::Row(name, rows, nv), [nv]);
        self.answer(py, query, &input, Form::Array(&shape, None))
    }
}
