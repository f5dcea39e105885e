//! The choice of results and inputs.

use crate::field::StateField;
use crate::reads::Reads;
use clench_dynamics::Model;
use clench_dynamics::model::ParamField;
use clench_rigid::Output;

/// Results to differentiate besides the next state and the sensors, and inputs to differentiate by besides state and
/// controls.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Outputs that follow the sensors in y.
    pub outputs: Vec<Output>,
    /// Numbers of parameters: a field, and the index in its numbers, element after element.
    pub parameters: Vec<(ParamField, usize)>,
    /// Numbers of the state to differentiate by, which follow the parameters in p.
    pub inputs: Vec<(StateField, usize)>,
    /// True if x ends with the other fields that a step changes, [`StateField::MEMORY`].
    pub memory: bool,
    /// True if y has no sensors.
    pub omits_sensors: bool,
    /// True if a linearization also bounds the errors that the solver leaves.
    pub errors: bool,
}

impl Request {
    /// Returns the fields at the end of x.
    pub(crate) fn memory_fields(&self) -> impl Iterator<Item = StateField> {
        let wanted = self.memory;
        StateField::MEMORY.into_iter().filter(move |_| wanted)
    }

    /// Returns what y reads; `None` if the derivatives need passes, as do those of other fields of x and by them, and
    /// bounds of errors.
    pub(crate) fn reads(&self, model: &Model) -> Option<Reads> {
        let permitted = self.x_len(model) == 2 * model.nv + model.na && !self.errors;
        let sensors = match self.omits_sensors {
            true => &[],
            false => &model.sensors[..],
        };
        Reads::new(model, sensors, &self.outputs).filter(|_| permitted)
    }

    /// Returns the length of y.
    pub fn y_len(&self, model: &Model) -> usize {
        let outputs = self.outputs.iter().map(|output| output.width(model));
        self.sensors_len(model) + outputs.sum::<usize>()
    }

    /// Returns the number of sensor values in y.
    pub(crate) fn sensors_len(&self, model: &Model) -> usize {
        match self.omits_sensors {
            true => 0,
            false => model.nsensordata(),
        }
    }

    /// Returns the length of p.
    pub fn p_len(&self) -> usize {
        self.parameters.len() + self.inputs.len()
    }

    /// Returns the length of x.
    pub fn x_len(&self, model: &Model) -> usize {
        let memory = self.memory_fields().map(|field| field.count(model));
        2 * model.nv + model.na + memory.sum::<usize>()
    }
}
