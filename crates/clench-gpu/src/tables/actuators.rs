//! Actuators: their transmissions, the dynamics of their activations, their controllers and their ranges.

use super::{ENDLESS, NONE, Tables, starts};
use crate::codes::{Code, codes, row};
use clench_rigid::dynamics::setpoint::whole_turn;
use clench_rigid::model::{
    Actuator, BiasKind, ControlInput, ControllerStates, DynamicsKind, GainKind, JointKind, Model,
    Transmission,
};

codes! {
    /// The transmissions of the kernels, which compare them in this order: joints, tendons, sites, contacts, rotations.
    enum On {
        /// A slide or hinge joint.
        Scalar = "ON_SCALAR",
        Ball = "ON_BALL",
        Free = "ON_FREE",
        Tendon = "ON_TENDON",
        Site = "ON_SITE",
        SiteInFrame = "ON_SITE_IN_FRAME",
        SliderCrank = "ON_SLIDER_CRANK",
        Contacts = "ON_CONTACTS",
        Rotation = "ON_ROTATION",
        RotationInFrame = "ON_ROTATION_IN_FRAME",
    }
}
codes! {
    of DynamicsKind {
        None = "DYN_NONE",
        Integrator = "DYN_INTEGRATOR",
        Filter = "DYN_FILTER",
        FilterExact = "DYN_FILTER_EXACT",
        Muscle = "DYN_MUSCLE",
        DcMotor = "DYN_DC_MOTOR",
        Pid = "DYN_PID",
        User = "DYN_USER",
    }
}
codes! {
    of ControlInput {
        Command = "INPUT_COMMAND",
        Position = "INPUT_POSITION",
        Velocity = "INPUT_VELOCITY",
        Feedforward = "INPUT_FEEDFORWARD",
        Voltage = "INPUT_VOLTAGE",
        RotationVector = "INPUT_ROTATION_VECTOR",
        Quaternion = "INPUT_QUATERNION",
    }
}
row! {
    /// The activations that are states of a controller or motor, or `NONE`.
    words StateWords, "STATE" {
        slew,
        integral,
        temperature,
        bristle,
        current,
    }
}
row! {
    /// The parameters of an actuator with a controller or motor.
    numbers ControllerNumbers, "CONTROLLER" {
        dynamics: 10,
        gain: 10,
        bias: 10,
    }
}
impl Tables {
    pub(super) fn actuators(&mut self, m: &Model) {
        self.codes::<On>();
        self.codes::<DynamicsKind>();
        self.codes::<ControlInput>();
        self.row::<StateWords>();
        self.row::<ControllerNumbers>();
        let count = m.actuators.len();
        self.count("NU", count);
        self.count("NA", m.na);
        self.flag("ANY_ACTIVATION", m.na > 0);
        self.flag("ACTUATION", m.flags.actuation && count > 0);
        let outputs = || 0..m.nout();
        self.count("NOUT", m.nout());
        let servo = |a: &Actuator| a.gain.is_rotation();
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
        let any = |kinds: &[On]| each().any(|t| kinds.contains(&t.kind));
        let sites = [On::Site, On::SiteInFrame, On::SliderCrank];
        self.flag("ANY_ON_ROTATION", any(&[On::Ball, On::Free]));
        self.flag("ANY_ON_TENDON", any(&[On::Tendon]));
        self.flag("ANY_ON_SITE", any(&sites));
        self.flag("ANY_ON_CONTACTS", any(&[On::Contacts]));
        self.words("ACTUATOR_ON", each().map(|t| t.kind.code()));
        self.words("ACTUATOR_TARGET", each().flat_map(|t| t.elements));
        self.words(
            "ACTUATOR_IN_PARENT",
            each().map(|t| usize::from(t.in_parent)),
        );
        let p = &m.params;
        self.numbers("ACTUATOR_GEAR", p.actuator_gear.iter().copied().flatten());
        self.numbers("ACTUATOR_ROD", p.actuator_cranklength.iter().copied());
        let turns = (0..m.actuators.len()).map(|u| whole_turn(m, p, u));
        self.numbers("ACTUATOR_TURN", turns);
    }

    fn activations(&mut self, m: &Model) {
        let (p, each) = (&m.params, || m.actuators.iter());
        let muscle = |a: &Actuator| {
            let law = a.gain == GainKind::Muscle || a.bias == BiasKind::Muscle;
            law || a.dynamics == DynamicsKind::Muscle
        };
        self.flag("ANY_MUSCLE", each().any(muscle));
        self.words("ACTUATOR_DYNAMICS", each().map(|a| a.dynamics.code()));
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
        self.words(
            "CONTROL_INPUT",
            each().flat_map(|a| a.inputs.iter().map(|input| input.code())),
        );
        let controls = |kind: &ControlInput| match kind {
            ControlInput::Position | ControlInput::Velocity | ControlInput::Feedforward => true,
            ControlInput::Command
            | ControlInput::Voltage
            | ControlInput::RotationVector
            | ControlInput::Quaternion => false,
        };
        let controlled = |a: &Actuator| usize::from(a.inputs.iter().any(controls));
        self.words("ACTUATOR_CONTROLLED", each().map(controlled));
        let states = |a: &Actuator| {
            let ControllerStates {
                slew,
                integral,
                temperature,
                bristle,
                current,
            } = a.states;
            let act = |state: Option<usize>| state.unwrap_or(NONE as usize);
            let row = StateWords {
                slew: act(slew),
                integral: act(integral),
                temperature: act(temperature),
                bristle: act(bristle),
                current: act(current),
            };
            row.words()
        };
        self.words("ACTUATOR_STATES", each().flat_map(states));
        let all =
            Vec::from_iter((0..m.actuators.len()).filter(|&u| has_controller(&m.actuators[u])));
        self.flag("ANY_CONTROLLER", !all.is_empty());
        let controller = |u: usize| all.binary_search(&u).unwrap_or(NONE as usize);
        self.words(
            "ACTUATOR_CONTROLLER",
            (0..m.actuators.len()).map(controller),
        );
        let prm = |&u: &usize| {
            let row = ControllerNumbers {
                dynamics: p.actuator_dynprm[u],
                gain: p.actuator_gainprm[u],
                bias: p.actuator_biasprm[u],
            };
            row.numbers()
        };
        self.numbers("CONTROLLER_PRM", all.iter().flat_map(prm));
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

    fn actuator_ranges(&mut self, m: &Model) {
        let (p, each) = (&m.params, || m.actuators.iter().enumerate());
        let limited = each().flat_map(|(_, a)| &a.ctrllimited);
        let ctrl = limited.zip(&p.actuator_ctrlrange);
        let ctrl = ctrl.flat_map(|(&limited, &ends)| range(limited && m.flags.clampctrl, ends));
        self.numbers("CTRL_RANGE", ctrl);
        let force = each().flat_map(|(u, a)| range(a.forcelimited, p.actuator_forcerange[u]));
        self.numbers("FORCE_RANGE", force);
        let of_tendon = |a: &Actuator| {
            let tendon = a.transmission.tendon();
            let limited = tendon.filter(|&t| m.tendons[t].actfrclimited);
            limited.unwrap_or(NONE as usize)
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
    kind: On,
    elements: [usize; 2],
    in_parent: bool,
}

fn target(m: &Model, actuator: &Actuator) -> Target {
    let joint = |j: usize, in_parent| Target {
        kind: match m.joints[j].kind {
            JointKind::Hinge | JointKind::Slide => On::Scalar,
            JointKind::Ball => On::Ball,
            JointKind::Free => On::Free,
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
        Transmission::Tendon(t) => other(On::Tendon, [t, 0]),
        Transmission::Site(site) => other(On::Site, [site, 0]),
        Transmission::SiteInFrame(sites) => other(On::SiteInFrame, sites),
        Transmission::SliderCrank(sites) => other(On::SliderCrank, sites),
        Transmission::Body(body) => other(On::Contacts, [body, 0]),
        Transmission::Rotation(j) => other(On::Rotation, [j, 0]),
        Transmission::RotationInFrame(sites) => other(On::RotationInFrame, sites),
    }
}

fn range(limited: bool, range: [f64; 2]) -> [f64; 2] {
    if limited { range } else { [-ENDLESS, ENDLESS] }
}
