//! Actuators: what they pull on, and the kinds of their dynamics, gain and bias.

use std::ops::Range;

/// What an actuator pulls on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transmission {
    /// A joint, axes in the child frame.
    Joint(usize),
    /// A joint, axes in the parent frame.
    JointInParent(usize),
    /// A fixed tendon.
    Tendon(usize),
}

/// How a control becomes an activation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DynamicsKind {
    /// No activation: the control acts directly.
    #[default]
    None,
    /// ȧ = control.
    Integrator,
    /// ȧ = (control − a) / timeconst.
    Filter,
    /// As `Filter`, integrated exactly.
    FilterExact,
    /// A filter that rises and falls with different time constants; see [`muscle`](crate::dynamics::muscle).
    Muscle,
    /// MuJoCo leaves it to a callback; without one activations stay as they are.
    User,
}

/// Gain of an actuator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GainKind {
    /// `gainprm[0]`.
    #[default]
    Fixed,
    /// `gainprm[0] + gainprm[1] · length + gainprm[2] · velocity`.
    Affine,
    /// Active force of a muscle by length and velocity.
    Muscle,
    /// MuJoCo leaves it to a callback; without one it is 1.
    User,
}

/// Bias of an actuator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BiasKind {
    /// None.
    #[default]
    None,
    /// `biasprm[0] + biasprm[1] · length + biasprm[2] · velocity`.
    Affine,
    /// Passive force of a muscle by length.
    Muscle,
    /// MuJoCo leaves it to a callback; without one it is zero.
    User,
}

/// An actuator.
#[derive(Clone, Debug)]
pub struct Actuator {
    /// Name, possibly empty.
    pub name: String,
    /// What it pulls on.
    pub transmission: Transmission,
    /// Its dynamics.
    pub dynamics: DynamicsKind,
    /// Its activations; the last one acts.
    pub acts: Range<usize>,
    /// Its gain.
    pub gain: GainKind,
    /// Its bias.
    pub bias: BiasKind,
    /// Its control is clamped.
    pub ctrllimited: bool,
    /// Its force is clamped.
    pub forcelimited: bool,
    /// Its activation is clamped.
    pub actlimited: bool,
    /// The activation as of the end of the step acts.
    pub actearly: bool,
    /// Switched off by its group.
    pub disabled: bool,
    /// Group.
    pub group: i32,
}

impl Actuator {
    /// The activation that acts, if it has any.
    #[inline(always)]
    pub fn act(&self) -> Option<usize> {
        self.acts.clone().last()
    }
}
