//! Numbers of the state besides positions, velocities, activations and controls.

use clench_dynamics::state::FIELDS;
use clench_dynamics::state::kind::StickReference;
use clench_dynamics::{Model, State};
use clench_math::Real;

/// A field of the state whose numbers can be inputs of a linearized step, or a part of x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "fields of `State` have the same names")]
pub enum StateField {
    Plastic,
    History,
    StickReferences,
    StickFriction,
    QfrcApplied,
    XfrcApplied,
    MocapPos,
    MocapQuat,
}

/// The numbers of a stick reference: two geoms, then a pose.
const REFERENCE: usize = 9;

impl StateField {
    /// The fields that a step changes, in the order of x.
    pub const MEMORY: [StateField; 4] = [
        StateField::Plastic,
        StateField::History,
        StateField::StickReferences,
        StateField::StickFriction,
    ];
    /// The fields that a user sets.
    pub const INPUTS: [StateField; 4] = [
        StateField::QfrcApplied,
        StateField::XfrcApplied,
        StateField::MocapPos,
        StateField::MocapQuat,
    ];

    /// Returns the name of the field in [`State`] and in Python.
    pub fn name(self) -> &'static str {
        match self {
            StateField::Plastic => "plastic",
            StateField::History => "history",
            StateField::StickReferences => "stick_references",
            StateField::StickFriction => "stick_friction",
            StateField::QfrcApplied => "qfrc_applied",
            StateField::XfrcApplied => "xfrc_applied",
            StateField::MocapPos => "mocap_pos",
            StateField::MocapQuat => "mocap_quat",
        }
    }

    /// Returns the number of numbers of the field in a model.
    pub fn count(self, model: &Model) -> usize {
        let mut fields = FIELDS.iter().filter(|field| field.name == self.name());
        fields.next().map_or(0, |field| field.numbers(model))
    }

    /// Returns the numbers of the field whose columns can differ from zero: of stick references, those of the poses in
    /// the slots in use, which come first.
    pub(crate) fn directions(
        self,
        model: &Model,
        state: &State<f64>,
    ) -> impl Iterator<Item = usize> {
        let in_use = |slot: &&StickReference<f64>| slot.first != 0.0;
        let (count, geoms) = match self {
            StateField::StickReferences => {
                let slots = state.stick_references.iter().take_while(in_use);
                (REFERENCE * slots.count(), 2)
            }
            StateField::Plastic
            | StateField::History
            | StateField::StickFriction
            | StateField::QfrcApplied
            | StateField::XfrcApplied
            | StateField::MocapPos
            | StateField::MocapQuat => (self.count(model), 0),
        };
        (0..count).filter(move |i| i % REFERENCE >= geoms)
    }

    /// Returns one of the numbers of the field.
    ///
    /// # Panics
    /// Panics if the field has no such number.
    pub fn number<T: Real>(self, state: &mut State<T>, index: usize) -> &mut T {
        match self {
            StateField::Plastic => &mut state.plastic[index],
            StateField::History => &mut state.history[index],
            StateField::StickReferences => {
                let slot = &mut state.stick_references[index / REFERENCE];
                let (position, rotation) = (&mut slot.position, &mut slot.rotation);
                let parts: [&mut T; REFERENCE] = [
                    &mut slot.first,
                    &mut slot.second,
                    &mut position.x,
                    &mut position.y,
                    &mut position.z,
                    &mut rotation.w,
                    &mut rotation.x,
                    &mut rotation.y,
                    &mut rotation.z,
                ];
                pick(parts, index)
            }
            StateField::StickFriction => &mut state.stick_friction[index],
            StateField::QfrcApplied => &mut state.qfrc_applied[index],
            StateField::XfrcApplied => {
                let wrench = &mut state.xfrc_applied[index / 6];
                let (force, torque) = (&mut wrench.linear, &mut wrench.angular);
                let parts = [
                    &mut force.x,
                    &mut force.y,
                    &mut force.z,
                    &mut torque.x,
                    &mut torque.y,
                    &mut torque.z,
                ];
                pick(parts, index)
            }
            StateField::MocapPos => {
                let position = &mut state.mocap_pos[index / 3];
                pick([&mut position.x, &mut position.y, &mut position.z], index)
            }
            StateField::MocapQuat => {
                let q = &mut state.mocap_quat[index / 4];
                pick([&mut q.w, &mut q.x, &mut q.y, &mut q.z], index)
            }
        }
    }
}

/// Returns the part of an element that holds the number `index` of its field.
fn pick<T, const N: usize>(parts: [&mut T; N], index: usize) -> &mut T {
    let mut part = parts.into_iter().skip(index % N);
    part.next().expect("index % N < N")
}
