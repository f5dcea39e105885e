//! Actuators: their transmissions, the dynamics of their activations, and the coefficients of their gains and biases.

use super::{ENDLESS, NONE, Tables, starts};
use clench_rigid::model::{
    Actuator, BiasKind, ControlInput, DynamicsKind, GainKind, JointKind, Model, Transmission,
};
use std::f64::consts::TAU;

/// The kinds of transmission.
const TRANSMISSIONS: [&str; 10] = [
    "ON_SCALAR",
    "ON_BALL",
    "ON_FREE",
    "ON_TENDON",
    "ON_SITE",
    "ON_SITE_IN_FRAME",
    "ON_SLIDER_CRANK",
    "ON_CONTACTS",
    "ON_ROTATION",
    "ON_ROTATION_IN_FRAME",
];
/// The kinds of activation dynamics.
const DYNAMICS: [&str; 7] = [
    "DYN_NONE",
    "DYN_INTEGRATOR",
    "DYN_FILTER",
    "DYN_FILTER_EXACT",
    "DYN_MUSCLE",
    "DYN_PID",
    "DYN_DC_MOTOR",
];
/// The kinds of gain and bias.
const LAWS: [&str; 5] = [
    "LAW_AFFINE",
    "LAW_MUSCLE",
    "LAW_PID",
    "LAW_DC_MOTOR",
    "LAW_ORIENTATION",
];
/// The kinds of control input of a controller.
const INPUTS: [&str; 6] = [
    "INPUT_COMMAND",
    "INPUT_POSITION",
    "INPUT_VELOCITY",
    "INPUT_FEEDFORWARD",
    "INPUT_VOLTAGE",
    "INPUT_QUATERNION",
];
/// The states of controllers and motors.
const STATES: [&str; 5] = [
    "STATE_SLEW",
    "STATE_INTEGRAL",
    "STATE_TEMPERATURE",
    "STATE_BRISTLE",
    "STATE_CURRENT",
];
/// The numbers of a law: three coefficients, or those of a muscle.
const LAW_SIZE: usize = 9;
/// The minimum time constant (s) of a filter, and the minimum divisor (MuJoCo's `mjMINVAL`).
const TINY: f64 = 1e-15;

impl Tables {
    pub(super) fn actuators(&mut self, m: &Model) {
        for names in [&TRANSMISSIONS[..], &DYNAMICS, &LAWS, &INPUTS, &STATES] {
            for (code, name) in names.iter().enumerate() {
                self.constant(name, code);
            }
        }
        let count = m.actuators.len();
        self.count("NU", count);
        self.count("NA", m.na);
        self.flag("ANY_ACTIVATION", m.na > 0);
        self.flag("ACTUATION", m.flags.actuation && count > 0);
        let outputs = || 0..m.nout();
        self.count("NOUT", m.nout());
        let servo = |a: &Actuator| a.gain == GainKind::So3;
        self.flag("ANY_ORIENTATION", m.actuators.iter().any(servo));
        let of_each = m.actuators.iter().map(|a| a.outputs.len());
        self.words("ACTUATOR_OUTPUT", starts(of_each));
        self.words(
            "ACTUATOR_ROW",
            starts(outputs().map(|o| m.actuator_dofs.dofs(o).len())),
        );
        let dofs = outputs().flat_map(|o| m.actuator_dofs.dofs(o));
        self.words("ACTUATOR_DOF", dofs.map(|&dof| dof as usize));
        self.arms_of_dofs(m);
        self.transmissions(m);
        self.activations(m);
        self.controllers(m);
        self.delays(m);
        self.gains(m);
        self.actuator_ranges(m);
    }

    /// Adds the moment arms on each dof, and the output of each.
    fn arms_of_dofs(&mut self, m: &Model) {
        let mut arms = vec![Vec::new(); m.nv];
        let mut entry = 0;
        for output in 0..m.nout() {
            for &dof in m.actuator_dofs.dofs(output) {
                arms[dof as usize].push((entry, output));
                entry += 1;
            }
        }
        self.words("DOF_ARM", starts(arms.iter().map(Vec::len)));
        let arms = arms.concat();
        self.words("ARM_ENTRY", arms.iter().map(|&(entry, _)| entry));
        self.words("ARM_OUTPUT", arms.iter().map(|&(_, output)| output));
    }

    fn transmissions(&mut self, m: &Model) {
        let each = || m.actuators.iter().map(|a| target(m, a));
        // Kernels omit what no actuator needs.
        self.flag("ANY_ON_ROTATION", each().any(|t| (1..3).contains(&t.kind)));
        self.flag("ANY_ON_TENDON", each().any(|t| t.kind == 3));
        self.flag("ANY_ON_SITE", each().any(|t| (4..7).contains(&t.kind)));
        self.flag("ANY_ON_CONTACTS", each().any(|t| t.kind == 7));
        self.words("ACTUATOR_ON", each().map(|t| t.kind));
        self.words("ACTUATOR_TARGET", each().flat_map(|t| t.elements));
        self.words(
            "ACTUATOR_IN_PARENT",
            each().map(|t| usize::from(t.in_parent)),
        );
        let p = &m.params;
        self.numbers("ACTUATOR_GEAR", p.actuator_gear.iter().copied().flatten());
        self.numbers("ACTUATOR_ROD", p.actuator_cranklength.iter().copied());
        let turns = (0..m.actuators.len()).map(|u| whole_turn(m, u));
        self.numbers("ACTUATOR_TURN", turns);
    }

    fn activations(&mut self, m: &Model) {
        let (p, each) = (&m.params, || m.actuators.iter());
        let kind = |a: &Actuator| match a.dynamics {
            DynamicsKind::Integrator => 1,
            DynamicsKind::Filter => 2,
            DynamicsKind::FilterExact => 3,
            DynamicsKind::Muscle => 4,
            DynamicsKind::Pid => 5,
            DynamicsKind::DcMotor => 6,
            DynamicsKind::None | DynamicsKind::User => 0,
        };
        let muscle = |a: &Actuator| {
            let law = a.gain == GainKind::Muscle || a.bias == BiasKind::Muscle;
            law || a.dynamics == DynamicsKind::Muscle
        };
        self.flag("ANY_MUSCLE", each().any(muscle));
        self.words("ACTUATOR_DYNAMICS", each().map(kind));
        self.words(
            "ACTUATOR_ACT",
            each().map(|a| a.act().unwrap_or(NONE as usize)),
        );
        let owners = each().enumerate();
        let owners = owners.flat_map(|(u, a)| a.acts.clone().map(move |_| u));
        self.words("ACT_ACTUATOR", owners);
        self.words("ACTUATOR_EARLY", each().map(|a| usize::from(a.actearly)));
        self.words("ACTUATOR_OFF", each().map(|a| usize::from(a.disabled)));
        self.words(
            "ACTUATOR_SERVO",
            each().map(|a| usize::from(a.gain == GainKind::Fixed)),
        );
        self.words("ACTUATOR_CTRL", starts(each().map(|a| a.controls.len())));
        let prm = p
            .actuator_dynprm
            .iter()
            .flat_map(|prm| [prm[0], prm[1], prm[2]]);
        self.numbers("DYNAMICS_PRM", prm);
        let range = |(u, a): (usize, &Actuator)| range(a.actlimited, p.actuator_actrange[u]);
        self.numbers("ACT_RANGE", each().enumerate().flat_map(range));
    }

    /// Adds controllers and motors: the kind of each control, the activations that are states, and all parameters.
    fn controllers(&mut self, m: &Model) {
        let (p, each) = (&m.params, || m.actuators.iter());
        let input = |input: &ControlInput| match input {
            ControlInput::Position => 1,
            ControlInput::Velocity => 2,
            ControlInput::Feedforward => 3,
            ControlInput::Voltage => 4,
            ControlInput::Quaternion => 5,
            ControlInput::Command | ControlInput::RotationVector => 0,
        };
        self.words(
            "CONTROL_INPUT",
            each().flat_map(|a| a.inputs.iter().map(input)),
        );
        let controls = |kind: &ControlInput| matches!(input(kind), 1..4);
        let controlled = |a: &Actuator| usize::from(a.inputs.iter().any(controls));
        self.words("ACTUATOR_CONTROLLED", each().map(controlled));
        let states = |a: &Actuator| {
            let s = a.states;
            let all = [s.slew, s.integral, s.temperature, s.bristle, s.current];
            all.map(|state| state.unwrap_or(NONE as usize))
        };
        self.words("ACTUATOR_STATES", each().flat_map(states));
        let all =
            Vec::from_iter((0..m.actuators.len()).filter(|&u| has_controller(&m.actuators[u])));
        self.flag("ANY_CONTROLLER", !all.is_empty());
        let place = |u: usize| all.binary_search(&u).unwrap_or(NONE as usize);
        self.words("ACTUATOR_CONTROLLER", (0..m.actuators.len()).map(place));
        let prm = |&u: &usize| {
            [
                p.actuator_dynprm[u],
                p.actuator_gainprm[u],
                p.actuator_biasprm[u],
            ]
        };
        self.numbers("CONTROLLER_PRM", all.iter().flat_map(prm).flatten());
    }

    /// Adds buffers of past controls, and the delays of actuators.
    fn delays(&mut self, m: &Model) {
        let delayed = |a: &Actuator| a.history.is_some();
        self.flag("ANY_DELAY", m.actuators.iter().any(delayed));
        let buffers = m.actuators.iter().map(|a| a.history.as_ref());
        let places = self.histories("ACTUATOR_HISTORIES", buffers);
        self.words("ACTUATOR_HISTORY", places);
        let delays = m.params.actuator_delay.iter().copied();
        self.numbers("ACTUATOR_DELAY", delays);
    }

    fn gains(&mut self, m: &Model) {
        let (p, each) = (&m.params, || m.actuators.iter().enumerate());
        self.constant("LAW_SIZE", LAW_SIZE);
        let gain_law = |a: &Actuator| match a.gain {
            GainKind::Muscle => 1,
            GainKind::Pid => 2,
            GainKind::DcMotor => 3,
            GainKind::So3 => 4,
            GainKind::Fixed | GainKind::Affine | GainKind::User => 0,
        };
        self.words("GAIN_LAW", each().map(|(_, a)| gain_law(a)));
        let bias_law = |a: &Actuator| match a.bias {
            BiasKind::Muscle => 1,
            BiasKind::DcMotor => 3,
            BiasKind::None | BiasKind::Affine | BiasKind::So3 | BiasKind::User => 0,
        };
        self.words("BIAS_LAW", each().map(|(_, a)| bias_law(a)));
        let gain = |(u, a): (usize, &Actuator)| {
            let prm = &p.actuator_gainprm[u];
            match a.gain {
                GainKind::Muscle => muscle(m, u, prm),
                GainKind::Affine => affine([prm[0], prm[1], prm[2]]),
                // MuJoCo's default without a callback.
                GainKind::User => affine([1.0, 0.0, 0.0]),
                _ => affine([prm[0], 0.0, 0.0]),
            }
        };
        let bias = |(u, a): (usize, &Actuator)| {
            let prm = &p.actuator_biasprm[u];
            match a.bias {
                BiasKind::Muscle => muscle(m, u, prm),
                BiasKind::Affine => affine([prm[0], prm[1], prm[2]]),
                BiasKind::So3 => affine([prm[0], 0.0, prm[2]]),
                _ => affine([0.0; 3]),
            }
        };
        self.numbers("ACTUATOR_GAIN", each().flat_map(gain));
        self.numbers("ACTUATOR_BIAS", each().flat_map(bias));
    }

    fn actuator_ranges(&mut self, m: &Model) {
        let (p, each) = (&m.params, || m.actuators.iter().enumerate());
        let limited = each().flat_map(|(_, a)| &a.ctrllimited);
        let ctrl = limited.zip(&p.actuator_ctrlrange);
        let ctrl = ctrl.flat_map(|(&limited, &ends)| range(limited && m.flags.clampctrl, ends));
        self.numbers("CTRL_RANGE", ctrl);
        let force = each().flat_map(|(u, a)| range(a.forcelimited, p.actuator_forcerange[u]));
        self.numbers("FORCE_RANGE", force);
        let of_tendon = |a: &Actuator| match a.transmission {
            Transmission::Tendon(t) if m.tendons[t].actfrclimited => t,
            _ => NONE as usize,
        };
        self.words("ACTUATOR_LIMITED_TENDON", each().map(|(_, a)| of_tendon(a)));
        self.numbers(
            "TENDON_FORCE_RANGE",
            p.tendon_actfrcrange.iter().copied().flatten(),
        );
        let dofs = m.dofs.iter().enumerate().flat_map(|(i, dof)| {
            let joint = &m.joints[dof.joint];
            let limited = joint.actfrclimited && joint.dof == i && !m.actuators.is_empty();
            range(limited && m.flags.actuation, p.jnt_actfrcrange[dof.joint])
        });
        self.numbers("DOF_FORCE_RANGE", dofs);
        let lifted = m
            .dofs
            .iter()
            .map(|dof| usize::from(m.joints[dof.joint].actgravcomp));
        self.words("DOF_ACTGRAVCOMP", lifted);
    }
}

/// Returns true if any part of an actuator is that of a controller or a motor.
fn has_controller(a: &Actuator) -> bool {
    let by_dynamics = matches!(a.dynamics, DynamicsKind::Pid | DynamicsKind::DcMotor);
    let by_gain = matches!(a.gain, GainKind::Pid | GainKind::DcMotor);
    by_dynamics || by_gain || a.bias == BiasKind::DcMotor
}

/// The target of an actuator, in the device's encoding.
struct Target {
    kind: usize,
    elements: [usize; 2],
    in_parent: bool,
}

fn target(m: &Model, actuator: &Actuator) -> Target {
    let joint = |j: usize, in_parent| Target {
        kind: match m.joints[j].kind {
            JointKind::Hinge | JointKind::Slide => 0,
            JointKind::Ball => 1,
            JointKind::Free => 2,
        },
        elements: [j, 0],
        in_parent,
    };
    let other = |kind, elements| Target {
        kind,
        elements,
        in_parent: false,
    };
    match actuator.transmission {
        Transmission::Joint(j) => joint(j, false),
        Transmission::JointInParent(j) => joint(j, true),
        Transmission::Tendon(t) => other(3, [t, 0]),
        Transmission::Site(site) => other(4, [site, 0]),
        Transmission::SiteInFrame(sites) => other(5, sites),
        Transmission::SliderCrank(sites) => other(6, sites),
        Transmission::Body(body) => other(7, [body, 0]),
        Transmission::Rotation(j) => other(8, [j, 0]),
        Transmission::RotationInFrame(sites) => other(9, sites),
    }
}

/// Returns the length change of a servo on a circle in a full turn; zero for other actuators. See
/// `dynamics/setpoint.rs`.
fn whole_turn(m: &Model, u: usize) -> f64 {
    let (actuator, p) = (&m.actuators[u], &m.params);
    let length = |axis: &[f64]| axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let gear = &p.actuator_gear[u];
    let (rotates, axis) = match actuator.transmission {
        Transmission::Joint(j) | Transmission::JointInParent(j) => {
            (m.joints[j].kind == JointKind::Ball, &gear[..3])
        }
        Transmission::SiteInFrame(_) => (length(&gear[..3]) == 0.0, &gear[3..]),
        _ => (false, &gear[..3]),
    };
    let fixed = actuator.gain == GainKind::Fixed && actuator.bias == BiasKind::Affine;
    let pulls_back = p.actuator_gainprm[u][0] == -p.actuator_biasprm[u][1];
    if rotates && (actuator.gain == GainKind::Pid || fixed && pulls_back) {
        TAU * length(axis)
    } else {
        0.0
    }
}

fn range(limited: bool, range: [f64; 2]) -> [f64; 2] {
    if limited { range } else { [-ENDLESS, ENDLESS] }
}

/// Returns the coefficients of a + b length + c velocity.
fn affine([a, b, c]: [f64; 3]) -> [f64; LAW_SIZE] {
    [a, b, c, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
}

/// Returns the constants of a muscle: its strength, its resting length, the start of its scaled length, and the shape
/// of its curves. See `dynamics/muscle.rs`.
fn muscle(m: &Model, u: usize, prm: &[f64; 10]) -> [f64; LAW_SIZE] {
    let [low, high, force, scale, lmin, lmax, vmax, fpmax, fvmax, _] = *prm;
    let [shortest, longest] = m.params.actuator_lengthrange[u];
    let resting = (longest - shortest) / (high - low).max(TINY);
    let derived = scale / m.params.actuator_acc0[u].max(TINY);
    let peak = if force < 0.0 { derived } else { force };
    let resting = resting.max(TINY);
    [
        peak,
        resting,
        low - shortest / resting,
        lmin,
        lmax,
        vmax,
        fpmax,
        fvmax,
        0.0,
    ]
}
