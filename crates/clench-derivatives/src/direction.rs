//! The directions of derivatives: one for each column of a matrix.

use clench_dynamics::Model;
use clench_dynamics::model::ParamField;

/// A stage of a step, with all that follow it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Start {
    Positions,
    Velocities,
    Forces,
}

/// A direction in which the input of a step changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// Motion of the position along a dof.
    Position(usize),
    /// A velocity.
    Velocity(usize),
    /// An activation.
    Activation(usize),
    /// A control.
    Control(usize),
    /// A number of a parameter.
    Parameter(ParamField, usize),
}

impl Direction {
    /// Returns the first stage whose results change along the direction.
    pub(crate) fn start(self) -> Start {
        match self {
            Direction::Position(_) | Direction::Parameter(..) => Start::Positions,
            Direction::Velocity(_) => Start::Velocities,
            Direction::Activation(_) | Direction::Control(_) => Start::Forces,
        }
    }
}

/// Lists the directions of the state, then of the controls, then of parameters.
pub(crate) fn list(model: &Model, parameters: &[(ParamField, usize)], out: &mut Vec<Direction>) {
    out.clear();
    out.extend((0..model.nv).map(Direction::Position));
    out.extend((0..model.nv).map(Direction::Velocity));
    out.extend((0..model.na).map(Direction::Activation));
    out.extend((0..model.nu()).map(Direction::Control));
    let parameters = parameters.iter();
    out.extend(parameters.map(|&(field, index)| Direction::Parameter(field, index)));
}
