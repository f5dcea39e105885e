//! A kernel like those of the dynamics, run for N environments at once: each result equals, to the bit, that of a
//! single environment.
//!
//! A chain of hinges: forward kinematics, link velocities, bias accelerations and kinetic energy. Masks express what
//! differs between environments (a locked joint, a reached limit).

use crate::support::{EqualsAlone, Formula, Random, TestScalar, in_instruction_sets};
use clench_math::{Inertia, Mask, Motion, Quat, Real, Vec3, kernel};

const LINKS: usize = 6;

/// The initial state of an environment.
#[derive(Clone, Copy)]
struct State<T> {
    angle: [T; LINKS],
    velocity: [T; LINKS],
}
#[derive(Clone, Copy)]
struct Outcome<T> {
    tip: Vec3<T>,
    orientation: Quat<T>,
    velocity: Motion<T>,
    bias: Motion<T>,
    energy: T,
    limit_force: T,
}

#[inline(always)]
fn axis<T: Real>(link: usize) -> Vec3<T> {
    let axes = [[0.0, 0.0, 1.0], [0.6, 0.8, 0.0], [0.0, 1.0, 0.0]];
    Vec3::from_f64(axes[link % 3])
}

#[kernel]
fn run_chain<T: Real>(state: &State<T>) -> Outcome<T> {
    let mut out = Outcome {
        tip: Vec3::ZERO,
        orientation: Quat::IDENTITY,
        velocity: Motion::ZERO,
        bias: Motion::ZERO,
        energy: T::ZERO,
        limit_force: T::ZERO,
    };
    for link in 0..LINKS {
        // A joint beyond a full turn is locked: its velocity is ignored.
        let locked = state.angle[link].abs().gt(T::new(std::f64::consts::TAU));
        let rate = T::select(locked, T::ZERO, state.velocity[link]);
        let world_axis = out.orientation.rotate(axis(link));
        let joint = Motion::new(world_axis, out.tip.cross(world_axis));
        out.bias += out.velocity.cross(joint) * rate;
        out.velocity += joint * rate;
        out.orientation =
            (out.orientation * Quat::from_axis_angle(axis(link), state.angle[link])).normalize();

        let half = out.orientation.rotate(Vec3::from_f64([0.1, 0.05, 0.2]));
        let inertia = Inertia::from_principal(
            Vec3::from_f64([0.03, 0.02, 0.01]),
            &out.orientation.to_matrix(),
            out.tip + half,
            T::new(1.5),
        );
        out.energy += T::new(0.5) * out.velocity.dot(inertia * out.velocity);
        out.tip += half * T::new(2.0);
        out.limit_force += limit_force(state.angle[link], rate);
    }
    out
}

/// Computes a soft limit force with a real power in its impedance, skipped if no environment is near the limit.
#[inline(always)]
fn limit_force<T: Real>(angle: T, rate: T) -> T {
    let violation = angle.abs() - T::new(1.0);
    let active = violation.gt(T::ZERO);
    if !active.any() {
        return T::ZERO;
    }
    let impedance = violation.max(T::ZERO).min(T::ONE).powf(T::new(2.3));
    let force = T::new(100.0) * impedance * violation + rate * (-violation).exp();
    T::select(active, force, T::ZERO)
}

#[derive(Clone, Copy)]
struct Chain;
impl Formula for Chain {
    const ARGUMENTS: usize = 2 * LINKS;
    #[inline(always)]
    fn evaluate<T: Real>(self, arguments: &[T]) -> Vec<(&'static str, T)> {
        let out = run_chain(&State {
            angle: std::array::from_fn(|i| arguments[i]),
            velocity: std::array::from_fn(|i| arguments[LINKS + i]),
        });
        let turned = out.orientation.to_rotation_vector();
        let mut all = vec![("energy", out.energy), ("limit force", out.limit_force)];
        all.extend(out.tip.to_array().map(|x| ("tip", x)));
        all.extend(out.orientation.to_array().map(|x| ("orientation", x)));
        all.extend(out.velocity.to_array().map(|x| ("velocity", x)));
        all.extend(out.bias.to_array().map(|x| ("bias", x)));
        all.extend(turned.to_array().map(|x| ("rotation vector", x)));
        all
    }
}

fn lanes_equal_environments_alone<S: TestScalar>() {
    let check = |draw: &dyn Fn(&mut Random) -> S| {
        in_instruction_sets(EqualsAlone {
            formula: Chain,
            rounds: 500,
            draw,
        });
    };
    // Within the limits, and beyond them in most environments.
    for size in [0.9, 8.0] {
        check(&|random| S::new(random.between(-size, size)));
    }
    // An environment with non-finite numbers must not affect its neighbours.
    check(&|random| {
        let number = random.between(-5.0, 5.0);
        match random.bits() % 50 {
            0 => S::INFINITY,
            1 => S::new(f64::NAN),
            _ => S::new(number),
        }
    });
}
#[test]
fn a_chain_moves_in_lanes_as_alone() {
    lanes_equal_environments_alone::<f64>();
    lanes_equal_environments_alone::<f32>();
}

/// Checks the kernel itself: the velocity of the tip is the derivative of its position.
#[test]
fn the_tip_moves_at_its_velocity() {
    let mut random = Random::new(11);
    for _ in 0..100 {
        let state = State {
            angle: std::array::from_fn(|_| random.between(-3.0, 3.0)),
            velocity: std::array::from_fn(|_| random.between(-2.0, 2.0)),
        };
        let at = |time: f64| {
            let angle = std::array::from_fn(|i| state.angle[i] + time * state.velocity[i]);
            run_chain(&State { angle, ..state })
        };
        let (now, step) = (at(0.0), 1e-5);
        let rate = (at(step).tip - at(-step).tip) * (0.5 / step);
        let velocity = now.velocity.velocity_at(now.tip);
        crate::support::assert_close(&rate.to_array(), &velocity.to_array(), 1e-8, "tip velocity");
        let spin = at(step).velocity.angular - at(-step).velocity.angular;
        let bias = now.bias.angular.to_array();
        crate::support::assert_close(
            &(spin * (0.5 / step)).to_array(),
            &bias,
            1e-8,
            "bias acceleration",
        );
    }
}
