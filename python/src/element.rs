//! `clench.Element`.

use crate::fields;
use crate::kind::Kind;
use crate::names::no_attribute;
use clench::Model;
use pyo3::prelude::*;
use pyo3::types::PySlice;
use std::ops::Range;
use std::sync::Arc;

/// One element of a model: a body, joint, geom, site, tendon, actuator, equality constraint, keyframe or geom pair.
///
/// Its numbers are attributes, named as the fields of the model without the kind: the `mass` of a body is
/// ``body_mass[id]``, the `range` of a joint ``jnt_range[id]``, the `qpos` of a keyframe ``key_qpos[id]``. A joint also
/// has a row of each `dof_...` field for each of its degrees of freedom, and its part of `qpos0` and `qpos_spring`.
/// ``dir(element)`` lists all.
///
/// Examples
/// --------
/// >>> model.joint("right_knee").range
/// array([-0.03490659,  2.61799388])
#[pyclass(frozen, module = "clench")]
pub(crate) struct Element {
    model: Arc<Model>,
    kind: Kind,
    id: usize,
}

impl Element {
    /// The element that a user names or counts.
    pub(crate) fn find(model: &Arc<Model>, kind: Kind, which: &Bound<'_, PyAny>) -> PyResult<Self> {
        let id = kind.find(model, which)?;
        let model = model.clone();
        Ok(Element { model, kind, id })
    }

    /// The names of its fields.
    fn fields(&self) -> Vec<&'static str> {
        let mut names: Vec<_> = fields::names()
            .filter_map(|name| name.strip_prefix(self.kind.prefix()))
            .collect();
        if self.kind == Kind::Joint {
            names.extend(fields::names().filter(|name| self.rows_of(name).is_some()));
        }
        names
    }

    /// Which rows of a field of the model belong to this joint.
    fn rows_of(&self, field: &str) -> Option<Range<usize>> {
        let joint = self
            .model
            .joints
            .get(self.id)
            .filter(|_| self.kind == Kind::Joint)?;
        let rows = |first: usize, count: usize| first..first + count;
        match field {
            "qpos0" | "qpos_spring" => Some(rows(joint.qpos, joint.kind.nq())),
            _ if field.starts_with("dof_") => Some(rows(joint.dof, joint.kind.nv())),
            _ => None,
        }
    }
}

#[pymethods]
impl Element {
    /// str : What it is, such as "body".
    #[getter]
    fn kind(&self) -> &'static str {
        self.kind.name()
    }

    /// int : Its index among the elements of its kind.
    #[getter]
    fn id(&self) -> usize {
        self.id
    }

    /// str : Its name, possibly empty.
    #[getter]
    fn name(&self) -> &str {
        self.kind.names(&self.model)[self.id]
    }

    fn __getattr__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        if let Some(field) = fields::find(&self.model, &format!("{}{name}", self.kind.prefix())) {
            let row = field.show(py)?.get_item(self.id)?;
            let single = row.getattr("ndim")?.extract::<usize>()? == 0;
            return if single {
                row.call_method0("item")
            } else {
                Ok(row)
            };
        }
        let rows = self.rows_of(name);
        if let (Some(rows), Some(field)) = (rows, fields::find(&self.model, name)) {
            let slice = PySlice::new(py, rows.start as isize, rows.end as isize, 1);
            return field.show(py)?.get_item(slice);
        }
        let class = format!("an Element of kind \"{}\"", self.kind.name());
        Err(no_attribute(&class, name, &self.fields()))
    }

    fn __dir__(slf: &Bound<'_, Self>) -> PyResult<Vec<String>> {
        let mut names: Vec<String> = slf.get_type().dir()?.extract()?;
        names.extend(slf.get().fields().into_iter().map(str::to_owned));
        Ok(names)
    }

    fn __repr__(&self) -> String {
        let (kind, id) = (self.kind.name(), self.id);
        match self.name() {
            "" => format!("<clench.Element: {kind} {id}, without a name>"),
            name => format!("<clench.Element: {kind} {id}, \"{name}\">"),
        }
    }
}
