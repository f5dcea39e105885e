//! Small scenes for the tests of constraints, lanes and batches.

mod sensors;

pub use crate::common::*;
use clench_collide::ShapeKind;
use clench_math::{Quat, Vec3};
use clench_rigid::Sim;
use clench_rigid::builder::{
    ActuatorSpec, BodySpec, ConnectAnchor, EqualityKind, EqualitySpec, GeomMass, GeomSpec,
    JointSpec, KeyframeSpec, MeshSpec, ModelBuilder, TendonSpec, TransmissionSpec,
};
use clench_rigid::constraint::impedance;
use clench_rigid::model::JointKind;
use clench_rigid::options::RigidOptions;

/// Returns an empty world with the most precise solver settings.
pub fn world() -> ModelBuilder {
    ModelBuilder {
        options: RigidOptions::new()
            .tolerance(0.0)
            .iterations(200)
            .constraint_timeconst(0.0),
        ..ModelBuilder::default()
    }
}

/// Adds a body and returns its index.
pub fn add(
    builder: &mut ModelBuilder,
    parent: usize,
    name: &str,
    pos: [f64; 3],
    joints: Vec<JointSpec>,
    geoms: Vec<GeomSpec>,
) -> usize {
    builder.bodies.push(BodySpec {
        name: name.into(),
        parent,
        pos: Vec3::from_f64(pos),
        joints,
        geoms,
        ..BodySpec::default()
    });
    builder.bodies.len() - 1
}

pub fn joint(kind: JointKind, name: &str, axis: [f64; 3]) -> JointSpec {
    JointSpec {
        name: name.into(),
        kind,
        axis: Vec3::from_f64(axis),
        ..JointSpec::default()
    }
}

pub fn free() -> Vec<JointSpec> {
    vec![joint(JointKind::Free, "", [0.0, 0.0, 1.0])]
}

pub fn geom(kind: ShapeKind, size: [f64; 3]) -> GeomSpec {
    GeomSpec {
        kind,
        size: Vec3::from_f64(size),
        mass: GeomMass::Mass(1.0),
        ..GeomSpec::default()
    }
}

pub fn plane() -> GeomSpec {
    geom(ShapeKind::Plane, [0.0, 0.0, 1.0])
}

pub fn sphere(radius: f64) -> GeomSpec {
    geom(ShapeKind::Sphere, [radius, 0.0, 0.0])
}

pub fn cuboid(half: [f64; 3]) -> GeomSpec {
    geom(ShapeKind::Box, half)
}

/// Makes a geom collide with nothing.
pub fn ghost(mut geom: GeomSpec) -> GeomSpec {
    geom.contype = 0;
    geom.conaffinity = 0;
    geom
}

pub fn bodies(body1: &str, body2: &str, anchor: [f64; 3]) -> ConnectAnchor {
    ConnectAnchor::Bodies {
        body1: body1.into(),
        body2: body2.into(),
        anchor: Vec3::from_f64(anchor),
    }
}

/// The gravity, m/s².
pub const G: f64 = 9.81;

/// Returns the penetration at which n equal contacts carry a free body of mass m, whose bodies' inverse weight is 1/m:
/// n f = m g with f = −k d r / R and R = ρ (1 − d) / (d m). ρ is 1 for frictionless and elliptic contacts; for a
/// pyramid's 4 edges, whose total stiffness is 4/R, ρ = 2 μ² (1 + μ²).
pub fn rest_penetration(n: f64, rho: f64, solimp: [f64; 5], timeconst: f64) -> f64 {
    let k = 1.0 / (solimp[1] * timeconst).powi(2);
    let excess = |r: f64| {
        let d = impedance(solimp, r);
        n * k * d * d * r / (rho * (1.0 - d)) - G
    };
    let (mut low, mut high) = (0.0, 0.1);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Steps for `time` seconds.
pub fn run(sim: &mut Sim, time: f64) {
    let end = sim.state.time + time;
    while sim.state.time < end - 1e-9 {
        sim.step().expect("the motion stays finite");
    }
}

/// Builds a jointed pair, a ball and a box above a floor; the box can be welded to the world.
pub fn loose_parts() -> ModelBuilder {
    let mut b = world();
    b.options = RigidOptions::new().constraint_timeconst(0.0);
    b.bodies[0].geoms.push(plane());
    let pair = add(
        &mut b,
        0,
        "pair",
        [0.0, 0.0, 0.15],
        free(),
        vec![sphere(0.1)],
    );
    let mut hinge = joint(JointKind::Hinge, "hinge", [0.0, 1.0, 0.0]);
    hinge.range = [-0.6, 0.3];
    hinge.frictionloss = 0.1;
    add(
        &mut b,
        pair,
        "link",
        [0.25, 0.0, 0.0],
        vec![hinge],
        vec![sphere(0.08)],
    );
    let rolling = GeomSpec {
        condim: 6,
        ..sphere(0.1)
    };
    add(&mut b, 0, "ball", [0.3, 0.1, 0.3], free(), vec![rolling]);
    let box_geom = cuboid([0.1, 0.08, 0.06]);
    add(&mut b, 0, "box", [-0.3, 0.1, 0.2], free(), vec![box_geom]);
    let kind = EqualityKind::Weld {
        anchor: bodies("box", "", [0.0; 3]),
        relpose: None,
        torquescale: 1.0,
    };
    b.equalities.push(EqualitySpec::new("grip", kind));
    b.equalities[0].active = false;
    b.keyframes.push(KeyframeSpec {
        name: "thrown".into(),
        time: 2.0,
        qvel: Some(vec![1.0, 0.0, 3.0, 0.0, 0.0, 0.0]),
        ..KeyframeSpec::default()
    });
    b
}

/// Builds 48 boxes in three layers of four by four. Each touches its neighbours: one large island.
pub fn heap_of_boxes() -> ModelBuilder {
    let mut b = world();
    b.bodies[0].geoms.push(plane());
    for i in 0..48 {
        let [x, y, z] = [i % 4, i / 4 % 4, i / 16].map(f64::from);
        let pos = [0.199 * x, 0.199 * y, 0.1 + 0.2 * z];
        add(&mut b, 0, "", pos, free(), vec![cuboid([0.1; 3])]);
    }
    b
}

/// Builds a mesh cube that carries a box and a cylinder, and a box on that box. `multiccd` enables multiple contacts.
pub fn parts_on_a_mesh(multiccd: bool) -> ModelBuilder {
    let mut b = world();
    b.physics.flags.multiccd = multiccd;
    let corners = [-0.2, 0.2].map(|x| [-0.2, 0.2].map(|y| [-0.2, 0.2].map(|z| [x, y, z])));
    b.meshes.push(MeshSpec::hull(
        "cube",
        corners.as_flattened().as_flattened(),
    ));
    b.bodies[0].geoms.push(GeomSpec::mesh("cube"));
    let round = GeomSpec::cylinder(0.05, 0.05);
    add(
        &mut b,
        0,
        "box",
        [0.1, 0.1, 0.2495],
        free(),
        vec![cuboid([0.05; 3])],
    );
    add(
        &mut b,
        0,
        "cylinder",
        [-0.1, -0.1, 0.2495],
        free(),
        vec![round],
    );
    add(
        &mut b,
        0,
        "top",
        [0.1, 0.1, 0.349],
        free(),
        vec![cuboid([0.05; 3])],
    );
    b
}

/// Builds a branched tree and a loose body, far from rest, with every kind of constraint active.
pub fn everything() -> ModelBuilder {
    let mut b = world();
    let limited = |mut j: JointSpec, range: [f64; 2]| {
        j.range = range;
        j.limited = Some(true);
        j.margin = 0.01;
        j.frictionloss = 0.3;
        j.armature = 0.01;
        j
    };
    b.bodies[0].geoms.push(plane());
    let trunk = add(
        &mut b,
        0,
        "trunk",
        [0.0, 0.0, 0.5],
        free(),
        vec![cuboid([0.1, 0.2, 0.1])],
    );
    let mut ball = limited(joint(JointKind::Ball, "ball", [0.0, 0.0, 1.0]), [0.0, 0.2]);
    ball.pos = Vec3::from_f64([0.0, 0.0, 0.1]);
    let arm_geom = geom(ShapeKind::Capsule, [0.05, 0.2, 0.0]);
    let arm = add(
        &mut b,
        trunk,
        "arm",
        [0.1, 0.2, 0.2],
        vec![ball],
        vec![arm_geom.clone()],
    );
    let elbow = limited(
        joint(JointKind::Hinge, "elbow", [0.3, 1.0, 0.2]),
        [-0.2, 0.1],
    );
    let hand = add(
        &mut b,
        arm,
        "hand",
        [0.0, 0.1, 0.3],
        vec![elbow],
        vec![sphere(0.1)],
    );
    let slide = limited(
        joint(JointKind::Slide, "slide", [1.0, 0.5, 0.0]),
        [-0.05, 0.3],
    );
    let hinge = limited(
        joint(JointKind::Hinge, "hinge", [0.0, 1.0, 1.0]),
        [-0.4, 0.4],
    );
    add(
        &mut b,
        trunk,
        "leg",
        [-0.1, -0.2, -0.2],
        vec![slide, hinge],
        vec![arm_geom],
    );
    add(
        &mut b,
        hand,
        "tip",
        [0.0, 0.0, 0.15],
        vec![],
        vec![sphere(0.05)],
    );
    add(
        &mut b,
        0,
        "loose",
        [0.6, 0.1, 0.4],
        free(),
        vec![cuboid([0.1, 0.1, 0.1])],
    );
    let mut span = TendonSpec::fixed("span", &[("hinge", 0.7), ("elbow", -1.3)]);
    span.range = [-0.01, 0.02];
    span.limited = Some(true);
    span.frictionloss = 0.2;
    b.tendons = vec![
        span,
        TendonSpec::fixed("other", &[("slide", 2.0), ("hinge", 0.5)]),
    ];
    let quartic = [0.02, 0.9, -0.3, 0.7, 0.4];
    b.equalities = vec![
        EqualitySpec::new(
            "connect",
            EqualityKind::Connect(bodies("tip", "loose", [0.05, 0.1, 0.0])),
        ),
        EqualitySpec::new(
            "loop",
            EqualityKind::Connect(bodies("hand", "leg", [0.0, 0.1, 0.2])),
        ),
        EqualitySpec::new(
            "weld",
            EqualityKind::Weld {
                anchor: bodies("hand", "loose", [0.02, 0.03, 0.1]),
                relpose: None,
                torquescale: 0.7,
            },
        ),
        EqualitySpec::new(
            "pin",
            EqualityKind::Weld {
                anchor: bodies("loose", "", [0.1, 0.0, 0.2]),
                relpose: Some((
                    Vec3::from_f64([0.3, 0.1, 0.1]),
                    Quat::new(0.8, 0.0, 0.6, 0.0),
                )),
                torquescale: 1.3,
            },
        ),
        EqualitySpec::new(
            "joints",
            EqualityKind::Joint {
                joint1: "elbow".into(),
                joint2: Some("slide".into()),
                polycoef: quartic,
            },
        ),
        EqualitySpec::new(
            "fixed",
            EqualityKind::Joint {
                joint1: "hinge".into(),
                joint2: None,
                polycoef: [0.1, 0.0, 0.0, 0.0, 0.0],
            },
        ),
        EqualitySpec::new(
            "tendons",
            EqualityKind::Tendon {
                tendon1: "span".into(),
                tendon2: Some("other".into()),
                polycoef: quartic,
            },
        ),
    ];
    b.actuators.push(ActuatorSpec::motor(
        "pull",
        TransmissionSpec::Joint("hinge".into()),
        0.5,
    ));
    sensors::add(&mut b);
    b
}

/// Moves a simulation of [`everything`] to a random state.
pub fn shake(sim: &mut Sim, seed: u64) {
    let mut numbers = Numbers(seed);
    turn(sim, &mut numbers, 0.5);
    numbers.fill(&mut sim.state.qvel, 1.0);
}

/// Builds a torso with a head and four limbs of two links, on the floor.
pub fn humanoid() -> ModelBuilder {
    let mut b = world();
    b.bodies[0].geoms.push(plane());
    let limb = |from: [f64; 3], to: [f64; 3]| GeomSpec {
        pos: Vec3::from_f64([0, 1, 2].map(|i| 0.5 * (from[i] + to[i]))),
        ..geom(ShapeKind::Capsule, [0.05, 0.15, 0.0])
    };
    let hinge = |name: &str, axis| JointSpec {
        range: [-1.0, 1.0],
        damping: [0.5, 0.1, 0.02],
        armature: 0.02,
        ..joint(JointKind::Hinge, name, axis)
    };
    let torso = add(
        &mut b,
        0,
        "torso",
        [0.0, 0.0, 1.0],
        free(),
        vec![sphere(0.12)],
    );
    add(
        &mut b,
        torso,
        "head",
        [0.0, 0.0, 0.25],
        vec![hinge("neck", [0.0, 1.0, 0.0])],
        vec![sphere(0.1)],
    );
    for (i, (x, z)) in [(0.2, 0.1), (-0.2, 0.1), (0.1, -0.2), (-0.1, -0.2)]
        .into_iter()
        .enumerate()
    {
        let (first, second, knee) = (format!("hip_x{i}"), format!("hip_y{i}"), format!("knee{i}"));
        let joints = vec![
            hinge(&first, [1.0, 0.0, 0.0]),
            hinge(&second, [0.0, 1.0, 0.0]),
        ];
        let end = [0.0, 0.0, -0.35];
        let upper = add(
            &mut b,
            torso,
            &format!("upper{i}"),
            [x, 0.0, z],
            joints,
            vec![limb([0.0; 3], end)],
        );
        add(
            &mut b,
            upper,
            &format!("lower{i}"),
            end,
            vec![hinge(&knee, [0.0, 1.0, 0.0])],
            vec![limb([0.0; 3], end)],
        );
        b.actuators.extend(
            [first, second, knee]
                .map(|joint| ActuatorSpec::motor("", TransmissionSpec::Joint(joint), 8.0)),
        );
    }
    b
}
