//! A step of many environments side by side is the step of each, to the bit.

mod machines;

use clench_math::{Clock, Lanes, Quat, Real, Scalar, Vec3};
use clench_rigid::model::{Integrator, Model};
use clench_rigid::pipeline::step;
use clench_rigid::{Sim, State, StepSettings, Workspace};
use machines::{everything, shake, sim};

const STEPS: usize = 25;

/// State `seed` of a machine, in another number type.
fn shaken<S: Scalar>(model: &Model, seed: u64) -> State<S> {
    let mut sim: Sim = sim(&everything());
    shake(&mut sim, seed);
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
    // One lane is pushed, another has a quaternion that is not of unit length.
    if seed == 1 {
        state.xfrc_applied[3].linear = Vec3::new(S::ONE, S::ZERO, S::new(-0.5));
    }
    if seed == 2 {
        let q = Quat::from_slice(&state.qpos[3..])
            .to_array()
            .map(|x| x * S::new(1.5));
        state.qpos[3..7].copy_from_slice(&q);
    }
    state
}

/// Steps each lane alone and all together.
fn compare<S: Scalar, const N: usize>(integrator: Integrator)
where
    Lanes<S, N>: Real<Scalar = S>,
{
    let mut builder = everything();
    builder.physics.integrator = integrator;
    let model = machines::model(&builder);
    let settings = StepSettings::new::<S>(&model, Default::default()).expect("defaults");

    let alone: Vec<State<S>> = (0..N as u64)
        .map(|seed| {
            let params = model.params.broadcast::<S>();
            let mut ws = Workspace::new(&model);
            let mut state = shaken::<S>(&model, seed);
            for _ in 0..STEPS {
                step(&model, &params, &settings, &mut state, &mut ws);
            }
            state
        })
        .collect();

    let params = model.params.broadcast::<Lanes<S, N>>();
    let mut ws = Workspace::new(&model);
    let mut state = State::<Lanes<S, N>>::new(&model);
    for lane in 0..N {
        let one = shaken::<S>(&model, lane as u64);
        let write = |to: &mut [Lanes<S, N>], from: &[S]| {
            for (to, &from) in to.iter_mut().zip(from) {
                to.set_lane(lane, from);
            }
        };
        write(&mut state.qpos, &one.qpos);
        write(&mut state.qvel, &one.qvel);
        write(&mut state.act, &one.act);
        write(&mut state.ctrl, &one.ctrl);
        for (to, from) in state.xfrc_applied.iter_mut().zip(&one.xfrc_applied) {
            for axis in 0..3 {
                to.linear[axis].set_lane(lane, from.linear[axis]);
            }
        }
    }
    for _ in 0..STEPS {
        step(&model, &params, &settings, &mut state, &mut ws);
    }

    for (lane, one) in alone.iter().enumerate() {
        let same = |together: &[Lanes<S, N>], alone: &[S], what: &str| {
            for (i, (t, a)) in together.iter().zip(alone).enumerate() {
                let (t, a) = (t.lane(lane).to_f64(), a.to_f64());
                assert!(a.is_finite(), "{what}[{i}] of lane {lane} is {a}");
                assert_eq!(t.to_bits(), a.to_bits(), "{what}[{i}], lane {lane}");
            }
        };
        same(&state.qpos, &one.qpos, "qpos");
        same(&state.qvel, &one.qvel, "qvel");
        same(&state.act, &one.act, "act");
        same(&state.qacc_warmstart, &one.qacc_warmstart, "qacc");
        assert_eq!(state.time.lane(lane).to_bits(), one.time.to_bits());
    }
}

#[test]
fn lanes_step_as_alone_in_double_precision() {
    for integrator in [
        Integrator::Euler,
        Integrator::ImplicitFast,
        Integrator::Implicit,
        Integrator::Rk4,
    ] {
        compare::<f64, 4>(integrator);
    }
}

#[test]
fn lanes_step_as_alone_in_single_precision() {
    for integrator in [
        Integrator::Euler,
        Integrator::ImplicitFast,
        Integrator::Implicit,
        Integrator::Rk4,
    ] {
        compare::<f32, 8>(integrator);
    }
}
