//! The directions of derivatives: one for each column of a matrix.

use crate::field::StateField;
use crate::request::Request;
use crate::stage::Stage;
use clench_dynamics::model::ParamField;
use clench_dynamics::{Model, State};

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
    /// A number of another field of the state.
    Number(StateField, usize),
}

impl Direction {
    /// Returns true for motion of the position.
    pub(crate) fn is_position(self) -> bool {
        match self {
            Direction::Position(_) => true,
            Direction::Velocity(_)
            | Direction::Activation(_)
            | Direction::Control(_)
            | Direction::Parameter(..)
            | Direction::Number(..) => false,
        }
    }

    /// Returns the first stage whose results change along the direction.
    pub(crate) fn start(self) -> Stage {
        match self {
            Direction::Position(_) | Direction::Parameter(..) => Stage::Positions,
            Direction::Velocity(_) => Stage::Velocities,
            Direction::Activation(_) | Direction::Control(_) => Stage::Forces,
            Direction::Number(field, _) => match field {
                StateField::History | StateField::QfrcApplied | StateField::XfrcApplied => {
                    Stage::Forces
                }
                StateField::Plastic
                | StateField::StickReferences
                | StateField::StickFriction
                | StateField::MocapPos
                | StateField::MocapQuat => Stage::Positions,
            },
        }
    }
}

/// Lists the directions of a request, and the index of each among the numbers of x, u and p.
pub(crate) fn list(
    model: &Model,
    state: &State<f64>,
    request: &Request,
    out: &mut Vec<(Direction, usize)>,
) {
    out.clear();
    let (nv, na, nu) = (model.nv, model.na, model.nu());
    let nx = request.x_len(model);
    out.extend((0..nv).map(Direction::Position).zip(0..));
    out.extend((0..nv).map(Direction::Velocity).zip(nv..));
    out.extend((0..na).map(Direction::Activation).zip(2 * nv..));
    out.extend((0..nu).map(Direction::Control).zip(nx..));
    let mut first = 2 * nv + na;
    for field in request.memory_fields() {
        let used = field.directions(model, state);
        out.extend(used.map(|i| (Direction::Number(field, i), first + i)));
        first += field.count(model);
    }
    let parameters = request.parameters.iter();
    let parameters = parameters.map(|&(field, index)| Direction::Parameter(field, index));
    let inputs = request.inputs.iter();
    let inputs = inputs.map(|&(field, index)| Direction::Number(field, index));
    out.extend(parameters.chain(inputs).zip(nx + nu..));
}
