//! Bitwise equality of batches and single simulations: all joints, tendons and actuators, under every integrator.

use crate::batches::{assert_state, with};
use crate::machines;
use clench_math::{Instructions, Quat, Vec3};
use clench_rigid::model::{Integrator, Model};
use clench_rigid::options::RigidOptions;
use clench_rigid::{Batch, Precision, Sim, State};

const ENVS: u64 = 19;
const STEPS: usize = 25;

/// Returns random state `seed`; one is pushed, another has a quaternion that is not of unit length.
fn shaken<S: Precision>(model: &Model, seed: u64) -> State<S> {
    let mut sim = machines::sim(&machines::everything());
    machines::shake(&mut sim, seed);
    let mut state = State::<S>::new(model);
    let cast = |from: &[f64], to: &mut [S]| {
        for (to, &from) in to.iter_mut().zip(from) {
            *to = S::new(from);
        }
    };
    cast(&sim.state.qpos, &mut state.qpos);
    cast(&sim.state.qvel, &mut state.qvel);
    cast(&sim.state.act, &mut state.act);
    cast(&sim.state.ctrl, &mut state.ctrl);
    if seed == 1 {
        state.xfrc_applied[3].linear = Vec3::new(S::ONE, S::ZERO, S::new(-0.5));
    }
    if seed == 2 {
        let orientation = Quat::from_slice(&state.qpos[3..]).to_array();
        state.qpos[3..7].copy_from_slice(&orientation.map(|x| x * S::new(1.5)));
    }
    state
}

fn compare<S: Precision>() {
    for integrator in [
        Integrator::Euler,
        Integrator::ImplicitFast,
        Integrator::Implicit,
        Integrator::Rk4,
        Integrator::Discrete,
    ] {
        let mut builder = machines::everything();
        builder.physics.integrator = integrator;
        let model = machines::model(&builder);
        let ends: Vec<State<S>> = (0..ENVS)
            .map(|env| {
                let mut sim = Sim::<S>::new(model.clone()).expect("valid");
                sim.state = shaken(&model, env);
                for _ in 0..STEPS {
                    sim.step().expect("finite");
                }
                sim.state
            })
            .collect();
        for instructions in Instructions::all_available::<S>() {
            let options = with(instructions, 1, RigidOptions::default());
            let mut batch =
                Batch::<S>::with_options(model.clone(), ENVS as usize, options).expect("valid");
            for env in 0..ENVS {
                let state = shaken(&model, env);
                batch.state.write(env as usize, &state).expect("valid");
            }
            batch.step_n(STEPS).expect("valid");
            for (env, end) in ends.iter().enumerate() {
                let what = || format!("{integrator:?}, {instructions:?}");
                assert_state(&batch, env, end, &what);
            }
        }
    }
}

#[test]
fn environments_step_as_alone_in_double_precision() {
    compare::<f64>();
}

#[test]
fn environments_step_as_alone_in_single_precision() {
    compare::<f32>();
}
