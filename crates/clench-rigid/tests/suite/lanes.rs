//! Environments that share a register move as single simulations, to the bit.

use crate::scenes::{Numbers, loose_parts};
use clench_dynamics::Step;
use clench_dynamics::StepContext;
use clench_math::{Instructions, LaneTask, Mask, Real, Scalar};
use clench_rigid::model::Integrator;
use clench_rigid::options::{FrictionCone, RigidOptions};
use clench_rigid::{Model, Sim, State, StepSettings};
use clench_solver::ConstraintSolver;
use std::sync::Arc;

/// Returns one of `count` environments: its velocities differ, and the last has the weld on.
fn start(model: &Arc<Model>, options: RigidOptions, lane: usize, count: usize) -> Sim {
    let mut sim = Sim::with_options(model.clone(), options).expect("valid");
    Numbers(lane as u64).fill(&mut sim.state.qvel, 1.5);
    sim.state.eq_active[0] = lane + 1 == count;
    sim
}

/// Steps environments in lanes of every available instruction set. Returns true if any had too many contacts.
fn compare(options: RigidOptions, integrator: Integrator, steps: usize) -> bool {
    let mut overflow = false;
    for instructions in Instructions::all_available::<f64>() {
        let task = Compare {
            options,
            integrator,
            steps,
        };
        let found = f64::in_lanes(instructions, task);
        overflow |= found.expect("the instructions are available");
    }
    overflow
}

struct Compare {
    options: RigidOptions,
    integrator: Integrator,
    steps: usize,
}

impl LaneTask<f64> for Compare {
    type Output = bool;
    fn run<T: Real<Scalar = f64>>(self) -> bool {
        in_lanes::<T>(self.options, self.integrator, self.steps)
    }
}

/// Steps all environments together and singly. Returns true if any had too many contacts.
fn in_lanes<T: Real<Scalar = f64>>(
    options: RigidOptions,
    integrator: Integrator,
    steps: usize,
) -> bool {
    let count = T::LANES;
    let compiled = Step::<T>::compiled();
    let mut builder = loose_parts();
    builder.physics.integrator = integrator;
    let model = crate::scenes::model(&builder);
    let start = |lane| start(&model, options, lane, count);
    let mut alone = Vec::from_iter((0..count).map(start));

    let settings = StepSettings::new::<T>(&model, options).expect("valid");
    let params = model.params.broadcast::<T>();
    let (mut state, mut ws) = (State::<T>::new(&model), (compiled.workspace)(&model));
    for (lane, sim) in alone.iter().enumerate() {
        for (to, &from) in state.qvel.iter_mut().zip(&sim.state.qvel) {
            to.set_lane(lane, from);
        }
        state.eq_active[0].set_lane(lane, sim.state.eq_active[0]);
    }
    let context = StepContext::without_sensors(&model, &params, &settings);
    let (mut contacts, mut overflow) = (vec![0; count], false);
    for step in 0..steps {
        (compiled.step)(context, &mut state, &mut ws);
        for (lane, sim) in alone.iter_mut().enumerate() {
            sim.step().expect("finite");
            let same = |what: &str, wide: &[T], narrow: &[f64]| {
                for (i, (w, n)) in wide.iter().zip(narrow).enumerate() {
                    let w = w.lane(lane);
                    assert!(
                        w.to_bits() == n.to_bits(),
                        "step {step}, lane {lane}: {what}[{i}] is {w}, alone {n}"
                    );
                }
            };
            same("qpos", &state.qpos, &sim.state.qpos);
            same("qvel", &state.qvel, &sim.state.qvel);
            same("qacc", &ws.qacc, &sim.workspace().qacc);
            same(
                "qfrc_constraint",
                &ws.qfrc_constraint,
                &sim.workspace().qfrc_constraint,
            );
            let active = ws.contacts.iter().filter(|c| c.active.lane(lane)).count();
            assert_eq!(
                active,
                sim.contacts().len(),
                "step {step}, lane {lane}: contacts"
            );
            assert_eq!(
                ws.solver.stats().lane(lane).iterations,
                sim.stats().iterations
            );
            assert_eq!(ws.collision.overflow.lane(lane), sim.contact_overflow());
            overflow |= sim.contact_overflow();
            contacts[lane] += active;
        }
    }
    assert!(
        contacts.iter().all(|&c| c > steps),
        "all touch: {contacts:?}"
    );
    assert!(
        count == 1 || contacts.windows(2).any(|c| c[0] != c[1]),
        "but not alike: {contacts:?}"
    );
    overflow
}

#[test]
fn newton_with_pyramids_in_lanes_equals_scalars() {
    assert!(!compare(RigidOptions::new(), Integrator::Euler, 300));
}

#[test]
fn newton_with_elliptic_cones_in_lanes_equals_scalars() {
    let options = RigidOptions::new()
        .friction_cone(FrictionCone::Elliptic)
        .impratio(3.0);
    assert!(!compare(options, Integrator::ImplicitFast, 300));
}

#[test]
fn cg_and_runge_kutta_in_lanes_equal_scalars() {
    let options = RigidOptions::new().constraint_solver(ConstraintSolver::Cg);
    assert!(!compare(options, Integrator::Rk4, 300));
}

#[test]
fn a_bound_on_contacts_holds_for_each_lane() {
    let options = RigidOptions::new().max_contacts(clench_rigid::options::MaxContacts::Limit(3));
    assert!(
        compare(options, Integrator::Euler, 300),
        "the bound was reached"
    );
}
