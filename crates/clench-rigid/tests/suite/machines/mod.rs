//! Machines for the tests of smooth dynamics.

pub use crate::common::*;
use clench_math::{Quat, Vec3};
use clench_rigid::Sim;
use clench_rigid::builder::{
    ActuatorSpec, BodySpec, GeomSpec, JointSpec, ModelBuilder, TendonSpec, TransmissionSpec,
    WrapSpec,
};
use clench_rigid::model::{BiasKind, DynamicsKind, Flags, GainKind, JointKind};

/// Returns a world without contacts and other constraints.
pub fn world(name: &str) -> ModelBuilder {
    let mut builder = ModelBuilder::new(name);
    builder.physics.flags = Flags {
        constraint: false,
        ..Flags::default()
    };
    builder
}

fn offset(joint: JointSpec, pos: [f64; 3]) -> JointSpec {
    joint.at(pos).armature(0.02)
}

/// Builds a floating trunk with two limbs, every kind of joint, and oblique axes and centres of mass.
pub fn floating() -> ModelBuilder {
    let mut b = world("floating");
    let askew = [0.8, 0.36, -0.48, 0.0];
    let trunk = b.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("trunk")
            .at([0.3, -0.2, 1.0])
            .turned(askew)
            .joint(JointSpec::free("root"))
            .geom(
                GeomSpec::cuboid([0.1, 0.2, 0.3])
                    .at([0.05, 0.02, 0.1])
                    .mass(3.0),
            ),
    );
    let arm = b.add_body(
        trunk,
        BodySpec::new("arm")
            .at([0.1, 0.2, 0.3])
            .turned(askew)
            .joint(offset(JointSpec::ball("shoulder"), [0.02, 0.03, -0.05]))
            .geom(
                GeomSpec::capsule(0.05, 0.2)
                    .at([0.0, 0.05, 0.2])
                    .turned(askew)
                    .mass(1.0),
            ),
    );
    let hand = b.add_body(
        arm,
        BodySpec::new("hand")
            .at([0.0, 0.1, 0.4])
            .joint(offset(
                JointSpec::slide("reach", [1.0, 0.0, 1.0]),
                [0.0, 0.0, 0.0],
            ))
            .joint(offset(
                JointSpec::hinge("wrist", [0.3, 1.0, 0.2]),
                [0.05, 0.0, 0.1],
            ))
            .geom(
                GeomSpec::ellipsoid([0.1, 0.15, 0.2])
                    .at([0.1, 0.0, 0.1])
                    .mass(0.7),
            ),
    );
    b.add_body(
        hand,
        BodySpec::new("tool")
            .at([0.1, 0.0, 0.2])
            .geom(GeomSpec::sphere(0.06).mass(0.2)),
    );
    let leg = b.add_body(
        trunk,
        BodySpec::new("leg")
            .at([-0.1, 0.0, -0.3])
            .joint(offset(
                JointSpec::hinge("hip_x", [1.0, 0.2, 0.0]),
                [0.0, 0.0, 0.05],
            ))
            .joint(offset(
                JointSpec::hinge("hip_y", [0.0, 1.0, 0.1]),
                [0.0, 0.02, 0.0],
            ))
            .geom(GeomSpec::capsule(0.06, 0.2).at([0.0, 0.0, -0.2]).mass(1.5)),
    );
    b.add_body(
        leg,
        BodySpec::new("shin")
            .at([0.0, 0.0, -0.4])
            .joint(offset(
                JointSpec::hinge("knee", [0.0, 1.0, 0.0]),
                [0.02, 0.0, 0.0],
            ))
            .geom(
                GeomSpec::cylinder(0.05, 0.2)
                    .at([0.03, 0.0, -0.2])
                    .mass(1.0),
            ),
    );
    b.tendons.push(TendonSpec::fixed(
        "hamstring",
        &[("hip_y", 1.5), ("knee", -0.5)],
    ));
    b
}

/// Builds [`floating`] with springs, dampers and actuators of every kind, in wind.
pub fn everything() -> ModelBuilder {
    let mut b = floating();
    for body in &mut b.bodies {
        body.gravcomp = 0.3;
        for joint in &mut body.joints {
            joint.stiffness = [2.0, 0.5, 3.0];
            joint.springref = 0.2;
            joint.damping = [0.3, 0.1, 0.02];
            if joint.kind != JointKind::Free {
                joint.springyield = 0.15;
            }
        }
    }
    let knee = &mut b.bodies[6].joints[0];
    knee.actuatorgravcomp = true;
    knee.actuatorfrcrange = [-2.0, 2.0];
    let hamstring = &mut b.tendons[0];
    hamstring.stiffness = [5.0, 0.0, 0.0];
    hamstring.damping = [0.4, 0.0, 0.0];
    hamstring.springlength = Some([-0.1, 0.1]);
    hamstring.actuatorfrcrange = [-1.0, 1.0];
    add_strings(&mut b);
    b.physics.density = 20.0;
    b.physics.viscosity = 0.5;
    b.physics.wind = [0.5, -0.3, 0.2];
    b.actuators = actuators();
    b
}

/// Adds strings of every kind: straight, around and through a ball and a drum, on either side, in branches.
fn add_strings(b: &mut ModelBuilder) {
    let sites = [
        (0, "post", [0.1, 0.2, 2.0]),
        (1, "hip", [-0.1, 0.1, -0.2]),
        (3, "palm", [0.1, 0.0, 0.1]),
        (5, "thigh", [0.1, 0.01, -0.2]),
        (5, "patella", [0.1, 0.0, -0.4]),
        (5, "core", [0.01, 0.02, -0.4]),
        (6, "shin", [0.08, 0.0, -0.2]),
        (6, "heel", [-0.07, 0.02, -0.2]),
        (6, "axle", [0.005, 0.01, -0.1]),
    ];
    for (body, name, pos) in sites {
        b.bodies[body] = std::mem::take(&mut b.bodies[body]).site(name, pos);
    }
    for (body, name, geom) in [
        (5, "ball", GeomSpec::sphere(0.07).at([0.0, 0.0, -0.4])),
        (
            6,
            "drum",
            GeomSpec::cylinder(0.04, 0.1)
                .at([0.0, 0.0, -0.1])
                .turned([0.8, 0.6, 0.0, 0.0]),
        ),
    ] {
        b.bodies[body].geoms.push(GeomSpec {
            name: name.into(),
            ..geom.mass(0.1)
        });
    }
    let site = |name: &str| WrapSpec::Site(name.into());
    let geom = |name: &str, side: &str| WrapSpec::Geom {
        geom: name.into(),
        side: (!side.is_empty()).then(|| side.into()),
    };
    let strings = [
        ("straight", vec![site("post"), site("palm"), site("hip")]),
        (
            "around ball",
            vec![site("hip"), geom("ball", ""), site("heel")],
        ),
        (
            "past ball",
            vec![site("thigh"), geom("ball", "patella"), site("shin")],
        ),
        (
            "through ball",
            vec![site("thigh"), geom("ball", "core"), site("heel")],
        ),
        (
            "around drum",
            vec![site("palm"), geom("drum", ""), site("post")],
        ),
        (
            "past drum",
            vec![site("palm"), geom("drum", "shin"), site("hip")],
        ),
        (
            "through drum",
            vec![site("hip"), geom("drum", "axle"), site("palm")],
        ),
        (
            "branches",
            vec![
                WrapSpec::Pulley(1.5),
                site("post"),
                geom("ball", "patella"),
                site("shin"),
                site("palm"),
                WrapSpec::Pulley(2.0),
                site("hip"),
                geom("drum", "heel"),
                site("thigh"),
            ],
        ),
    ];
    for (name, path) in strings {
        let mut string = TendonSpec::spatial(name, path);
        string.stiffness = [3.0, 0.4, 1.5];
        string.damping = [0.2, 0.1, 0.03];
        string.springlength = Some([0.3, 0.5]);
        string.springyield = 0.05;
        b.tendons.push(string);
    }
    b.tendons[1].armature = 0.3;
    b.tendons[0].armature = 0.02;
}

fn actuators() -> Vec<ActuatorSpec> {
    let joint = |name: &str| TransmissionSpec::Joint(name.into());
    let tendon = || TransmissionSpec::Tendon("hamstring".into());
    let mut limited = ActuatorSpec::motor("limited", joint("wrist"), 2.0);
    limited.ctrlrange = [-0.3, 0.3];
    limited.forcerange = [-0.2, 0.2];
    let mut affine = ActuatorSpec::motor("affine", joint("reach"), 1.5);
    affine.gain = GainKind::Affine;
    affine.gainprm[..3].copy_from_slice(&[1.0, 0.5, -0.3]);
    affine.bias = BiasKind::Affine;
    affine.biasprm[..3].copy_from_slice(&[0.1, -0.4, -0.6]);
    let stateful = |name: &str, target: &str, dynamics| {
        let mut actuator = ActuatorSpec::motor(name, joint(target), 1.0);
        actuator.dynamics = dynamics;
        actuator.dynprm[0] = 0.05;
        actuator
    };
    let mut early = stateful("early", "hip_x", DynamicsKind::FilterExact);
    early.actearly = true;
    early.actrange = [-0.5, 0.5];
    let mut ball = ActuatorSpec::position("ball", joint("shoulder"), 1.0, 0.2);
    ball.gear[..3].copy_from_slice(&[0.5, 1.0, -0.7]);
    let parent = TransmissionSpec::JointInParent("root".into());
    let mut thruster = ActuatorSpec::motor("thruster", parent, 0.0);
    thruster.gear = [1.0, 0.2, 0.3, 0.4, 0.5, -0.6];
    let mut jet = ActuatorSpec::motor("jet", TransmissionSpec::Site("palm".into()), 0.0);
    jet.gear = [0.3, -0.2, 0.5, 0.1, 0.2, -0.1];
    let above = TransmissionSpec::SiteInFrame {
        site: "palm".into(),
        reference: "post".into(),
    };
    let mut reach = ActuatorSpec::position("reach", above, 1.0, 0.1);
    reach.gear[..3].copy_from_slice(&[1.0, 0.5, -0.3]);
    let piston = TransmissionSpec::SliderCrank {
        crank: "heel".into(),
        slider: "hip".into(),
    };
    let mut piston = ActuatorSpec::velocity("piston", piston, 0.3);
    piston.cranklength = 1.5;
    vec![
        limited,
        affine,
        stateful("integrator", "hip_y", DynamicsKind::Integrator),
        stateful("filter", "knee", DynamicsKind::Filter),
        early,
        ActuatorSpec::velocity("pull", tendon(), 1.0),
        ActuatorSpec::velocity("knee", joint("knee"), 0.5),
        ActuatorSpec::position(
            "string",
            TransmissionSpec::Tendon("branches".into()),
            2.0,
            0.3,
        ),
        ball,
        thruster,
        jet,
        reach,
        piston,
    ]
}

/// Randomizes positions, velocities, activations and controls by `seed`.
pub fn shake(sim: &mut Sim, seed: u64) {
    let mut numbers = Numbers(seed);
    turn(sim, &mut numbers, 1.0);
    numbers.fill(&mut sim.state.qvel, 2.0);
    numbers.fill(&mut sim.state.act, 1.0);
    numbers.fill(&mut sim.state.ctrl, 1.0);
}

/// Returns the largest difference of two slices.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    (a.iter().zip(b)).fold(0.0, |worst, (x, y)| {
        let error = (x - y).abs();
        if error <= worst { worst } else { error }
    })
}

/// Returns the rotation vector from one orientation to another, in world axes.
pub fn turn_between(from: Quat<f64>, to: Quat<f64>) -> Vec3<f64> {
    (to * from.conjugate()).to_rotation_vector()
}
