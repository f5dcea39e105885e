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

macro_rules! kinds {
    ($($(#[$doc:meta])* $name:ident of $oracle:literal { $($(#[$item:meta])* $kind:ident $keyword:literal $number:literal;)* })*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub enum $name {
            $($(#[$item])* $kind,)*
        }

        impl $name {
            /// Every kind.
            pub const ALL: &[$name] = &[$($name::$kind),*];

            /// Returns its keyword in MJCF.
            pub fn name(self) -> &'static str {
                match self { $($name::$kind => $keyword,)* }
            }
            #[doc = concat!("Returns its number in MuJoCo, `", $oracle, "`.")]
            pub fn number(self) -> i32 {
                match self { $($name::$kind => $number,)* }
            }
        }
    )*};
}

kinds! {
    /// The activation dynamics.
    DynamicsKind of "mjtDyn" {
        /// No activation: the control acts directly.
        #[default]
        None "none" 0;
        /// ȧ = control.
        Integrator "integrator" 1;
        /// ȧ = (control − a) / timeconst.
        Filter "filter" 2;
        /// As `Filter`, integrated exactly.
        FilterExact "filterexact" 3;
        /// A filter that rises and falls with different time constants; see [`muscle`](crate::dynamics::muscle).
        Muscle "muscle" 4;
        /// A direct-current motor; see [`dc_motor`](crate::dynamics::dc_motor).
        DcMotor "dcmotor" 5;
        /// The states of a PID controller; see [`pid`](crate::dynamics::pid).
        Pid "pid" 6;
        /// A user callback in MuJoCo; without one activations are constant.
        User "user" 7;
    }
    /// Gain of an actuator.
    GainKind of "mjtGain" {
        /// `gainprm[0]`.
        #[default]
        Fixed "fixed" 0;
        /// `gainprm[0] + gainprm[1] · length + gainprm[2] · velocity`.
        Affine "affine" 1;
        /// Active force of a muscle by length and velocity.
        Muscle "muscle" 2;
        /// Torque constant of a direct-current motor.
        DcMotor "dcmotor" 3;
        /// Setpoints of a PID controller.
        Pid "pid" 5;
        /// Stiffness of an orientation servo; see [`orientation`](crate::dynamics::orientation).
        So3 "so3" 4;
        /// A user callback in MuJoCo; without one it is 1.
        User "user" 6;
    }
    /// Bias of an actuator.
    BiasKind of "mjtBias" {
        /// None.
        #[default]
        None "none" 0;
        /// `biasprm[0] + biasprm[1] · length + biasprm[2] · velocity`.
        Affine "affine" 1;
        /// Passive force of a muscle by length.
        Muscle "muscle" 2;
        /// Back-EMF, cogging and friction of a direct-current motor.
        DcMotor "dcmotor" 3;
        /// Damping of an orientation servo.
        So3 "so3" 4;
        /// A user callback in MuJoCo; without one it is zero.
        User "user" 5;
    }
}

impl GainKind {
    /// Returns true if the actuator turns a rotation by a torque of three parts; other gains have one force.
    pub fn is_rotation(self) -> bool {
        match self {
            GainKind::So3 => true,
            GainKind::Fixed
            | GainKind::Affine
            | GainKind::Muscle
            | GainKind::DcMotor
            | GainKind::Pid
            | GainKind::User => false,
        }
    }
}

impl BiasKind {
    /// Returns true if the bias is a restoring spring of the gain's stiffness, which may be damped by a ratio.
    pub fn pulls_back(self, gain: GainKind, gainprm: &[f64; 10], biasprm: &[f64; 10]) -> bool {
        match self {
            BiasKind::Affine | BiasKind::So3 => gain == GainKind::Pid || gainprm[0] == -biasprm[1],
            BiasKind::None | BiasKind::Muscle | BiasKind::DcMotor | BiasKind::User => false,
        }
    }
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
