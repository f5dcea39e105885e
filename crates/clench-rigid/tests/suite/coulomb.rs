//! Motions of the contact model `coulomb` that have closed forms.

use crate::scenes::{G, add, cuboid, free, model, plane, sphere, world};
use clench_math::{Quat, Vec3};
use clench_rigid::Sim;
use clench_rigid::builder::{GeomSpec, ModelBuilder};
use clench_rigid::options::{ContactModel, FrictionCone, RigidOptions};
use clench_solver::ConstraintSolver;

/// Builds a floor tilted by `angle` about y, with a body on it at the height `height`.
fn on_floor(angle: f64, friction: f64, height: f64, shape: GeomSpec) -> ModelBuilder {
    let mut b = world();
    let tilt = Quat::new((angle / 2.0).cos(), 0.0, (angle / 2.0).sin(), 0.0);
    let friction = [friction, 0.0, 0.0];
    b.bodies[0].geoms.push(GeomSpec {
        quat: tilt,
        friction,
        ..plane()
    });
    let up = tilt.rotate(Vec3::new(0.0, 0.0, height)).to_array();
    let body = add(
        &mut b,
        0,
        "body",
        up,
        free(),
        vec![GeomSpec { friction, ..shape }],
    );
    b.bodies[body].quat = tilt;
    b
}

fn coulomb(builder: &ModelBuilder) -> Sim {
    let options = RigidOptions::new().contact_model(ContactModel::Coulomb);
    Sim::with_options(model(builder), options).expect("valid")
}

fn run(sim: &mut Sim, seconds: f64) {
    let steps = (seconds / sim.params().timestep).round() as usize;
    for _ in 0..steps {
        sim.step().expect("finite");
    }
}

/// Returns the rise of a flat box of edge `edge` that slides at `speed`, and its deceleration over μ g.
fn slide(options: RigidOptions, timestep: f64, edge: f64, friction: f64, speed: f64) -> (f64, f64) {
    let half = edge / 2.0;
    let height = 0.4 * half;
    let builder = on_floor(0.0, friction, height, cuboid([half, half, height]));
    let mut sim = Sim::with_options(model(&builder), options).expect("valid");
    sim.set_timestep(timestep).expect("positive");
    run(&mut sim, 1.0);
    let start = sim.state.qpos[2];
    sim.state.qvel[0] = speed;
    let seconds = 0.5 * speed / (friction * G);
    let mut rise: f64 = 0.0;
    let steps = (seconds / sim.params().timestep).round();
    for _ in 0..steps as usize {
        sim.step().expect("finite");
        rise = rise.max(sim.state.qpos[2] - start);
    }
    let passed = steps * sim.params().timestep;
    let lost = (speed - sim.state.qvel[0]) / (friction * G * passed);
    (rise, lost)
}

#[test]
fn a_box_that_slides_stays_on_the_floor_and_loses_mu_g() {
    let law = RigidOptions::new().contact_model(ContactModel::Coulomb);
    for edge in [0.02, 0.1, 1.0] {
        for friction in [0.3, 1.0, 2.0] {
            for speed in [1.0, 6.0, 20.0] {
                for (timestep, cone) in [
                    (0.002, FrictionCone::Pyramidal),
                    (0.002, FrictionCone::Elliptic),
                    (0.005, FrictionCone::Elliptic),
                ] {
                    let law = law.friction_cone(cone);
                    let (rise, lost) = slide(law, timestep, edge, friction, speed);
                    let what = format!("{timestep} s, edge {edge}, mu {friction}, {speed} m/s");
                    assert!(rise < 1e-5, "{what}: rises by {rise} m");
                    assert!((lost - 1.0).abs() < 0.01, "{what}: {lost} mu g");
                }
            }
        }
    }
    // The convex model lifts it: the test would see it.
    let (rise, _) = slide(RigidOptions::new(), 0.002, 0.1, 1.0, 6.0);
    assert!(rise > 1e-2, "{rise}");
}

#[test]
fn a_box_slides_down_a_slope_as_coulomb_says() {
    let angle: f64 = 0.5;
    for share in [0.2, 0.5, 0.9, 0.95] {
        let friction = share * angle.tan();
        let flat = cuboid([0.1, 0.1, 0.02]);
        let mut sim = coulomb(&on_floor(angle, friction, 0.02, flat));
        run(&mut sim, 1.0);
        let before = sim.state.qvel[0].hypot(sim.state.qvel[2]);
        run(&mut sim, 1.0);
        let gained = sim.state.qvel[0].hypot(sim.state.qvel[2]) - before;
        let expected = G * (angle.sin() - friction * angle.cos());
        assert!(
            (gained / expected - 1.0).abs() < 0.01,
            "{share}: {gained} m/s in 1 s, not {expected}"
        );
    }
}

#[test]
fn a_sphere_thrown_with_back_spin_ends_rolling_at_the_speed_that_its_spin_leaves() {
    let (radius, friction) = (0.1, 0.2);
    for (speed, spin) in [(2.0, -10.0), (1.0, -40.0), (3.0, 60.0)] {
        let mut sim = coulomb(&on_floor(0.0, friction, radius, sphere(radius)));
        run(&mut sim, 1.0);
        sim.state.qvel[0] = speed;
        sim.state.qvel[4] = spin;
        // The contact point slips until v = r ω; about it, the angular momentum is conserved.
        let rolling = (5.0 * speed + 2.0 * radius * spin) / 7.0;
        let slip: f64 = speed - radius * spin;
        let seconds = slip.abs() / (3.5 * friction * G);
        run(&mut sim, 0.5 * seconds);
        let halfway = speed - 0.5 * seconds * friction * G * slip.signum();
        let found = sim.state.qvel[0];
        assert!((found - halfway).abs() < 0.01 * speed, "{found} {halfway}");
        run(&mut sim, seconds);
        let found = sim.state.qvel[0];
        assert!((found - rolling).abs() < 0.01 * speed, "{found} {rolling}");
        assert!((found - radius * sim.state.qvel[4]).abs() < 0.01 * speed);
    }
}

/// Files for MJX have such limits.
#[test]
fn a_small_limit_of_line_searches_does_not_leave_other_normal_forces() {
    let law = RigidOptions::new().contact_model(ContactModel::Coulomb);
    let options = law.impratio(100.0).ls_iterations(4);
    let builder = on_floor(0.0, 0.5, 0.15, sphere(0.1));
    let mut sim = Sim::with_options(model(&builder), options).expect("valid");
    sim.state.qvel[4] = -40.0;
    for _ in 0..300 {
        sim.step().expect("finite");
        let residual = sim.stats().normal_residual;
        assert!(residual < 1e-6, "{residual} N");
    }
}

/// Returns the most that the energy of a settling tower of boxes exceeds its least value so far, and its kinetic energy
/// at the end.
fn settle(options: RigidOptions) -> [f64; 2] {
    let mut b = world();
    b.bodies[0].geoms.push(plane());
    for level in 0..10 {
        let height = 0.03 + 0.0601 * f64::from(level);
        let at = [0.003 * f64::from(level % 3), 0.0, height];
        let shape = vec![cuboid([0.05, 0.05, 0.03])];
        add(&mut b, 0, &format!("box{level}"), at, free(), shape);
    }
    let law = options.contact_model(ContactModel::Coulomb);
    let mut sim: Sim = Sim::with_options(model(&b), law).expect("valid");
    sim.set_timestep(0.005).expect("positive");
    let (mut least, mut rise): (f64, f64) = (f64::INFINITY, 0.0);
    for _ in 0..500 {
        sim.step().expect("finite");
        let energy = sim.energy().expect("finite");
        let energy = energy.kinetic + energy.potential;
        least = least.min(energy);
        rise = rise.max(energy - least);
    }
    [rise, sim.energy().expect("finite").kinetic]
}

#[test]
fn a_tower_stands_though_its_solves_end_early() {
    for impratio in [1.0, 100.0] {
        let options = RigidOptions::new().impratio(impratio);
        // The boxes settle and rebound.
        let [expected, _] = settle(options);
        for iterations in [4, 10] {
            let short = options.constraint_solver(ConstraintSolver::Cg);
            let [rise, kinetic] = settle(short.iterations(iterations));
            let what = format!("impratio {impratio}, {iterations} iterations");
            assert!(rise < 1.5 * expected, "{what}: {rise} J, not {expected} J");
            assert!(kinetic < 1e-5, "{what}: {kinetic} J");
        }
    }
}

#[test]
fn a_rod_that_jams_against_the_floor_ends_its_slide_the_same_way_each_time() {
    // Painlevé's rod: at this angle and friction the linear equations of sliding have no solution.
    let end = || {
        let mut b = world();
        let friction = [2.5, 0.0, 0.0];
        b.bodies[0].geoms.push(GeomSpec {
            friction,
            ..plane()
        });
        let (length, radius, angle): (f64, f64, f64) = (1.0, 0.02, 1.0);
        let tilt = Quat::new((angle / 2.0).cos(), 0.0, (angle / 2.0).sin(), 0.0);
        let rod = GeomSpec {
            friction,
            ..cuboid([length / 2.0, radius, radius])
        };
        let height = length / 2.0 * angle.sin() + radius * angle.cos();
        let body = add(&mut b, 0, "rod", [0.0, 0.0, height], free(), vec![rod]);
        b.bodies[body].quat = tilt;
        let mut sim = coulomb(&b);
        sim.state.qvel[0] = 4.0;
        run(&mut sim, 0.5);
        sim.state.qpos.clone()
    };
    let first = end();
    assert!(first.iter().all(|x| x.is_finite()));
    assert_eq!(first, end());
}
