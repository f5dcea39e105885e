//! Inverse kinematics: reachable goals are reached, limits hold, and unreachable goals are reported.

use crate::machines::{Numbers, distance, floating};
use clench_math::{Quat, Vec3};
use clench_rigid::batch::QueryInput;
use clench_rigid::builder::{BodySpec, GeomSpec, JointSpec, ModelBuilder};
use clench_rigid::dynamics::integrate::integrate_positions;
use clench_rigid::model::{FrameObject, JointKind};
use clench_rigid::{
    Batch, Ik, IkOptions, IkSolution, IkStatus, IkTarget, IkTask, Model, Sim, SimError,
};
use std::sync::Arc;

/// Builds an arm of seven hinges about alternating axes, with a site at its end.
fn arm(range: f64) -> Arc<Model> {
    let mut b = crate::machines::world("arm");
    let mut parent = ModelBuilder::WORLD;
    for i in 0..7 {
        let axis = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]][i % 2];
        let hinge = JointSpec {
            range: [-range, range],
            limited: Some(true),
            ..JointSpec::hinge(format!("joint{i}"), axis)
        };
        let mut link = BodySpec::new(format!("link{i}"))
            .at([0.0, 0.0, 0.2])
            .joint(hinge)
            .geom(GeomSpec::capsule(0.04, 0.06).at([0.0, 0.0, 0.1]));
        if i == 6 {
            link = link.site("tip", [0.0, 0.0, 0.2]);
        }
        parent = b.add_body(parent, link);
    }
    Arc::new(b.build().unwrap())
}

const TIP: FrameObject = FrameObject::Site(0);

fn pose_of_tip(model: &Model) -> Vec<IkTask> {
    [IkTarget::Position(TIP), IkTarget::Orientation(TIP)]
        .map(|target| IkTask::new(model, target, 1.0))
        .into()
}

fn tip(model: &Arc<Model>, qpos: &[f64]) -> (Vec3<f64>, Quat<f64>) {
    let mut sim = Sim::new(Arc::clone(model)).unwrap();
    sim.state.qpos.copy_from_slice(qpos);
    sim.refresh().unwrap();
    let pos = &sim.workspace().position;
    (pos.site_xpos[0], Quat::from_matrix(&pos.site_xmat[0]))
}

fn goal(model: &Arc<Model>, qpos: &[f64]) -> Vec<f64> {
    let (position, orientation) = tip(model, qpos);
    [&position.to_array()[..], &orientation.to_array()].concat()
}

#[test]
fn an_arm_reaches_poses_that_it_can_take() {
    let model = arm(2.5);
    let ik = Ik::new(&model, pose_of_tip(&model), IkOptions::default()).unwrap();
    let mut sim: Sim = Sim::new(Arc::clone(&model)).unwrap();
    let mut numbers = Numbers(3);
    let mut reached = 0;
    for _ in 0..100 {
        let (mut there, mut start) = ([0.0; 7], [0.0; 7]);
        numbers.fill(&mut there, 2.0);
        numbers.fill(&mut start, 1.0);
        let goal = goal(&model, &there);
        let found = sim.ik(&ik, &goal, Some(&start)).unwrap();
        assert!(found.qpos.iter().all(|q| q.abs() <= 2.5));
        if found.status == IkStatus::Reached {
            reached += 1;
            let (position, orientation) = tip(&model, &found.qpos);
            assert!((position - Vec3::from_slice(&goal)).norm() <= 1e-6);
            let left = Quat::from_slice(&goal[3..]) * orientation.conjugate();
            assert!(left.to_rotation_vector().norm() <= 1e-6);
            assert!(found.errors.iter().all(|e| *e <= 1e-6));
            assert!(found.iterations < 100);
        }
    }
    assert!(reached >= 80, "{reached} of 100");
}

/// From one start, about every seventh search ends at limits that the goal's own posture does not touch.
#[test]
fn restarts_reach_more_targets() {
    let model = arm(1.2);
    let mut numbers = Numbers(11);
    let goals = Vec::from_iter((0..40).map(|_| {
        let posture = Vec::from_iter((0..model.nq).map(|_| 1.1 * numbers.next()));
        goal(&model, &posture)
    }));
    let search = |restarts| {
        let options = IkOptions {
            restarts,
            ..IkOptions::default()
        };
        let ik = Ik::new(&model, pose_of_tip(&model), options).unwrap();
        let mut sim = Sim::new(Arc::clone(&model)).unwrap();
        let found = goals.iter().map(|goal| sim.ik(&ik, goal, None).unwrap());
        Vec::from_iter(found)
    };
    let reached = |found: &[IkSolution<f64>]| {
        let ends = found.iter().filter(|end| end.status == IkStatus::Reached);
        ends.count()
    };
    let (once, often) = (search(0), search(12));
    assert!(reached(&once) < 36, "the goals are too easy");
    assert!(reached(&often) >= 39, "{} of 40", reached(&often));
    for (first, best) in once.iter().zip(&often) {
        // Restarts do not change a solution that reached its goal.
        if first.status == IkStatus::Reached {
            assert_eq!(first, best);
        }
        assert!(best.iterations >= first.iterations);
        assert!(best.qpos.iter().all(|q| q.abs() <= 1.2));
    }
    // Lanes give the same results.
    let options = IkOptions {
        restarts: 12,
        ..IkOptions::default()
    };
    let ik = Ik::new(&model, pose_of_tip(&model), options).unwrap();
    let mut batch = Batch::<f64>::new(Arc::clone(&model), goals.len()).unwrap();
    let together = batch
        .ik(&ik, QueryInput::Each(&goals.concat()), None)
        .unwrap();
    assert_eq!(together, often);
}

#[test]
fn limits_are_respected_and_unreachable_targets_approached() {
    let model = arm(0.3);
    let task = IkTask::new(&model, IkTarget::Position(TIP), 1.0);
    let solve = |limits: bool| {
        let options = IkOptions {
            limits,
            ..IkOptions::default()
        };
        let ik = Ik::new(&model, vec![task.clone()], options).unwrap();
        let mut sim: Sim = Sim::new(Arc::clone(&model)).unwrap();
        sim.ik(&ik, &[1.0, 0.0, 0.9], Some(&[0.1; 7])).unwrap()
    };
    let (kept, free) = (solve(true), solve(false));
    assert_eq!(kept.status, IkStatus::Stationary);
    assert!(kept.qpos.iter().all(|q| q.abs() <= 0.3));
    assert!(kept.errors[0] > 1e-3);
    assert_eq!(free.status, IkStatus::Reached);
    assert!(free.qpos.iter().any(|q| q.abs() > 0.3));
}

/// The hinges beyond the middle of the arm cannot bring it to its goal, which it has reached.
#[test]
fn a_start_outside_the_limits_is_moved_inside_also_where_no_task_depends_on_it() {
    let model = arm(1.0);
    let middle = FrameObject::Body(4);
    let mut sim = Sim::<f64>::new(Arc::clone(&model)).expect("a simulation");
    let goal = [0.0, 0.0, 0.8];
    let start = [0.0, 0.0, 0.0, 0.0, 0.0, 1.5, -2.0];
    let mut solve = |dofs: Vec<bool>| {
        let options = IkOptions {
            dofs,
            ..IkOptions::default()
        };
        let tasks = vec![IkTask::new(&model, IkTarget::Position(middle), 1.0)];
        let ik = Ik::new(&model, tasks, options).expect("valid tasks");
        sim.ik(&ik, &goal, Some(&start)).expect("a solution").qpos
    };
    assert_eq!(solve(Vec::new()), [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0]);
    // A dof that may not move does not, wherever it is.
    let held = vec![true, true, true, true, true, true, false];
    assert_eq!(solve(held), [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, -2.0]);
}

#[test]
fn a_goal_beyond_the_arm_is_pointed_at() {
    let model = arm(2.5);
    let task = IkTask::new(&model, IkTarget::Position(TIP), 1.0);
    let ik = Ik::new(&model, vec![task], IkOptions::default()).unwrap();
    let mut sim: Sim = Sim::new(Arc::clone(&model)).unwrap();
    let found = sim.ik(&ik, &[3.0, 0.0, 0.4], Some(&[0.2; 7])).unwrap();
    assert_ne!(found.status, IkStatus::Reached);
    // The 1.2 m of links point there from the shoulder, the first bending joint at 0.4 m.
    let at = tip(&model, &found.qpos).0;
    assert!((at - Vec3::new(1.2, 0.0, 0.4)).norm() < 1e-3, "{at:?}");
    assert!((found.errors[0] - 1.8).abs() < 1e-5);
}

#[test]
fn a_floating_tree_balances_while_it_reaches() {
    let model = Arc::new(floating().build().unwrap());
    let hand = model.nbody() - 1;
    let tasks = vec![
        IkTask::new(&model, IkTarget::CentreOfMass(0), 1.0),
        IkTask::new(&model, IkTarget::Position(FrameObject::Body(hand)), 1.0),
        IkTask::new(&model, IkTarget::Posture, 1e-4),
    ];
    let ik = Ik::new(&model, tasks, IkOptions::default()).unwrap();
    let mut sim: Sim = Sim::new(Arc::clone(&model)).unwrap();
    let mut there = sim.state.qpos.clone();
    let mut turn = vec![0.0; model.nv];
    Numbers(8).fill(&mut turn, 0.3);
    integrate_positions(&model, &mut there, &turn, 1.0);
    let start = sim.state.qpos.clone();
    sim.state.qpos.copy_from_slice(&there);
    sim.refresh().unwrap();
    let pos = &sim.workspace().position;
    let (com, place) = (pos.subtree_com[0].to_array(), pos.xpos[hand].to_array());
    let goals = [&com[..], &place, &start].concat();
    sim.state.qpos.copy_from_slice(&start);
    let found = sim.ik(&ik, &goals, None).unwrap();
    assert_eq!(found.status, IkStatus::Reached);
    sim.state.qpos.copy_from_slice(&found.qpos);
    sim.refresh().unwrap();
    let pos = &sim.workspace().position;
    assert!(distance(&pos.subtree_com[0].to_array(), &com) <= 1e-6);
    assert!(distance(&pos.xpos[hand].to_array(), &place) <= 1e-6);
}

#[test]
fn dofs_that_may_not_move_do_not() {
    let model = arm(2.5);
    let options = IkOptions {
        dofs: (0..7).map(|dof| dof != 1).collect(),
        ..IkOptions::default()
    };
    let task = IkTask::new(&model, IkTarget::Position(TIP), 1.0);
    let ik = Ik::new(&model, vec![task], options).unwrap();
    let mut sim: Sim = Sim::new(Arc::clone(&model)).unwrap();
    let start = [0.1, 0.25, 0.3, -0.4, 0.1, 0.2, 0.0];
    let found = sim.ik(&ik, &[0.3, 0.2, 1.2], Some(&start)).unwrap();
    assert_eq!(found.qpos[1], 0.25);
    assert_ne!(found.qpos[3], -0.4);
}

#[test]
fn no_dof_moves_further_in_an_iteration_than_it_may() {
    let model = arm(2.5);
    let task = IkTask::new(&model, IkTarget::Position(TIP), 1.0);
    let start = [0.1, 0.25, 0.3, -0.4, 0.1, 0.2, 0.0];
    let solve = |iterations: usize| {
        let options = IkOptions {
            iterations,
            max_step: 0.02,
            ..IkOptions::default()
        };
        let ik = Ik::new(&model, vec![task.clone()], options).unwrap();
        let mut sim: Sim = Sim::new(Arc::clone(&model)).unwrap();
        sim.ik(&ik, &[0.3, 0.2, 1.2], Some(&start)).unwrap()
    };
    let mut before = start.to_vec();
    for iterations in 1..6 {
        let after = solve(iterations).qpos;
        let moved = before.iter().zip(&after).map(|(a, b)| (a - b).abs());
        let most = moved.fold(0.0, f64::max);
        assert!(most > 0.01999 && most < 0.02 + 1e-12, "{most}");
        before = after;
    }
    let found = solve(200);
    assert_eq!(found.status, IkStatus::Reached);
    assert!(found.iterations > 10);
}

#[test]
fn a_ball_joint_stays_within_its_cone() {
    let mut b = crate::machines::world("lamp");
    let ball = JointSpec {
        range: [0.0, 0.5],
        limited: Some(true),
        ..JointSpec::ball("neck")
    };
    let lamp = BodySpec::new("lamp")
        .joint(ball)
        .geom(GeomSpec::sphere(0.1));
    b.add_body(ModelBuilder::WORLD, lamp);
    let model = Arc::new(b.build().unwrap());
    assert_eq!(model.joints[0].kind, JointKind::Ball);
    let task = IkTask::new(&model, IkTarget::Orientation(FrameObject::Body(1)), 1.0);
    let ik = Ik::new(&model, vec![task], IkOptions::default()).unwrap();
    let mut sim: Sim = Sim::new(model).unwrap();
    let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.2_f64);
    let found = sim.ik(&ik, &turn.to_array(), None).unwrap();
    assert!((found.errors[0] - 0.7).abs() < 1e-6, "{:?}", found.errors);
    assert_ne!(found.status, IkStatus::Reached);
}

#[test]
fn bad_tasks_and_goals_are_errors() {
    let model = arm(2.5);
    let refused = |tasks, options| Ik::new(&model, tasks, options).unwrap_err();
    let unknown = IkTask {
        target: IkTarget::Position(FrameObject::Site(9)),
        weights: vec![1.0; 3],
    };
    let error = refused(vec![unknown], IkOptions::default());
    assert!(matches!(
        error,
        SimError::NoSuchElement { kind: "site", .. }
    ));
    let negative = IkTask::new(&model, IkTarget::Position(TIP), -1.0);
    refused(vec![negative], IkOptions::default());
    let options = IkOptions {
        dofs: vec![true; 3],
        ..IkOptions::default()
    };
    refused(pose_of_tip(&model), options);
    for max_step in [0.0, -1.0, f64::NAN] {
        let options = IkOptions {
            max_step,
            ..IkOptions::default()
        };
        refused(pose_of_tip(&model), options);
    }
    let ik = Ik::new(&model, pose_of_tip(&model), IkOptions::default()).unwrap();
    let mut sim: Sim = Sim::new(Arc::clone(&model)).unwrap();
    assert!(sim.ik(&ik, &[0.0; 3], None).is_err());
    assert!(sim.ik(&ik, &[f64::NAN; 7], None).is_err());
    let nothing = Ik::new(&model, Vec::new(), IkOptions::default()).unwrap();
    let found: IkSolution<f64> = sim.ik(&nothing, &[], None).unwrap();
    assert_eq!((found.status, found.iterations), (IkStatus::Reached, 0));
}

#[test]
fn tasks_of_another_model_are_refused() {
    let model = arm(1.0);
    let ik = Ik::new(&model, pose_of_tip(&model), IkOptions::default()).expect("valid tasks");
    let other = Arc::new(crate::machines::world("empty").build().expect("valid"));
    let mut sim = Sim::<f64>::new(Arc::clone(&other)).expect("valid");
    let error = sim.ik(&ik, &[0.0; 7], None).expect_err("no dofs");
    assert!(
        error.to_string().starts_with("dofs has 7 numbers"),
        "{error}"
    );
    let mut batch = Batch::<f64>::new(other, 2).expect("valid");
    batch
        .ik(&ik, QueryInput::Shared(&[0.0; 7]), None)
        .expect_err("no dofs");
}
