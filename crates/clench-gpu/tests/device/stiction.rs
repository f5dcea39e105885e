//! Friction that sticks: its forces and its memory are those of the processor, from states whose memory is filled.

use crate::common::{self, Random, batch, general_batch, own, random_state, text};
use clench_gpu::{GpuBatch, GpuReal};
use clench_math::Vec3;
use clench_rigid::batch::EnvStatus;
use clench_rigid::model::Model;
use clench_rigid::options::RigidOptions;
use clench_rigid::state::kind::{Kind, Reference};
use clench_rigid::{Batch, BatchOptions, Fault, Sim, State};
use std::sync::Arc;

/// Returns states with memory: those after some steps from random states, with every pair and every dry friction
/// displaced a little further.
fn states_with_memory(model: &Arc<Model>, count: usize) -> Vec<State<f32>> {
    let mut random = Random::new(5);
    let mut sim = Sim::<f32>::new(model.clone()).expect("a good model");
    let model = sim.model().clone();
    let mut state = |_| {
        sim.state = random_state(&model, &mut random, 0.1);
        sim.state.ctrl.fill(0.02);
        for _ in 0..10 {
            sim.step().expect("a good state");
        }
        let mut small = |size: f64| (size * random.signed()) as f32;
        for reference in &mut sim.state.stick_references {
            if reference.first != 0.0 {
                reference.position += Vec3::new(small(1e-4), small(1e-4), small(1e-4));
                reference.rotation.x += small(1e-3);
                reference.rotation.z += small(1e-3);
            }
        }
        for displacement in &mut sim.state.stick_friction {
            *displacement += small(1e-3);
        }
        sim.state.clone()
    };
    Vec::from_iter((0..count).map(&mut state))
}

/// Returns a scene with `law` in place of its options, and states with memory.
fn scene(law: &str) -> (Arc<Model>, Vec<State<f32>>) {
    let model = text(&own("sticky").replacen("<option ", law, 1));
    let states = states_with_memory(&model, 12);
    let used = states.iter().flat_map(|s| &s.stick_references);
    let used = used.filter(|r| r.first != 0.0).count();
    assert!(used > 48, "{used} pairs stick");
    (model, states)
}

/// Asserts that states with memory lead to the processor's forces, states and memories, under a law.
fn agree(law: &str) {
    let (model, states) = scene(law);
    let Some(mut double) = general_batch::<f64>(&model, states.len()) else {
        return;
    };
    common::forward_agrees_in_double(&mut double, &states, 1e-9);
    steps_agree(&mut double, &states, 5, 1e-9, 0);
}

/// Asserts that positions, stick references and the displacements of dry friction are near the processor's after steps;
/// the references of `strays` states may be far.
fn steps_agree<S: GpuReal>(
    batch: &mut GpuBatch<S>,
    states: &[State<f32>],
    steps: usize,
    tolerance: f64,
    strays: usize,
) {
    let model = batch.model().clone();
    batch.reset().expect("a device");
    common::upload(batch, states);
    batch.step(steps).expect("a device");
    common::assert_all_run(batch);
    let wide = |x: &[S]| Vec::from_iter(x.iter().map(|x| x.to_f64()));
    let names = ["qpos", "stick_friction", "stick_references"];
    let found = names.map(|name| wide(&batch.read(name).expect("a device")));
    let mut sim = Sim::<S>::new(model.clone()).expect("a good model");
    let mut far = [0; 3];
    for (env, state) in states.iter().enumerate() {
        sim.state = common::convert(&model, state);
        for _ in 0..steps {
            sim.step().expect("a good state");
        }
        let expected = [
            wide(&sim.state.qpos),
            wide(&sim.state.stick_friction),
            common::reference_numbers(&sim.state.stick_references),
        ];
        for ((far, found), expected) in far.iter_mut().zip(&found).zip(&expected) {
            let found = &found[env * expected.len()..][..expected.len()];
            let gaps = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
            *far += usize::from(gaps.fold(0.0, f64::max) > tolerance);
        }
    }
    let [positions, friction, references] = far;
    assert_eq!([positions, friction], [0, 0], "{steps} steps: {names:?}");
    assert!(
        references <= strays,
        "{steps} steps: {references} references"
    );
}

#[test]
fn pyramids_stick_as_on_the_processor() {
    agree("<option ");
}

#[test]
fn pyramids_stick_in_single_precision() {
    let (model, states) = scene("<option ");
    if let Some(mut single) = batch(&model, states.len()) {
        common::forward_agrees_in(&mut single, &states, 1e-4, 0);
        steps_agree(&mut single, &states, 1, 1e-6, 0);
        // Rounding decides when a reference that rolls is replaced.
        steps_agree(&mut single, &states, 20, 1e-5, 1);
    }
}

#[test]
fn elliptic_cones_stick_as_on_the_processor() {
    agree("<option integrator='implicitfast' cone='elliptic' impratio='3' ");
}

#[test]
fn friction_sticks_at_the_end_of_a_discrete_step() {
    agree("<option integrator='discrete' cone='elliptic' ");
}

/// Runge–Kutta drags the memory along once per step.
#[test]
fn coulombs_law_sticks_as_on_the_processor_by_runge_kutta() {
    agree(
        "<custom><text name='clench.contact_model' data='coulomb'/></custom>
         <option integrator='RK4' ",
    );
}

/// Returns a hand and a load, with friction that sticks.
fn hand() -> Arc<Model> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/grasp.xml");
    let file = std::fs::read_to_string(path).expect("a model of ours is there");
    let sticking = "<custom><text name='clench.stiction' data='true'/></custom><worldbody>";
    text(&file.replacen("<worldbody>", sticking, 1))
}

/// Returns options with slots for a number of pairs.
fn slots(pairs: usize) -> BatchOptions {
    BatchOptions {
        options: RigidOptions::new().max_stick_pairs(pairs),
        ..BatchOptions::default()
    }
}

/// Starts in the state in which the hand holds the load.
fn hold(batch: &mut Batch<f32>) {
    for env in 0..batch.count() {
        batch.reset_to_keyframe(env, 0).expect("a keyframe");
    }
}

#[test]
fn a_hand_holds_its_load_and_its_memory_travels_with_the_state() {
    let model = hand();
    let Some(device) = &mut common::stepped(&model, 3, slots(0)) else {
        return;
    };
    let processor = Batch::<f32>::with_options(model, 3, slots(0));
    let processor = &mut processor.expect("a good model");
    hold(device);
    device.step_n(200).expect("a device");
    let saved = device.save().expect("rows");
    let height = device.state.qpos.row(0)[5];
    device.step_n(200).expect("a device");
    let sunk = (device.state.qpos.row(0)[5] - height).abs();
    assert!(sunk < 3e-6, "the load slides by {sunk} m");
    let memory = device.state.stick_references.as_slice().to_vec();
    assert!(
        memory[0] != 0.0 && memory[Reference::WIDTH] != 0.0,
        "both fingers hold it"
    );
    // The state leads to the same memory here, and to a similar one there.
    for (batch, tolerance) in [(&mut *device, 0.0), (processor, 3e-6)] {
        batch.restore(&saved).expect("the same model");
        batch.step_n(200).expect("good states");
        let gaps = batch.state.stick_references.as_slice().iter().zip(&memory);
        let gap = gaps.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(gap <= tolerance, "{gap}");
    }
    // A failed step keeps it, and a reset clears it.
    device.state.qfrc_applied.row_mut(1).fill(1e30);
    device.reset(2).expect("an environment");
    device.step_n(20).expect("a device");
    assert!(matches!(
        device.status(1),
        EnvStatus::Failed(Fault::Diverged { .. })
    ));
    let width = device.state.stick_references.width();
    assert_eq!(
        device.state.stick_references.row(1),
        &memory[width..2 * width]
    );
    let fresh = device.state.stick_references.row(2);
    assert_eq!(
        [fresh[0], fresh[Reference::WIDTH]],
        [1.0, 0.0],
        "the load lies on the floor"
    );
}

#[test]
fn too_few_slots_are_a_fault_that_names_the_option() {
    let model = hand();
    let Some(device) = common::stepped(&model, 1, slots(1)) else {
        return;
    };
    let processor = Batch::<f32>::with_options(model, 1, slots(1));
    let [found, expected] = [device, processor.expect("a good model")].map(|mut batch| {
        hold(&mut batch);
        let before = batch.state.qpos.row(0).to_vec();
        batch.step_n(3).expect("a fault is no error");
        assert_eq!(batch.state.qpos.row(0), before);
        batch.status(0)
    });
    assert_eq!(found, expected);
    assert!(
        format!("{found:?}").contains("max_stick_pairs"),
        "{found:?}"
    );
}
