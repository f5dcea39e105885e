//! `clench.Element`.

use crate::kind::Kind;
use crate::names::no_attribute;
use crate::{assets, fields};
use clench::Model;
use pyo3::prelude::*;
use pyo3::types::PySlice;
use std::ops::Range;
use std::sync::Arc;

/// One element of a model: a body, joint, geom, site, camera, tendon, actuator, equality constraint, keyframe, geom
/// pair, mesh or height field.
///
/// Its fields are attributes, named as the fields of the model without the kind: the `mass` of a body is
/// ``body_mass[id]``, the `range` of a joint ``jnt_range[id]``, the `qpos` of a keyframe ``key_qpos[id]``. A joint also
/// has its rows of each `dof_...` field, and its part of `qpos0` and `qpos_spring`. A mesh has its vertices and faces
/// as `vert` and `face`, a height field its (nrow, ncol) heights as `data`. ``dir(element)`` lists all.
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
    /// Finds an element by name or index.
    pub(crate) fn find(model: &Arc<Model>, kind: Kind, which: &Bound<'_, PyAny>) -> PyResult<Self> {
        let id = kind.find(model, which)?;
        let model = model.clone();
        Ok(Element { model, kind, id })
    }

    /// Reshapes heights to rows and columns; returns anything else unchanged.
    fn in_shape<'py>(&self, rows: Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        if self.kind != Kind::HeightField {
            return Ok(rows);
        }
        let shape = &self.model.height_fields[self.id].shape;
        rows.call_method1("reshape", (shape.rows(), shape.columns()))
    }

    /// Returns the names of its fields.
    fn fields(&self) -> Vec<&'static str> {
        let mut names: Vec<_> = fields::names()
            .filter_map(|name| name.strip_prefix(self.kind.prefix()))
            .collect();
        if self.kind == Kind::Joint {
            names.extend(fields::names().filter(|name| self.rows_of(name).is_some()));
        }
        names
    }

    /// Returns the rows of a field that belong to this element, if they are not the single row of its index.
    fn rows_of(&self, field: &str) -> Option<Range<usize>> {
        if field.starts_with(self.kind.prefix()) {
            return assets::rows_of(&self.model, field, self.id);
        }
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
    /// str : Its kind, such as "body".
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
        let own = format!("{}{name}", self.kind.prefix());
        for field in [own.as_str(), name] {
            let rows = self.rows_of(field);
            if let (Some(rows), Some(field)) = (rows, fields::find(&self.model, field)) {
                let slice = PySlice::new(py, rows.start as isize, rows.end as isize, 1);
                return self.in_shape(field.show(py)?.get_item(slice)?);
            }
        }
        if let Some(field) = fields::find(&self.model, &own) {
            let row = field.show(py)?.get_item(self.id)?;
            let single = row.getattr("ndim")?.extract::<usize>()? == 0;
            return if single {
                row.call_method0("item")
            } else {
                Ok(row)
            };
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
