//! Motions with sliding friction by Coulomb's law. They agree with closed forms and with references of fine steps, and
//! the option `stiction` does not disturb them.

use clench::prelude::*;
use clench::rigid::readout::contact_rows;
use std::f64::consts::TAU;
use std::sync::Arc;

const G: f64 = 9.81;
/// The timestep of references, s.
const FINE: f64 = 1e-4;
/// The timestep that is tested, s.
const STEP: f64 = 0.002;

/// Starts a scene whose geoms have friction `mu` and contacts of dimension `condim`.
fn start(timestep: f64, mu: f64, condim: u32, scene: &str, stiction: bool) -> Sim {
    let text = format!(
        "<mujoco><option timestep='{timestep}'/>
         <default><geom friction='{mu} .01 .0001' condim='{condim}'/></default>{scene}</mujoco>"
    );
    let model = clench::load_str(&text).expect("a valid file");
    let options = RigidOptions::new()
        .contact_model(ContactModel::Coulomb)
        .stiction(stiction);
    Sim::with_options(Arc::new(model), options).expect("supported")
}

fn run(sim: &mut Sim, seconds: f64) {
    let steps = (seconds / sim.params().timestep).round() as usize;
    for _ in 0..steps {
        sim.step().expect("finite");
    }
}

fn floor_with(bodies: &str) -> String {
    format!("<worldbody><geom type='plane' size='5 5 .1'/>{bodies}</worldbody>")
}

/// Asserts that `found` and `expected` differ by at most 1% of `scale`.
fn assert_close(found: f64, expected: f64, scale: f64, what: &str) {
    assert!(
        (found - expected).abs() < 0.01 * scale,
        "{what}: {found} instead of {expected}, of {scale}"
    );
}

#[test]
fn a_puck_that_spins_slides_as_with_fine_steps() {
    let puck = "<body pos='0 0 .01'><freejoint/><geom type='box' size='.05 .05 .01'/></body>";
    for condim in [3, 4] {
        for (speed, spin) in [(2.0, 20.0), (1.0, 60.0), (3.0, 5.0)] {
            let throw = |timestep: f64, stiction: bool| {
                let mut sim = start(timestep, 0.3, condim, &floor_with(puck), stiction);
                run(&mut sim, 1.0);
                sim.state.qvel[0] = speed;
                sim.state.qvel[5] = spin;
                sim
            };
            let mut reference = throw(FINE, false);
            let mut tested = [false, true].map(|stiction| throw(STEP, stiction));
            for i in 1..=12 {
                run(&mut reference, 0.1);
                for (sim, stiction) in tested.iter_mut().zip([false, true]) {
                    run(sim, 0.1);
                    let what = format!(
                        "condim {condim}, {speed} m/s, {spin} rad/s, stiction {stiction}, interval {i}"
                    );
                    for (axis, scale) in [(0, speed), (1, speed), (5, spin)] {
                        let [found, expected] = [&*sim, &reference].map(|s| s.state.qvel[axis]);
                        assert_close(found, expected, scale, &what);
                    }
                    for axis in [0, 1] {
                        let [found, expected] = [&*sim, &reference].map(|s| s.state.qpos[axis]);
                        assert_close(found, expected, reference.state.qpos[0], &what);
                    }
                }
            }
            // It is at rest, further away than a puck that does not spin.
            let straight = speed * speed / (2.0 * 0.3 * G);
            for sim in [&reference, &tested[0], &tested[1]] {
                assert!(sim.state.qvel.iter().all(|v| v.abs() < 1e-3 * spin));
                assert!(sim.state.qpos[0] > straight);
            }
        }
    }
}

#[test]
fn a_sphere_thrown_obliquely_with_back_spin_moves_on_a_parabola_until_it_rolls() {
    const RADIUS: f64 = 0.1;
    let mu = 0.2;
    let ball = format!("<body pos='0 0 {RADIUS}'><freejoint/><geom size='{RADIUS}'/></body>");
    for (velocity, spin) in [
        ([2.0, 1.0], [10.0, -15.0]),
        ([1.0, 0.5], [0.0, -40.0]),
        ([0.5, 2.0], [30.0, 20.0]),
    ] {
        // The slip of the contact point keeps its direction and loses 7/2 μ g.
        let slip = [
            velocity[0] - RADIUS * spin[1],
            velocity[1] + RADIUS * spin[0],
        ];
        let speed = f64::hypot(slip[0], slip[1]);
        let slides = speed / (3.5 * mu * G);
        for timestep in [STEP, 0.005] {
            for stiction in [false, true] {
                let mut sim = start(timestep, mu, 3, &floor_with(&ball), stiction);
                run(&mut sim, 1.0);
                let before = [sim.state.qpos[0], sim.state.qpos[1]];
                sim.state.qvel[..2].copy_from_slice(&velocity);
                sim.state.qvel[3..5].copy_from_slice(&spin);
                let mut passed = 0.0;
                for i in 1..=8 {
                    run(&mut sim, 0.1);
                    passed += 0.1;
                    let what =
                        format!("{velocity:?}, {timestep} s, stiction {stiction}, interval {i}");
                    let braked = f64::min(passed, slides);
                    for axis in 0..2 {
                        let brake = mu * G * slip[axis] / speed;
                        let v = velocity[axis] - brake * braked;
                        assert_close(sim.state.qvel[axis], v, speed, &what);
                        let x = velocity[axis] * passed - brake * braked * (passed - 0.5 * braked);
                        let found = sim.state.qpos[axis] - before[axis];
                        assert_close(found, x, speed * passed, &what);
                    }
                }
                assert!(passed > slides, "it rolls in the end");
            }
        }
    }
}

#[test]
fn a_billiard_break_is_that_of_fine_steps() {
    const RADIUS: f64 = 0.0286;
    let ball = |x: f64, y: f64| {
        format!(
            "<body pos='{x} {y} {RADIUS}'><freejoint/><geom size='{RADIUS}' mass='.17'/></body>"
        )
    };
    let mut balls = ball(-0.3, 0.004);
    for row in 0..3 {
        let x = 0.0573 * 0.75f64.sqrt() * f64::from(row);
        for k in 0..=row {
            balls += &ball(x, 0.0573 * (f64::from(k) - 0.5 * f64::from(row)));
        }
    }
    let speed = 3.0;
    let hit = |timestep: f64, stiction: bool| {
        let mut sim = start(timestep, 0.2, 3, &floor_with(&balls), stiction);
        run(&mut sim, 1.0);
        sim.state.qvel[0] = speed;
        sim
    };
    for stiction in [false, true] {
        let [mut sim, mut reference] = [STEP, FINE].map(|timestep| hit(timestep, stiction));
        for i in 1..=8 {
            run(&mut sim, 0.05);
            run(&mut reference, 0.05);
            for (dof, (found, expected)) in
                sim.state.qvel.iter().zip(&reference.state.qvel).enumerate()
            {
                let arm = if dof % 6 < 3 { 1.0 } else { RADIUS };
                let what = format!("stiction {stiction}, interval {i}, dof {dof}");
                assert_close(arm * found, arm * expected, speed, &what);
            }
        }
        let slowest = (1..7)
            .map(|ball| sim.state.qvel[6 * ball])
            .fold(speed, f64::min);
        assert!(slowest > 0.2, "a ball has {slowest} m/s");
    }
}

/// Two supports `left` and `right` of the origin with the given attributes, and a rod on them with its centre at `x`.
fn rod_on_supports(x: f64, left: f64, right: f64, attributes: [&str; 2]) -> String {
    let support = |x: f64, attributes: &str| {
        format!("<geom type='box' size='.01 .05 .05' pos='{x} 0 0' {attributes}/>")
    };
    format!(
        "<worldbody>{}{}
         <body pos='{x} 0 .06'><freejoint/><geom type='box' size='1 .02 .01' mass='1'/></body></worldbody>",
        support(-left, attributes[0]),
        support(right, attributes[1])
    )
}

#[test]
fn a_rod_thrown_along_two_supports_stops_where_coulomb_says() {
    let mu = 0.4;
    for stiction in [false, true] {
        let scene = rod_on_supports(0.0, 0.2, 0.3, ["", ""]);
        let mut sim = start(STEP, mu, 3, &scene, stiction);
        run(&mut sim, 1.0);
        let before = sim.state.qpos[0];
        sim.state.qvel[0] = 1.0;
        run(&mut sim, 0.1);
        assert_close(sim.state.qvel[0], 1.0 - 0.1 * mu * G, 1.0, "speed");
        run(&mut sim, 0.5);
        let expected = 1.0 / (2.0 * mu * G);
        assert_close(sim.state.qpos[0] - before, expected, expected, "distance");
    }
}

#[test]
fn a_rod_on_two_belts_oscillates() {
    // The belts run towards each other. The nearer one presses more and pulls the rod back: with the belts at ±l, and
    // friction at h below the centre, x'' = −μ g x / (l − μ h).
    let (mu, l, h, amplitude) = (0.4, 0.25, 0.01, 0.05);
    let omega = (mu * G / (l - mu * h)).sqrt();
    for stiction in [false, true] {
        let belts = ["surfacevel='1 0 0'", "surfacevel='-1 0 0'"];
        let scene = rod_on_supports(amplitude, l, l, belts);
        let mut sim = start(STEP, mu, 3, &scene, stiction);
        for i in 1..=20 {
            run(&mut sim, 0.1);
            let expected = amplitude * (omega * 0.1 * f64::from(i)).cos();
            let what = format!("stiction {stiction}, interval {i}");
            assert_close(sim.state.qpos[0], expected, amplitude, &what);
        }
    }
}

#[test]
fn a_rod_on_two_approaching_fingers_sticks_and_slides_as_with_fine_steps() {
    let finger = |name: &str, x: f64| {
        format!(
            "<body pos='{x} 0 0'><joint name='{name}' type='slide' axis='1 0 0'/>
             <geom type='box' size='.01 .05 .05' mass='50'/></body>"
        )
    };
    let scene = format!(
        "<worldbody>{}{}
         <body pos='0 0 .06'><freejoint/><geom type='box' size='.5 .02 .01' mass='1'/></body></worldbody>
         <actuator><velocity joint='left' kv='1e4'/><velocity joint='right' kv='1e4'/></actuator>",
        finger("left", -0.2),
        finger("right", 0.35)
    );
    let approach = |timestep: f64, stiction: bool| {
        let mut sim = start(timestep, 0.4, 3, &scene, stiction);
        run(&mut sim, 0.5);
        (sim.state.ctrl[0], sim.state.ctrl[1]) = (0.1, -0.1);
        sim
    };
    for stiction in [false, true] {
        let [mut sim, mut reference] = [STEP, FINE].map(|timestep| approach(timestep, stiction));
        for i in 1..=11 {
            run(&mut sim, 0.2);
            run(&mut reference, 0.2);
            let [found, expected] = [&sim, &reference].map(|sim| sim.state.qpos[2]);
            let what = format!("stiction {stiction}, interval {i}");
            assert_close(found, expected, 0.1, &what);
        }
    }
}

/// The extremes of a motion.
#[derive(Debug, Default)]
struct Extremes {
    /// The greatest sum of contact forces, N.
    force: f64,
    /// The greatest change of the horizontal sum of contact forces in a step, N.
    jump: f64,
    /// The most that mechanical energy exceeds its least value so far, J.
    rise: f64,
}

fn extremes(sim: &mut Sim, seconds: f64) -> Extremes {
    let mut found = Extremes::default();
    let (mut before, mut least) = (None::<[f64; 3]>, f64::INFINITY);
    let steps = (seconds / sim.params().timestep).round() as usize;
    for _ in 0..steps {
        sim.step().expect("finite");
        let mut sum = [0.0; 3];
        for row in contact_rows(sim.workspace(), 0) {
            for (sum, force) in sum.iter_mut().zip(row.wrench) {
                *sum += force;
            }
        }
        let norm = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
        found.force = found.force.max(norm);
        if let Some([x, y, _]) = before {
            found.jump = found.jump.max((sum[0] - x).hypot(sum[1] - y));
        }
        before = Some(sum);
        let energy = sim.energy().expect("finite");
        let energy = energy.kinetic + energy.potential;
        found.rise = found.rise.max(energy - least);
        least = least.min(energy);
    }
    found
}

/// Asserts that stiction makes no force, jump of friction or rise of energy larger by more than 5%. The moment of an
/// impact within its step changes them by almost as much.
fn assert_as_calm(seconds: f64, what: &str, start: impl Fn(bool) -> Sim) {
    let [free, sticky] = [false, true].map(|stiction| extremes(&mut start(stiction), seconds));
    assert!(
        sticky.force < 1.05 * free.force
            && sticky.jump < 1.05 * free.jump
            && sticky.rise < 1.05 * free.rise,
        "{what}: {sticky:?}, without stiction {free:?}"
    );
}

#[test]
fn a_box_rocks_on_its_edges_as_without_stiction() {
    let body =
        "<body pos='0 0 .1'><freejoint/><geom type='box' size='.05 .05 .1' mass='1'/></body>";
    for spin in [1.6, 2.2, 2.8] {
        assert_as_calm(2.0, &format!("{spin} rad/s"), |stiction| {
            let mut sim = start(FINE, 0.8, 3, &floor_with(body), stiction);
            run(&mut sim, 1.0);
            (sim.state.qvel[0], sim.state.qvel[4]) = (0.1 * spin, spin);
            sim
        });
    }
}

#[test]
fn round_bodies_roll_over_a_step_of_terrain_as_without_stiction() {
    let row: String = (0..21)
        .map(|column| if column < 10 { "0 " } else { "1 " })
        .collect();
    let prism: String = (0..24)
        .map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / 24.0).sin_cos();
            format!("{0} -.05 {1} {0} .05 {1} ", 0.1 * cos, 0.1 * sin)
        })
        .collect();
    for (name, shape) in [
        ("cylinder", "type='cylinder' size='.1 .05' euler='90 0 0'"),
        ("hull", "type='mesh' mesh='prism'"),
        ("ball", "size='.1'"),
    ] {
        let scene = format!(
            "<asset><hfield name='step' nrow='21' ncol='21' size='1 1 .01 .1' elevation='{}'/>
               <mesh name='prism' vertex='{prism}'/></asset>
             <worldbody><geom type='hfield' hfield='step'/>
               <body pos='-.5 0 .1'><freejoint/><geom {shape} mass='1'/></body></worldbody>",
            row.repeat(21)
        );
        for timestep in [STEP, 5e-4] {
            assert_as_calm(1.0, &format!("{name}, {timestep} s"), |stiction| {
                let mut sim = start(timestep, 0.8, 3, &scene, stiction);
                run(&mut sim, 0.5);
                (sim.state.qvel[0], sim.state.qvel[4]) = (1.0, 10.0);
                sim
            });
        }
    }
}
