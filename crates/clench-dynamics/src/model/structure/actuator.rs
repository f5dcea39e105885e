//! Actuators: what they pull on, and the kinds of their dynamics, gain and bias.

use super::History;
use std::ops::Range;
use std::sync::Arc;

/// What an actuator pulls on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transmission {
    /// A joint, axes in the child frame.
    Joint(usize),
    /// A joint, axes in the parent frame.
    JointInParent(usize),
    /// A tendon.
    Tendon(usize),
    /// A site: a wrench along its axes.
    Site(usize),
    /// The pose of the first site in the frame of the second.
    SiteInFrame([usize; 2]),
    /// The slider of a slider-crank, by the site of the crank's pin and the one whose axis z the slider moves along.
    SliderCrank([usize; 2]),
    /// The contacts of a body.
    Body(usize),
    /// The rotation of a ball joint about all axes of the child.
    Rotation(usize),
    /// The rotation of the first site in the frame of the second, about all axes of the first.
    RotationInFrame([usize; 2]),
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
    /// A direct-current motor; see [`dc_motor`](crate::dynamics::dc_motor).
    DcMotor,
    /// The states of a PID controller; see [`pid`](crate::dynamics::pid).
    Pid,
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
    /// Torque of a direct-current motor's current.
    DcMotor,
    /// Setpoints of a PID controller.
    Pid,
    /// Stiffness of an orientation servo; see [`orientation`](crate::dynamics::orientation).
    So3,
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
    /// Back-EMF, cogging and friction of a direct-current motor.
    DcMotor,
    /// Damping of an orientation servo.
    So3,
    /// MuJoCo leaves it to a callback; without one it is zero.
    User,
}

/// What a control of an actuator is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ControlInput {
    /// What the gain multiplies.
    Command,
    /// A position that a controller goes for.
    Position,
    /// A velocity that it goes for.
    Velocity,
    /// A force or torque that it adds.
    Feedforward,
    /// The voltage at the terminals of a motor, beside its controller's.
    Voltage,
    /// A part of the rotation vector that an orientation servo goes for.
    RotationVector,
    /// A part of the quaternion that it goes for.
    Quaternion,
}

/// Which activations hold a state of a controller or motor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ControllerStates {
    /// The first control as it acts, where its rate is limited.
    pub slew: Option<usize>,
    /// The integral of the position error.
    pub integral: Option<usize>,
    /// The temperature of a motor's winding above the ambient one, K.
    pub temperature: Option<usize>,
    /// The deflection of the bristles of LuGre friction.
    pub bristle: Option<usize>,
    /// The current of a motor, A.
    pub current: Option<usize>,
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
    /// Its lengths, velocities and forces: one, but for orientation servos.
    pub outputs: Range<usize>,
    /// Its gain.
    pub gain: GainKind,
    /// Its bias.
    pub bias: BiasKind,
    /// Which activations are states of its controller or motor.
    pub states: ControllerStates,
    /// Its controls.
    pub controls: Range<usize>,
    /// What each of them is.
    pub inputs: Vec<ControlInput>,
    /// Which of them are clamped.
    pub ctrllimited: Vec<bool>,
    /// The buffer of its past controls.
    pub history: Option<History>,
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
    /// The user's own numbers, as many for each element of its kind.
    pub user: Arc<[f64]>,
}

impl Actuator {
    /// The activation that acts, if it has any.
    #[inline(always)]
    pub fn act(&self) -> Option<usize> {
        self.acts.clone().last()
    }
}
