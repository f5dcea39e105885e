//! Actuators: their transmissions, and the kinds of their dynamics, gain and bias.

use super::History;
use std::ops::Range;
use std::sync::Arc;

/// The transmission of an actuator.
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
    /// The slider of a slider-crank, given by the site of the crank's pin and the site whose z axis the slider moves
    /// along.
    SliderCrank([usize; 2]),
    /// The contacts of a body.
    Body(usize),
    /// The rotation of a ball joint about all axes of the child.
    Rotation(usize),
    /// The rotation of the first site in the frame of the second, about all axes of the first.
    RotationInFrame([usize; 2]),
}

impl Transmission {
    /// Returns the joint of a transmission to the coordinate, rotation vector or wrench of one, in either frame.
    #[inline(always)]
    pub fn joint(self) -> Option<usize> {
        match self {
            Transmission::Joint(j) | Transmission::JointInParent(j) => Some(j),
            Transmission::Tendon(_)
            | Transmission::Site(_)
            | Transmission::SiteInFrame(_)
            | Transmission::SliderCrank(_)
            | Transmission::Body(_)
            | Transmission::Rotation(_)
            | Transmission::RotationInFrame(_) => None,
        }
    }

    /// Returns the tendon of a transmission to one.
    #[inline(always)]
    pub fn tendon(self) -> Option<usize> {
        match self {
            Transmission::Tendon(t) => Some(t),
            Transmission::Joint(_)
            | Transmission::JointInParent(_)
            | Transmission::Site(_)
            | Transmission::SiteInFrame(_)
            | Transmission::SliderCrank(_)
            | Transmission::Body(_)
            | Transmission::Rotation(_)
            | Transmission::RotationInFrame(_) => None,
        }
    }
}

/// The activation dynamics.
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
    /// A user callback in MuJoCo; without one activations are constant.
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
    /// Torque constant of a direct-current motor.
    DcMotor,
    /// Setpoints of a PID controller.
    Pid,
    /// Stiffness of an orientation servo; see [`orientation`](crate::dynamics::orientation).
    So3,
    /// A user callback in MuJoCo; without one it is 1.
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
    /// A user callback in MuJoCo; without one it is zero.
    User,
}

/// The meaning of a control of an actuator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ControlInput {
    /// The input of the gain.
    Command,
    /// The target position of a controller.
    Position,
    /// Its target velocity.
    Velocity,
    /// A force or torque that it adds.
    Feedforward,
    /// The terminal voltage of a motor, in addition to its controller's.
    Voltage,
    /// A component of the target rotation vector of an orientation servo.
    RotationVector,
    /// A component of its target quaternion.
    Quaternion,
}

/// The activations that are states of a controller or motor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ControllerStates {
    /// The effective first control, if its rate is limited.
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
    /// Its transmission.
    pub transmission: Transmission,
    /// Its dynamics.
    pub dynamics: DynamicsKind,
    /// Its activations; the last one is the effective one.
    pub acts: Range<usize>,
    /// Its lengths, velocities and forces: one, except for orientation servos.
    pub outputs: Range<usize>,
    /// Its gain.
    pub gain: GainKind,
    /// Its bias.
    pub bias: BiasKind,
    /// The activations that are states of its controller or motor.
    pub states: ControllerStates,
    /// Its controls.
    pub controls: Range<usize>,
    /// The meaning of each control.
    pub inputs: Vec<ControlInput>,
    /// True for each control that is clamped.
    pub ctrllimited: Vec<bool>,
    /// The buffer of its past controls.
    pub history: Option<History>,
    /// True if its force is clamped.
    pub forcelimited: bool,
    /// True if its activation is clamped.
    pub actlimited: bool,
    /// True if the activation at the end of the step is used.
    pub actearly: bool,
    /// True if its group is disabled.
    pub disabled: bool,
    /// Group.
    pub group: i32,
    /// The user's own numbers.
    pub user: Arc<[f64]>,
}

impl Actuator {
    /// Returns the effective activation, if it has any.
    #[inline(always)]
    pub fn act(&self) -> Option<usize> {
        self.acts.clone().last()
    }
}
