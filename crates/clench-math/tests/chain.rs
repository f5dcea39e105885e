//! A kernel of the kind that the dynamics are made of, run for N environments at once: each environment's result is
//! to the bit that of running it alone.
//!
//! A chain of hinges: forward kinematics, link velocities, bias accelerations and kinetic energy, with what
//! differs between environments (a joint that is locked, a limit that is reached) as masks.

mod support;

use clench_math::{Inertia, Lanes, Mask, Motion, Quat, Real, Vec3};
use support::{Random, TestScalar};

const LINKS: usize = 6;

/// What an environment starts from, and what it ends with: rows of numbers as users keep them.
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

fn axis<T: Real>(link: usize) -> Vec3<T> {
    let axes = [[0.0, 0.0, 1.0], [0.6, 0.8, 0.0], [0.0, 1.0, 0.0]];
    Vec3::from_f64(axes[link % 3])
}

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
        // A joint beyond a full turn is locked: its velocity does not count.
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

/// A soft limit with a real power in its impedance, skipped where no environment is near it.
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

fn numbers<T: Real>(outcome: &Outcome<T>) -> Vec<T> {
    let mut all = Vec::new();
    all.extend(outcome.tip.to_array());
    all.extend(outcome.orientation.to_array());
    all.extend(outcome.velocity.to_array());
    all.extend(outcome.bias.to_array());
    all.extend(outcome.orientation.to_rotation_vector().to_array());
    all.extend([outcome.energy, outcome.limit_force]);
    all
}

fn lanes_equal_environments_alone<S: TestScalar, const N: usize>() {
    let mut random = Random::new(N as u64);
    for round in 0..500 {
        let mut wide = State {
            angle: [Lanes::<S, N>::ZERO; LINKS],
            velocity: [Lanes::ZERO; LINKS],
        };
        let single: [State<S>; N] = std::array::from_fn(|i| {
            let mut number = |size: f64| S::new(random.between(-size, size));
            let mut state = State {
                angle: std::array::from_fn(|_| number(if round % 2 == 0 { 0.9 } else { 8.0 })),
                velocity: std::array::from_fn(|_| number(5.0)),
            };
            // One environment that has gone wrong must not touch its neighbours.
            if round % 10 == 9 && i == 1 {
                state.velocity[2] = S::INFINITY;
            }
            for link in 0..LINKS {
                wide.angle[link].set_lane(i, state.angle[link]);
                wide.velocity[link].set_lane(i, state.velocity[link]);
            }
            state
        });
        let together = numbers(&run_chain(&wide));
        for (i, state) in single.iter().enumerate() {
            for (k, alone) in numbers(&run_chain(state)).into_iter().enumerate() {
                let lane = together[k].lane(i);
                assert_eq!(
                    lane.identity(),
                    alone.identity(),
                    "number {k}, lane {i}: {lane} {alone}"
                );
            }
        }
    }
}

#[test]
fn in_lanes_as_alone() {
    lanes_equal_environments_alone::<f64, 4>();
    lanes_equal_environments_alone::<f64, 8>();
    lanes_equal_environments_alone::<f32, 16>();
}

/// The kernel itself is right: the velocity of the tip is the derivative of its position.
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
        support::assert_close(&rate.to_array(), &velocity.to_array(), 1e-8, "tip velocity");
        let spin = at(step).velocity.angular - at(-step).velocity.angular;
        let bias = now.bias.angular.to_array();
        support::assert_close(
            &(spin * (0.5 / step)).to_array(),
            &bias,
            1e-8,
            "bias acceleration",
        );
    }
}
