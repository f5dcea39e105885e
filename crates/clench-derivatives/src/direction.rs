//! The directions of derivatives: one for each column of a matrix.

use clench_dynamics::Model;
use clench_dynamics::model::ParamField;

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
    /// Returns true if positions, or quantities that depend on them, change along the direction.
    pub(crate) fn moves(self) -> bool {
        match self {
            Direction::Position(_) | Direction::Parameter(..) => true,
            Direction::Velocity(_) | Direction::Activation(_) | Direction::Control(_) => false,
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
