//! Sleep together with other features of a step: the same trees sleep and wake as on the processor.

use crate::common::{own, text};
use crate::sleeping::{COUNT, Comparison, apart, batch, disturb_nap, options, sleeps_alike};
use clench_rigid::model::Model;
use clench_rigid::{Batch, DynamicConstraint, State};
use std::sync::Arc;

/// Boxes that lie, a ball that sleeps in mid air, and a mocap body.
fn tied_bodies(flag: &str) -> Arc<Model> {
    let file = "<mujoco>
          <option timestep='0.004' tolerance='1e-12'><flag sleep='enable' FLAG/></option>
          <worldbody>
            <geom type='plane' size='4 4 1'/>
            <body name='low' pos='0 0 0.1'><freejoint/><geom type='box' size='0.1 0.1 0.1'/></body>
            <body name='beside' pos='0.5 0 0.1'><freejoint/><geom type='box' size='0.1 0.1 0.1'/></body>
            <body name='ball' pos='0.5 0 0.6' sleep='init'><freejoint/><geom size='0.05'/></body>
            <body name='apart' pos='2 0 0.1'><freejoint/><geom type='box' size='0.1 0.1 0.1'/></body>
            <body name='hand' mocap='true' pos='0 3 0.1'><geom size='0.05'/></body>
          </worldbody>
        </mujoco>";
    text(&file.replace("FLAG", flag))
}

const WORLD: usize = 0;
const LOW: usize = 1;
const BESIDE: usize = 2;
const BALL: usize = 3;
const APART: usize = 4;
const HAND: usize = 5;

/// Adds and removes constraints, and writes slots, before a step.
fn tie(batch: &mut Batch<f64>, step: usize, ties: &mut Vec<DynamicConstraint>) {
    let mut weld = |batch: &mut Batch<f64>, env: usize, one: usize, other: usize| {
        ties.extend(batch.add_weld(&[env], one, other).expect("a free slot"));
    };
    match step {
        130 => {
            weld(batch, 0, LOW, BESIDE);
            weld(batch, 1, HAND, LOW);
            weld(batch, 2, WORLD, BESIDE);
        }
        160 => batch.state.mocap_pos.row_mut(1)[1] += 0.1,
        // A slot that is written wakes nobody before the step.
        200 => {
            batch.state.dynamic_kind.row_mut(2)[1] = 1;
            batch.state.dynamic_body1.row_mut(2)[1] = LOW as i32;
            batch.state.dynamic_body2.row_mut(2)[1] = APART as i32;
            batch.state.dynamic_anchor1.row_mut(2)[3] = 1.0;
            batch.state.dynamic_anchor2.row_mut(2)[3] = -1.0;
        }
        220 => weld(batch, 1, BALL, APART),
        280 => {
            batch.remove(&[0], &ties[..1]).expect("it exists");
            batch.state.dynamic_body2.row_mut(2)[1] = 99;
        }
        // They sleep in one island, which this tie keeps asleep, or in two.
        350 => batch.state.dynamic_body2.row_mut(2)[1] = APART as i32,
        380 => {
            batch.state.qvel.row_mut(0)[2] = -0.0;
            batch.state.qvel.row_mut(2)[2] = -0.0;
        }
        _ => {}
    }
}

#[test]
fn constraints_added_at_run_time_wake_trees_as_on_the_processor() {
    for flag in ["", "equality='disable'"] {
        let model = tied_bodies(flag);
        let Some(mut device) = batch::<f64>(&model, COUNT) else {
            return;
        };
        let mut processor = Batch::with_options(model.clone(), COUNT, options()).expect("valid");
        let mut ties = [Vec::new(), Vec::new()];
        let (mut asleep, mut wakes) = (0, 0);
        for step in 0..450 {
            let slept = processor.state.tree_asleep.as_slice().to_vec();
            for (batch, ties) in [&mut device, &mut processor].into_iter().zip(&mut ties) {
                tie(batch, step, ties);
                assert_eq!(batch.step().expect("good states").running, COUNT);
            }
            let now = processor.state.tree_asleep.as_slice();
            assert_eq!(
                device.state.tree_asleep.as_slice(),
                now,
                "{flag}: step {step}"
            );
            let far = apart(
                device.state.qpos.as_slice(),
                processor.state.qpos.as_slice(),
            );
            assert!(far <= 1e-9, "{flag}: step {step}: {far:.1e}");
            asleep += now.iter().filter(|&&x| x >= 0).count();
            wakes += slept
                .iter()
                .zip(now)
                .filter(|&(&a, &b)| a >= 0 && b < 0)
                .count();
        }
        let share = asleep as f64 / (450 * COUNT * model.ntree()) as f64;
        assert!(
            (0.3..0.9).contains(&share) && wakes >= 10,
            "{flag}: {share} {wakes}"
        );
    }
}

/// Returns `nap` with attributes of `<option>`, a tree in which a tendon couples two branches, and the measured
/// acceleration of the ball.
fn forked_nap(option: &str) -> Arc<Model> {
    let fork = "<body name='fork' pos='-2 2 1'>
          <joint axis='0 1 0' damping='0.2'/>
          <geom type='capsule' fromto='0 0 0 0 0 -0.2' size='0.02'/>
          <body pos='0 -0.1 -0.2'>
            <joint name='one' axis='0 1 0' damping='0.05'/>
            <geom type='capsule' fromto='0 0 0 0.02 0 -0.2' size='0.02'/>
          </body>
          <body pos='0 0.1 -0.2'>
            <joint name='other' axis='0 1 0' damping='0.05'/>
            <geom type='capsule' fromto='0 0 0 0 0 -0.2' size='0.02'/>
          </body>
        </body></worldbody>";
    let tendon = "<tendon><fixed stiffness='20' damping='1'>
          <joint joint='one' coef='1'/><joint joint='other' coef='-1'/></fixed>";
    let sensor = "<sensor><framelinacc objtype='body' objname='ball'/></sensor></mujoco>";
    let file = own("nap")
        .replacen("<option ", &format!("<option {option} "), 1)
        .replacen("</worldbody>", fork, 1)
        .replacen("<tendon>", tendon, 1)
        .replacen("sleep=\"init\"", "sleep=\"init\" name=\"ball\"", 1)
        .replacen("</mujoco>", sensor, 1);
    text(&file)
}

fn disturb_fork(env: usize, step: usize, state: &mut State<f64>) {
    disturb_nap(env, step, state);
    if step == 400 + 3 * env
        && let Some(last) = state.qvel.last_mut()
    {
        *last = 0.2;
    }
}

/// Free bodies that sleep in mid air do not spin, and terms of the metric act on awake trees.
#[test]
fn trees_sleep_with_the_integrator_discrete_as_on_the_processor() {
    let comparison = Comparison::<f64> {
        steps: 600,
        tolerance: 1e-9,
        from_same: false,
        disturb: disturb_fork,
    };
    let outputs = ["sensordata", "qacc", "qfrc_constraint", "contact_count"];
    for option in [
        "",
        "cone='elliptic' noslip_iterations='3' noslip_tolerance='0'",
    ] {
        let model = forked_nap(&format!("integrator='discrete' {option}"));
        if let Some((asleep, wakes)) = sleeps_alike(&model, &outputs, &comparison) {
            assert!(
                (0.2..0.9).contains(&asleep) && wakes > 20,
                "{asleep} {wakes}"
            );
        }
    }
}

/// Also writes references that are no pair's.
fn disturb_sticky(env: usize, step: usize, state: &mut State<f64>) {
    disturb_nap(env, step, state);
    let used = state.stick_references.iter().position(|r| r.first == 0.0);
    if step == 200 + env
        && let Some(next) = used
    {
        // No geom has the first tag, and pairs with the others do not touch.
        let tags = [[99.0, 1.0], [1.0, 9.0], [-3.0, 1.0], [4.0, 8.0]];
        for (reference, [first, second]) in state.stick_references[next..].iter_mut().zip(tags) {
            (reference.first, reference.second) = (first, second);
        }
    }
}

/// Bodies on a slope stick while they sleep, and dry friction of sleeping joints and tendons stays displaced.
#[test]
fn trees_sleep_with_friction_that_sticks_as_on_the_processor() {
    let comparison = Comparison::<f64> {
        steps: 600,
        tolerance: 1e-9,
        from_same: false,
        disturb: disturb_sticky,
    };
    let sticks = "<custom><text name='clench.stiction' data='true'/></custom><tendon>
          <fixed frictionloss='0.02'><joint joint='driven' coef='1'/></fixed>
          <fixed frictionloss='0.02'><joint joint='first' coef='1'/><joint joint='second' coef='1'/></fixed>";
    for option in ["", "integrator='discrete' cone='elliptic'"] {
        let option = format!("<option gravity='0.8 0.2 -9.7' {option} ");
        let file = own("nap")
            .replacen("<option ", &option, 1)
            .replacen("<tendon>", sticks, 1);
        if let Some((asleep, wakes)) = sleeps_alike(&text(&file), &[], &comparison) {
            assert!(
                (0.2..0.9).contains(&asleep) && wakes > 15,
                "{asleep} {wakes}"
            );
        }
    }
}
