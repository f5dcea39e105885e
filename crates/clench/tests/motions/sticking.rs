//! The option `stiction`: bodies that should stick do not move, and those that slide or roll are not held back.

use clench::prelude::*;
use std::sync::Arc;

const G: f64 = 9.81;

/// The laws of friction that hold a load at 95% of the friction angle. (Pyramids hop there, with or without stiction.)
const LAWS: [(ContactModel, FrictionCone); 2] = [
    (ContactModel::Convex, FrictionCone::Elliptic),
    (ContactModel::Coulomb, FrictionCone::Elliptic),
];

pub fn sticking() -> RigidOptions {
    RigidOptions::new()
        .stiction(true)
        .friction_cone(FrictionCone::Elliptic)
}

/// Returns a model with bodies in a world, stepped by `timestep`.
pub fn scene(timestep: f64, option: &str, world: &str, rest: &str) -> String {
    format!(
        "<mujoco><option timestep='{timestep}' {option}/><worldbody>{world}</worldbody>{rest}</mujoco>"
    )
}

pub fn start(text: &str, options: RigidOptions) -> Sim {
    let model = clench::load_str(text).expect("a valid file");
    Sim::with_options(Arc::new(model), options).expect("supported")
}

pub fn run(sim: &mut Sim, seconds: f64) {
    let steps = (seconds / sim.params().timestep).round() as usize;
    for _ in 0..steps {
        sim.step().expect("finite");
    }
}

/// Returns the most that a position coordinate moves in `seconds`.
pub fn drift(sim: &mut Sim, seconds: f64) -> f64 {
    let before = sim.state.qpos.clone();
    run(sim, seconds);
    let moved = sim.state.qpos.iter().zip(&before);
    moved.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A slope with a body on it at the height `z`, both with friction `mu`.
pub fn slope(timestep: f64, option: &str, angle: f64, mu: f64, z: f64, geom: &str) -> String {
    let (x, z, degrees) = (angle.sin() * z, angle.cos() * z, angle.to_degrees());
    let world = format!(
        "<geom type='plane' size='5 5 .1' euler='0 {degrees} 0' friction='{mu}'/>
         <body euler='0 {degrees} 0' pos='{x} 0 {z}'><freejoint/><geom {geom} friction='{mu}'/></body>"
    );
    scene(timestep, option, &world, "")
}

pub const BOX: &str = "type='box' size='.05 .05 .05'";
pub const ANGLE: f64 = 0.35;

#[test]
fn a_box_on_a_slope_stays_below_the_friction_angle_and_slides_above() {
    for (law, cone) in LAWS {
        for timestep in [0.002, 0.005] {
            for condim in [3, 4, 6] {
                let options = sticking().contact_model(law).friction_cone(cone);
                let geom = format!("{BOX} condim='{condim}'");
                let what = format!("{law:?}, {timestep} s, condim {condim}");
                let mut sim = start(
                    &slope(timestep, "", ANGLE, ANGLE.tan() / 0.95, 0.05, &geom),
                    options,
                );
                run(&mut sim, 1.0);
                let crept = drift(&mut sim, 60.0) / 60.0;
                assert!(crept < 1e-9, "{what}: creeps at {crept} m/s");
                if law == ContactModel::Convex {
                    continue; // Sliding adds to its normal force.
                }
                let mut sim = start(
                    &slope(timestep, "", ANGLE, ANGLE.tan() / 1.05, 0.05, &geom),
                    options,
                );
                run(&mut sim, 0.5);
                let before = sim.state.qvel[0].hypot(sim.state.qvel[2]);
                run(&mut sim, 1.0);
                let gained = sim.state.qvel[0].hypot(sim.state.qvel[2]) - before;
                let expected = G * ANGLE.sin() * (1.0 - 1.0 / 1.05);
                let ratio = gained / expected;
                assert!((ratio - 1.0).abs() < 0.01, "{what}: {ratio} of Coulomb's");
            }
        }
    }
    let text = slope(0.002, "", ANGLE, ANGLE.tan() / 0.95, 0.05, BOX);
    let mut sim = start(&text, sticking().stiction(false));
    run(&mut sim, 1.0);
    assert!(drift(&mut sim, 1.0) > 1e-4, "without stiction it creeps");
}

#[test]
fn every_integrator_and_solver_holds_the_box() {
    for integrator in ["Euler", "implicit", "implicitfast", "RK4", "discrete"] {
        let option = format!("integrator='{integrator}'");
        for solver in [ConstraintSolver::Newton, ConstraintSolver::Cg] {
            for noslip in [0, 3] {
                if integrator == "discrete" && noslip > 0 {
                    continue; // Refused by name.
                }
                let options = sticking()
                    .constraint_solver(solver)
                    .noslip_iterations(noslip);
                let text = slope(0.002, &option, ANGLE, ANGLE.tan() / 0.9, 0.05, BOX);
                let mut sim = start(&text, options);
                run(&mut sim, 1.0);
                let crept = drift(&mut sim, 5.0) / 5.0;
                assert!(
                    crept < 1e-7,
                    "{integrator}, {solver:?}, noslip {noslip}: {crept} m/s"
                );
            }
        }
    }
}

#[test]
fn single_precision_holds_the_box() {
    let text = slope(0.002, "", ANGLE, ANGLE.tan() / 0.9, 0.05, BOX);
    let model = clench::load_str(&text).expect("a valid file");
    let mut sim = Sim::<f32>::with_options(Arc::new(model), sticking()).expect("supported");
    let step = |sim: &mut Sim<f32>, seconds: f64| {
        for _ in 0..(seconds / 0.002) as usize {
            sim.step().expect("finite");
        }
    };
    step(&mut sim, 1.0);
    let before = sim.state.qpos[0];
    step(&mut sim, 20.0);
    let crept = (sim.state.qpos[0] - before).abs() / 20.0;
    assert!(crept < 1e-6, "{crept} m/s");
}

#[test]
fn fingers_hold_what_they_pinch() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/pinch.xml");
    for (law, cone) in [
        (ContactModel::Convex, FrictionCone::Pyramidal),
        LAWS[0],
        LAWS[1],
    ] {
        for impratio in [1.0, 10.0] {
            let mut creep = [0.0; 2];
            for (i, stiction) in [false, true].into_iter().enumerate() {
                let options = RigidOptions::new()
                    .stiction(stiction)
                    .contact_model(law)
                    .friction_cone(cone)
                    .impratio(impratio);
                let model = Arc::new(clench::load(path).expect("a model of our own"));
                let mut sim = Sim::with_options(model, options).expect("supported");
                run(&mut sim, 1.0);
                creep[i] = drift(&mut sim, 5.0) / 5.0;
            }
            let what = format!("{law:?}, {cone:?}, impratio {impratio}: {creep:?} m/s");
            assert!(creep[0] > 1e-4 && creep[1] < 1e-9, "{what}");
        }
    }
}

pub fn ladder(timestep: f64) -> String {
    let world = "<geom type='plane' size='5 5 .1' friction='.6'/>
        <geom type='plane' size='5 5 .1' zaxis='1 0 0' friction='.3'/>
        <body pos='.8 0 1.09' euler='0 -36 0'><freejoint/>
          <geom type='box' size='.03 .2 1.32' friction='.3' mass='10'/></body>";
    scene(timestep, "", world, "")
}

/// Ten boxes on a slope. Each is a little smaller than the one below: between equal ones, the number of contact points
/// changes with displacements of a micrometre.
pub fn stack(timestep: f64) -> String {
    let angle = 8f64.to_radians();
    let boxes: String = (0..10)
        .map(|i| {
            let (up, size) = (0.05 + 0.1 * f64::from(i), 0.1 - 0.001 * f64::from(i));
            let (x, z) = (angle.sin() * up, angle.cos() * up);
            format!(
                "<body pos='{x} 0 {z}' euler='0 8 0'><freejoint/>
                 <geom type='box' size='{size} {size} .05' friction='.5'/></body>"
            )
        })
        .collect();
    let floor = "<geom type='plane' size='5 5 .1' euler='0 8 0' friction='.5'/>";
    scene(timestep, "", &format!("{floor}{boxes}"), "")
}

/// A car whose wheels are held by dry friction of their joints.
pub fn car(timestep: f64) -> String {
    let angle = 15f64.to_radians();
    let wheels: String = [(0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2)]
        .map(|(x, y)| {
            format!(
                "<body pos='{x} {y} -.05'><joint axis='0 1 0' frictionloss='5'/>
                 <geom type='cylinder' size='.1 .03' euler='90 0 0' condim='4'/></body>"
            )
        })
        .concat();
    let world = format!(
        "<geom type='plane' size='5 5 .1' euler='0 15 0'/>
         <body pos='{} 0 {}' euler='0 15 0'><freejoint/><geom type='box' size='.4 .15 .05' mass='5'/>{wheels}</body>",
        0.15 * angle.sin(),
        0.15 * angle.cos()
    );
    scene(timestep, "", &world, "")
}

pub fn pendulum(timestep: f64) -> String {
    let world = "<body euler='0 40 0'><joint axis='0 1 0' frictionloss='5'/>
        <geom type='capsule' size='.02' fromto='0 0 0 0 0 -1' mass='1'/></body>";
    scene(timestep, "", world, "")
}

/// A weight on a tendon over a pulley that turns with friction.
fn tendon(timestep: f64) -> String {
    let world = "<site name='ceiling' pos='0 0 2'/>
        <body pos='0 0 1'><joint type='slide' axis='0 0 1'/><geom size='.1' mass='1'/><site name='hook'/></body>";
    let tendons = "<tendon><spatial frictionloss='12'><site site='ceiling'/><site site='hook'/></spatial></tendon>";
    scene(timestep, "", world, tendons)
}

pub fn ball_between_fingers(timestep: f64, condim: u32) -> String {
    let fingers: String = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
        .map(|(x, y)| {
            format!(
                "<body pos='{} {} 1'>
                 <joint type='slide' axis='{} {} 0' damping='20' stiffness='200' springref='.03'/>
                 <geom size='.02' friction='1 .01 .001' condim='{condim}' mass='.2'/></body>",
                0.07 * x,
                0.07 * y,
                -x,
                -y
            )
        })
        .concat();
    let ball = format!(
        "<body pos='0 0 1'><freejoint/><geom size='.05' mass='.5' condim='{condim}' friction='1 .01 .001'/></body>"
    );
    scene(timestep, "", &format!("{fingers}{ball}"), "")
}

#[test]
fn what_friction_carries_stands_still() {
    for timestep in [0.002, 0.005] {
        for (name, text) in [
            ("ladder", ladder(timestep)),
            ("stack", stack(timestep)),
            ("car", car(timestep)),
            ("pendulum", pendulum(timestep)),
            ("tendon", tendon(timestep)),
            ("ball, condim 4", ball_between_fingers(timestep, 4)),
            ("ball, condim 6", ball_between_fingers(timestep, 6)),
        ] {
            for (law, cone) in LAWS {
                let options = sticking().contact_model(law).friction_cone(cone);
                let mut sim = start(&text, options);
                run(&mut sim, 20.0);
                let crept = drift(&mut sim, 10.0) / 10.0;
                assert!(crept < 1e-9, "{name}, {law:?}, {timestep} s: {crept} m/s");
            }
            let mut sim = start(&text, sticking().stiction(false));
            run(&mut sim, 1.0);
            let crept = drift(&mut sim, 1.0);
            assert!(crept > 1e-6, "{name} without stiction: {crept} m/s");
        }
    }
}

#[test]
fn friction_that_is_too_weak_lets_go() {
    let weak = pendulum(0.002).replace("frictionloss='5'", "frictionloss='1'");
    let mut sim = start(&weak, sticking());
    run(&mut sim, 0.3);
    let moved = sim.state.qpos[0];
    // m g l/2 sin 40° − η over the inertia m l²/3, for a short time.
    let rod = 1.0 / 3.0 + 0.02;
    assert!(moved.abs() > 0.1 * 0.3 * 0.3 * (G * 0.5 * 0.64 - 1.0) / rod);
    let weak = tendon(0.002).replace("'12'", "'5'");
    let mut sim = start(&weak, sticking());
    run(&mut sim, 1.0);
    let fallen = -sim.state.qpos[0] / (0.5 * (G - 5.0));
    assert!((fallen - 1.0).abs() < 0.01, "{fallen}");
}

/// A gripper with position actuators of gain `gain` that is shaken up and down for 20 s. Returns how far its load
/// slips, m.
fn shaken(gain: f64, frequency: f64, options: RigidOptions) -> f64 {
    let finger = |x: f64, name: &str| {
        format!(
            "<body pos='{} 0 0'><joint name='{name}' type='slide' axis='{} 0 0' damping='10'/>
             <geom type='box' size='.01 .02 .04' mass='.1' friction='1 .01 .0001' condim='4'/></body>",
            0.05 * x,
            -x
        )
    };
    let world = format!(
        "<body pos='0 0 1'><joint name='lift' type='slide' axis='0 0 1' damping='1'/>
           <geom type='box' size='.1 .05 .02' pos='0 0 .1' mass='5'/>{}{}</body>
         <body pos='0 0 1'><freejoint/><geom type='box' size='.038 .02 .03' mass='.5'/></body>",
        finger(-1.0, "left"),
        finger(1.0, "right")
    );
    let actuators = format!(
        "<actuator><position joint='left' kp='{gain}'/><position joint='right' kp='{gain}'/>
         <position joint='lift' kp='20000' kv='600'/></actuator>"
    );
    let mut sim = start(&scene(0.002, "", &world, &actuators), options);
    let slip = |sim: &Sim| sim.state.qpos[5] - 1.0 - sim.state.qpos[0];
    (sim.state.ctrl[0], sim.state.ctrl[1]) = (0.03, 0.03);
    run(&mut sim, 1.0);
    let (mut low, mut high) = (slip(&sim), slip(&sim));
    let omega = std::f64::consts::TAU * frequency;
    while sim.state.time < 21.0 {
        let phase = omega * (sim.state.time - 1.0);
        sim.state.ctrl[2] = G / (omega * omega) * (1.0 - phase.cos());
        sim.step().expect("finite");
        (low, high) = (low.min(slip(&sim)), high.max(slip(&sim)));
    }
    high - low
}

#[test]
fn a_shaken_gripper_holds_its_load_where_coulombs_law_does() {
    for (law, cone) in LAWS {
        for frequency in [1.0, 3.0, 10.0] {
            let options = sticking().contact_model(law).friction_cone(cone);
            let slip = shaken(1000.0, frequency, options);
            assert!(slip < 0.5e-3, "{law:?}, {frequency} Hz: {slip} m");
            // Each finger presses with 2.7 N: enough to carry 4.9 N at rest, not 9.8 N.
            let slip = shaken(100.0, frequency, options);
            assert!(slip > 5e-3, "{law:?}, {frequency} Hz: {slip} m");
        }
    }
}

#[test]
fn rolling_is_not_held_back() {
    for condim in [3, 4] {
        let geom = format!("size='.3' condim='{condim}'");
        let mut sim = start(&slope(0.002, "", ANGLE, 1.0, 0.3, &geom), sticking());
        run(&mut sim, 0.2);
        let before = sim.state.qvel[0].hypot(sim.state.qvel[2]);
        run(&mut sim, 1.0);
        let gained = sim.state.qvel[0].hypot(sim.state.qvel[2]) - before;
        let ratio = gained / (5.0 / 7.0 * G * ANGLE.sin());
        assert!((ratio - 1.0).abs() < 1e-3, "condim {condim}: {ratio}");
    }
}

#[test]
fn a_belt_carries_its_load_at_its_own_speed() {
    let angle = 0.2f64;
    let text = slope(0.002, "", angle, 0.5, 0.05, BOX).replace(
        "<geom type='plane'",
        "<geom surfacevel='-0.3 0 0' type='plane'",
    );
    let mut sim = start(&text, sticking());
    run(&mut sim, 2.0);
    let speed = sim.state.qvel[0].hypot(sim.state.qvel[2]);
    assert!((speed - 0.3).abs() < 1e-6, "{speed}");
    let mut sim = start(&text, sticking().stiction(false));
    run(&mut sim, 2.0);
    let speed = sim.state.qvel[0].hypot(sim.state.qvel[2]);
    assert!(
        (speed - 0.3).abs() > 1e-5,
        "without stiction it slips: {speed}"
    );
}

#[test]
fn a_tumbling_box_gains_no_energy() {
    for (law, cone) in LAWS {
        let text = slope(0.002, "", 0.0, 0.8, 0.3, BOX);
        let mut sim = start(&text, sticking().contact_model(law).friction_cone(cone));
        sim.state
            .qvel
            .copy_from_slice(&[1.0, 0.3, 0.0, 2.0, 9.0, 3.0]);
        let energy = |sim: &mut Sim| {
            let energy = sim.energy().expect("finite");
            energy.kinetic + energy.potential
        };
        let first = energy(&mut sim);
        for _ in 0..2000 {
            sim.step().expect("finite");
            let now = energy(&mut sim);
            assert!(
                now < first * (1.0 + 1e-9),
                "{law:?}: {now} J after {first} J"
            );
        }
        // On its side at rest.
        let weight = 1000.0 * 0.001 * G;
        assert!((energy(&mut sim) / (weight * 0.05) - 1.0).abs() < 0.01);
    }
}
