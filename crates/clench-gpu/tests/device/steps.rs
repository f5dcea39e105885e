//! Steps: trajectories, and the independence of environments.

use crate::common::{
    self, assert_all_run, convert, difference, general_batch, own, some_states, text, upload,
};
use clench_gpu::{GpuBatch, GpuFault};
use clench_rigid::model::Model;
use clench_rigid::options::{MaxContacts, RigidOptions};
use clench_rigid::{Sim, State};
use std::sync::Arc;

fn runner() -> Arc<Model> {
    text(&own("runner"))
}

/// Returns a batch with room for a number of contacts.
fn limited_batch(model: &Arc<Model>, count: usize, contacts: usize) -> Option<GpuBatch> {
    let options = RigidOptions::new().max_contacts(MaxContacts::Limit(contacts));
    common::try_general_batch(model, count, options).unwrap_or_else(|e| panic!("{e}"))
}

/// Asserts that after `steps` steps from 24 states the device has drifted as the processor's single precision has.
fn drift_alike(model: &Arc<Model>, steps: usize) {
    common::drift_alike(model, 24, steps);
}

#[test]
fn a_runner_drifts_as_on_the_processor() {
    drift_alike(&runner(), 100);
}

#[test]
fn so_does_one_by_runge_kutta() {
    let rk4 = own("runner").replace("<option ", "<option integrator=\"RK4\" ");
    drift_alike(&text(&rk4), 100);
}

#[test]
fn so_does_a_serpent_whose_path_is_long() {
    drift_alike(&text(&own("serpent")), 50);
}

#[test]
fn so_do_a_medley_and_a_linkage_implicit_in_velocities() {
    for name in ["medley", "linkage"] {
        let implicit = own(name).replace("<option ", "<option integrator=\"implicitfast\" ");
        drift_alike(&text(&implicit), 50);
    }
}

#[test]
fn activations_are_integrated_by_either_integrator() {
    let linkage = own("linkage");
    drift_alike(&text(&linkage), 100);
    let rk4 = linkage.replace("<option ", "<option integrator=\"RK4\" ");
    drift_alike(&text(&rk4), 50);
}

#[test]
fn so_do_bodies_on_surfaces_that_move_and_adhere() {
    drift_alike(&text(&own("surfaces")), 50);
}

#[test]
fn so_do_ellipsoids_in_a_medium() {
    let swimmers = own("swimmers");
    drift_alike(&text(&swimmers), 50);
    let implicit = swimmers.replace("<option ", "<option integrator=\"implicitfast\" ");
    drift_alike(&text(&implicit), 50);
}

#[test]
fn so_do_controllers_and_motors() {
    let controllers = own("controllers");
    for integrator in ["Euler", "implicitfast"] {
        let option = format!("<option integrator=\"{integrator}\" ");
        drift_alike(&text(&controllers.replace("<option ", &option)), 50);
    }
}

/// Runge–Kutta integrates the stiff friction of these motors explicitly, so longer steps diverge from random
/// deflections.
#[test]
fn so_do_controllers_and_motors_by_runge_kutta() {
    let rk4 = "<option integrator=\"RK4\" timestep=\"0.00002\"";
    let controllers = own("controllers").replace("<option timestep=\"0.002\"", rk4);
    drift_alike(&text(&controllers), 50);
}

/// Within 100 steps springs yield, and delayed controls arrive.
#[test]
fn so_do_springs_that_yield_and_late_controls_by_each_integrator() {
    let pliant = own("pliant");
    for integrator in ["Euler", "implicitfast", "RK4"] {
        let option = format!("<option integrator=\"{integrator}\" ");
        drift_alike(&text(&pliant.replace("<option ", &option)), 50);
    }
}

#[test]
fn so_do_chains_and_free_bodies_implicit_in_coriolis_forces() {
    for name in ["medley", "swimmers"] {
        let implicit = own(name).replace("<option ", "<option integrator=\"implicit\" ");
        drift_alike(&text(&implicit), 60);
    }
}

#[test]
fn so_do_orientation_servos() {
    for integrator in ["implicitfast", "RK4"] {
        let option = format!("<option integrator=\"{integrator}\" ");
        drift_alike(&text(&own("servos").replace("<option ", &option)), 50);
    }
}

/// A device may terminate long loops early, as Mesa's software device does if many links of a chain lie deep in a
/// floor. The results that it reports as complete are complete.
#[test]
fn a_step_that_is_cut_short_is_a_fault_and_no_wrong_numbers() {
    let lying = (own("serpent").replace(" contype=\"0\" conaffinity=\"0\"", ""))
        .replace("pos=\"0 0 0.6\"", "pos=\"0 0 0.05\"");
    let model = text(&lying);
    let count = 24;
    let Some(mut batch) = limited_batch(&model, count, 80) else {
        return;
    };
    let states = some_states(&model, count);
    upload(&mut batch, &states);
    batch.step(1).expect("a device");
    let found = batch.read("qacc").expect("a device");
    let mut finished = 0;
    for (env, fault) in batch.statuses().expect("a device").into_iter().enumerate() {
        if let Some(fault) = fault {
            assert_eq!(fault, GpuFault::Unfinished);
            continue;
        }
        finished += 1;
        let mut sim = Sim::<f64>::new(model.clone()).expect("a good model");
        sim.state = convert(&model, &states[env]);
        sim.step().expect("a good state");
        let row = found[env * model.nv..][..model.nv].iter();
        let row = Vec::from_iter(row.map(|&x| f64::from(x)));
        let error = difference(&row, &sim.workspace().qacc);
        assert!(error < 1e-2, "environment {env}: {error:.1e}");
    }
    assert!(finished > 0);
}

/// Returns the positions after `steps` steps.
fn after(batch: &mut GpuBatch, states: &[State<f32>], steps: usize) -> Vec<u32> {
    batch.reset().expect("a device");
    upload(batch, states);
    batch.step(steps).expect("a device");
    let bits = |name: &str| {
        batch
            .read(name)
            .expect("a device")
            .into_iter()
            .map(f32::to_bits)
    };
    bits("qpos").chain(bits("qvel")).collect()
}

#[test]
fn results_depend_on_nothing_but_the_state() {
    let model = runner();
    let states = some_states(&model, 40);
    let (Some(mut many), Some(mut few)) = (general_batch(&model, 40), general_batch(&model, 3))
    else {
        return;
    };
    let first = after(&mut many, &states, 20);
    assert_eq!(first, after(&mut many, &states, 20), "a run repeats itself");
    let chosen = [37, 5, 12];
    let alone: Vec<_> = chosen.iter().map(|&env| states[env].clone()).collect();
    let found = after(&mut few, &alone, 20);
    let nq = model.nq;
    for (k, &env) in chosen.iter().enumerate() {
        assert_eq!(found[k * nq..(k + 1) * nq], first[env * nq..(env + 1) * nq]);
    }
}

#[test]
fn a_step_whose_kernels_are_timed_is_a_step() {
    let model = runner();
    let states = some_states(&model, 3);
    let Some(mut timed) = general_batch(&model, 3) else {
        return;
    };
    let mut plain = general_batch(&model, 3).expect("a device");
    after(&mut timed, &states, 2);
    after(&mut plain, &states, 3);
    let times = timed.time_stages().expect("a clock");
    let names = Vec::from_iter(times.iter().map(|&(name, _)| name));
    assert_eq!((names[0], names[names.len() - 1]), ("positions", "euler"));
    assert!(times.iter().any(|&(_, time)| time > 0.0), "{times:?}");
    plain.finish().expect("a device");
    assert_eq!(timed.steps().expect("a device"), [3; 3]);
    for name in ["qpos", "qvel"] {
        let [found, expected] = [&timed, &plain].map(|b| b.read(name).expect("a device"));
        assert_eq!(found, expected, "{name}");
    }
}

/// Batches of a process share a device.
#[test]
fn batches_that_step_at_a_time_know_nothing_of_each_other() {
    let model = runner();
    let states = some_states(&model, 20);
    let Some(mut alone) = general_batch(&model, 20) else {
        return;
    };
    let expected = after(&mut alone, &states, 4);
    let run = || {
        let mut batch = general_batch(&model, 20).expect("a device");
        Vec::from_iter((0..2).map(|_| after(&mut batch, &states, 4)))
    };
    std::thread::scope(|scope| {
        let threads = [scope.spawn(run), scope.spawn(run)];
        for thread in threads {
            for found in thread.join().expect("no panic") {
                assert!(found == expected, "a neighbour changed a bit");
            }
        }
    });
}

#[test]
fn a_fault_does_not_spread() {
    let model = runner();
    let mut states = some_states(&model, 40);
    let Some(mut batch) = general_batch(&model, 40) else {
        return;
    };
    let well = after(&mut batch, &states, 8);
    states[17].qvel[0] = 9e9;
    states[17].qfrc_applied[0] = 1e30;
    let ill = after(&mut batch, &states, 8);
    let statuses = batch.statuses().expect("a device");
    assert_eq!(statuses[17], Some(GpuFault::Diverged));
    assert_eq!(statuses.iter().flatten().count(), 1);
    assert_eq!(batch.steps().expect("a device")[17], 0);
    let (nq, nv) = (model.nq, model.nv);
    for env in (0..40).filter(|&env| env != 17) {
        assert_eq!(
            well[env * nq..(env + 1) * nq],
            ill[env * nq..(env + 1) * nq]
        );
    }
    let start: Vec<u32> = states[17].qpos.iter().map(|q| q.to_bits()).collect();
    assert_eq!(ill[17 * nq..18 * nq], start, "it keeps its last good state");
    assert_eq!(ill[40 * nq + 17 * nv], 9e9f32.to_bits());

    batch.reset_envs(&[17]).expect("a device");
    batch.step(2).expect("a device");
    assert_all_run(&batch);
    assert_eq!(batch.steps().expect("a device")[16..19], [10, 2, 10]);
}

#[test]
fn too_many_contacts_are_a_fault() {
    let model = runner();
    let Some(mut batch) = limited_batch(&model, 2, 1) else {
        return;
    };
    let mut low = vec![0.0; model.nq];
    low[1] = -0.55;
    batch.write_env(1, "qpos", &low).expect("a good row");
    batch.step(1).expect("a device");
    let full = GpuFault::ContactOverflow { limit: 1 };
    assert_eq!(batch.statuses().expect("a device"), [None, Some(full)]);
}

/// The number of dofs alone would leave room for 48 contacts.
#[test]
fn the_pool_holds_twice_the_contacts_of_the_initial_state() {
    let model = text(
        "<mujoco><worldbody>
           <geom type='plane' size='5 5 1'/>
           <replicate count='52' offset='0.3 0 0'>
             <body pos='0 0 0.099'><joint type='slide' axis='0 0 1'/><geom size='0.1'/></body>
           </replicate>
         </worldbody></mujoco>",
    );
    let Some(mut batch) = general_batch::<f32>(&model, 1) else {
        return;
    };
    batch.step(1).expect("a device");
    assert_all_run(&batch);
    assert_eq!(batch.solves().expect("a device")[0].contacts, 52);
}

#[test]
fn thousands_run_side_by_side() {
    let model = runner();
    let count = 4096;
    let states = some_states(&model, 64);
    let Some(mut batch) = general_batch(&model, count) else {
        return;
    };
    let all: Vec<_> = (0..count).map(|env| states[env % 64].clone()).collect();
    let found = after(&mut batch, &all, 5);
    assert_all_run(&batch);
    let width = 64 * model.nq;
    for part in found[..count * model.nq].chunks(width) {
        assert!(
            part == &found[..width],
            "equal states move alike wherever they lie"
        );
    }
}

#[test]
fn bad_input_is_reported_by_name_and_index() {
    let model = runner();
    let Some(mut batch) = general_batch(&model, 2) else {
        return;
    };
    let error =
        |result: Result<(), clench_gpu::GpuError>| result.expect_err("bad input").to_string();
    let nv = model.nv;
    assert_eq!(
        error(batch.write("qvel", &[0.0])),
        format!("qvel has 1 numbers where {} are needed", 2 * nv)
    );
    let mut row = vec![0.0; nv];
    row[3] = f32::NAN;
    assert_eq!(
        error(batch.write_env(1, "qvel", &row)),
        "qvel[3] of environment 1 is NaN"
    );
    assert_eq!(
        error(batch.write_env(2, "qvel", &row)),
        "there is no environment 2: there are 2"
    );
    assert_eq!(
        error(batch.write("xpos", &[])),
        "xpos is computed from the state: it is read-only"
    );
    assert!(
        error(batch.write("speed", &[]))
            .starts_with("there is no field \"speed\" on a graphics device; there are: qpos")
    );
    assert!(batch.read("speed").is_err());
}
