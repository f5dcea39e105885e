//! Colours and lights of pictures, as dictionaries of arrays.

use crate::answer::answer;
use crate::arrays::{numbers, require_finite, shape_text};
use crate::model::Model;
use clench_render::{LookField, Looks};
use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The values of some fields, for all environments or for each.
pub(crate) struct Appearance {
    fields: Vec<Values>,
}

struct Values {
    field: LookField,
    numbers: Vec<f64>,
    /// The numbers of an environment.
    row: usize,
    each: bool,
}

impl Appearance {
    /// Reads a dictionary: each array has the shape of its field in the model or, for `n` environments, an axis in
    /// front.
    pub(crate) fn new(
        model: &clench::Model,
        n: Option<usize>,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let Ok(value) = value.cast::<PyDict>() else {
            let found = value.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "appearance must be a dict of arrays, not {found}"
            )));
        };
        let fields = value.iter().map(|(name, values)| {
            let name: String = name.extract()?;
            Values::new(model, n, &name, &values)
        });
        Ok(Appearance {
            fields: fields.collect::<PyResult<_>>()?,
        })
    }

    /// Returns an error if a model has other numbers of elements than the layout: only geoms may differ.
    pub(crate) fn check(&self, layout: &clench::Model, model: &clench::Model) -> PyResult<()> {
        let differs =
            |field: LookField| !field.is_of_geoms() && field.shape(layout) != field.shape(model);
        match self.fields.iter().find(|values| differs(values.field)) {
            None => Ok(()),
            Some(values) => Err(PyValueError::new_err(format!(
                "{} cannot be set: models have different numbers of lights",
                values.field.name
            ))),
        }
    }

    /// Changes looks to those of an environment, whose model has these of the geoms.
    pub(crate) fn apply(&self, env: usize, geoms: &[usize], looks: &mut Looks) {
        for values in &self.fields {
            let start = if values.each { env * values.row } else { 0 };
            let row = &values.numbers[start..start + values.row];
            if values.field.is_of_geoms() {
                let own = geoms.iter().flat_map(|geom| &row[4 * geom..4 * geom + 4]);
                looks.set(values.field, &Vec::from_iter(own.copied()));
            } else {
                looks.set(values.field, row);
            }
        }
    }
}

impl Values {
    fn new(
        model: &clench::Model,
        n: Option<usize>,
        name: &str,
        values: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let Some(field) = LookField::ALL.into_iter().find(|field| field.name == name) else {
            let known = LookField::ALL.map(|field| field.name).join(", ");
            return Err(PyValueError::new_err(format!(
                "appearance has no {name:?}, but {known}"
            )));
        };
        let array = numbers::<f64>(name, values)?;
        let shape = field.shape(model);
        let all = n.map(|n| [&[n], &shape[..]].concat());
        let each = all.as_deref() == Some(array.shape());
        if !each && array.shape() != shape {
            let all = all.map_or_else(String::new, |all| format!(" or {}", shape_text(&all)));
            return Err(PyValueError::new_err(format!(
                "{name} has shape {}, but must have {}{all}",
                shape_text(array.shape()),
                shape_text(&shape)
            )));
        }
        let numbers = array.as_slice()?.to_vec();
        require_finite(name, &numbers)?;
        let [low, high] = field.range();
        if let Some(wrong) = numbers.iter().find(|x| !(low..=high).contains(*x)) {
            let upper = if high < f64::MAX {
                "from 0 to 1"
            } else {
                "at least 0"
            };
            return Err(PyValueError::new_err(format!(
                "{name} is {wrong}, but must be {upper}"
            )));
        }
        let zero = |row: &[f64]| row.iter().all(|x| x.abs() < f64::MIN_POSITIVE);
        if field.is_direction() && numbers.chunks_exact(field.width).any(zero) {
            return Err(PyValueError::new_err(format!("{name} has no length")));
        }
        Ok(Values {
            field,
            numbers,
            row: shape.iter().product(),
            each,
        })
    }
}

/// Returns the looks of a model as a dictionary of arrays.
pub(crate) fn appearance<'py>(py: Python<'py>, model: &Model) -> PyResult<Bound<'py, PyDict>> {
    let model = model.inner();
    let (looks, all) = (Looks::of(model), PyDict::new(py));
    for field in LookField::ALL {
        let shape = field.shape(model);
        all.set_item(field.name, answer(py, looks.values(field), &shape, None)?)?;
    }
    Ok(all)
}
