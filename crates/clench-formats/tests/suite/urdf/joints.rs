//! Kinds, limits and drives of joints.

use super::{joint, link, loaded, names, step, with_joint};
use clench_rigid::Sim;
use clench_rigid::model::{EqualityTarget, JointKind};
use std::sync::Arc;

#[test]
fn each_kind_of_joint_moves_along_its_dofs() {
    use JointKind::{Ball, Free, Hinge, Slide};
    let kinds = |kind: &str| -> Vec<JointKind> {
        let model = with_joint(kind, "<axis xyz='0 0 2'/>");
        model.joints.iter().map(|joint| joint.kind).collect()
    };
    assert_eq!(kinds("revolute"), [Hinge]);
    assert_eq!(kinds("continuous"), [Hinge]);
    assert_eq!(kinds("prismatic"), [Slide]);
    assert_eq!(kinds("spherical"), [Ball]);
    assert_eq!(kinds("floating"), [Free]);
    assert_eq!(kinds("planar"), [Slide, Slide, Hinge]);
    assert_eq!(kinds("fixed"), []);
}

#[test]
fn a_planar_joint_slides_across_its_axis_and_rotates_about_it() {
    let model = with_joint(
        "planar",
        "<axis xyz='0 3 4'/><dynamics damping='2'/><limit lower='-1' upper='1'/>",
    );
    assert_eq!(
        names(model.joints.iter().map(|j| &j.name)),
        ["j_TX", "j_TY", "j_RZ"]
    );
    let axes = &model.params.jnt_axis;
    assert!((axes[2].to_array()[1] - 0.6).abs() < 1e-15);
    for (first, second) in [(0, 1), (1, 2), (2, 0)] {
        assert!(axes[first].dot(axes[second]).abs() < 1e-15);
    }
    assert_eq!(model.params.dof_damping, [2.0; 3]);
    // The limit applies to the first direction only.
    assert_eq!(
        [0, 1, 2].map(|j| model.joints[j].limited),
        [true, false, false]
    );
}

#[test]
fn roll_pitch_and_yaw_turn_about_fixed_axes() {
    let model = with_joint("revolute", "<origin xyz='1 2 3' rpy='0.3 -0.5 1.1'/>");
    let (sin, cos) = (f64::sin, f64::cos);
    let (r, p, y): (f64, f64, f64) = (0.3, -0.5, 1.1);
    // The first column of Rz(yaw) Ry(pitch) Rx(roll), and one entry that depends on roll.
    let turn = model.params.body_quat[1].to_matrix();
    let expected = [cos(y) * cos(p), sin(y) * cos(p), -sin(p)];
    for (row, expected) in turn.rows.iter().zip(expected) {
        assert!((row.x - expected).abs() < 1e-15);
    }
    assert!((turn.rows[2].y - cos(p) * sin(r)).abs() < 1e-15);
    assert_eq!(model.params.body_pos[1].to_array(), [1.0, 2.0, 3.0]);
}

#[test]
fn increasing_limits_apply() {
    let limit = |kind: &str, words: &str| {
        let model = with_joint(kind, &format!("<limit {words}/>"));
        (
            model.joints[0].limited,
            model.params.jnt_range[0],
            model.notes.len(),
        )
    };
    assert_eq!(
        limit("revolute", "lower='-1' upper='2'"),
        (true, [-1.0, 2.0], 0)
    );
    assert_eq!(
        limit("prismatic", "lower='-1' upper='2'"),
        (true, [-1.0, 2.0], 0)
    );
    assert_eq!(limit("revolute", "effort='1'"), (false, [0.0, 0.0], 0));
    assert_eq!(
        limit("continuous", "lower='-1' upper='2'"),
        (false, [0.0, 0.0], 0)
    );
    // MuJoCo ignores impossible limits. So does this reader, with a warning.
    assert_eq!(
        limit("revolute", "lower='1' upper='1'"),
        (false, [1.0, 1.0], 1)
    );
    assert_eq!(
        limit("revolute", "lower='2' upper='1'"),
        (false, [2.0, 1.0], 1)
    );
    assert_eq!(limit("revolute", "upper='1'"), (false, [0.0, 1.0], 1));
    assert_eq!(limit("revolute", "lower='-1'"), (false, [-1.0, 0.0], 1));
    assert!(limit("revolute", "lower='-inf' upper='inf'").1[1].is_infinite());
}

#[test]
fn effort_bounds_the_force_of_all_actuators_at_a_joint() {
    for effort in ["7", "-7"] {
        let model = with_joint("revolute", &format!("<limit effort='{effort}'/>"));
        assert!(model.joints[0].actfrclimited);
        assert_eq!(model.params.jnt_actfrcrange, [[-7.0, 7.0]]);
    }
    assert!(!with_joint("revolute", "<limit effort='0'/>").joints[0].actfrclimited);
}

#[test]
fn dynamics_are_damping_and_dry_friction() {
    let model = with_joint("revolute", "<dynamics damping='0.3' friction='0.2'/>");
    assert_eq!(model.params.dof_damping, [0.3]);
    assert_eq!(model.params.dof_frictionloss, [0.2]);
}

#[test]
fn a_joint_that_mimics_another_is_held_to_it() {
    let model = loaded(&[
        link("a", ""),
        link("b", ""),
        link("c", ""),
        joint(
            "k",
            "revolute",
            "a",
            "c",
            "<mimic joint='j' multiplier='-2' offset='0.5'/>",
        ),
        joint("j", "revolute", "a", "b", "<dynamics damping='0.5'/>"),
    ]);
    let target = EqualityTarget::Joint {
        joint1: 1,
        joint2: Some(0),
    };
    let target = match model.joints[0].name.as_str() {
        "j" => target,
        _ => EqualityTarget::Joint {
            joint1: 0,
            joint2: Some(1),
        },
    };
    assert_eq!(model.equalities[0].target, target);
    assert_eq!(model.params.eq_polycoef, [[0.5, -2.0, 0.0, 0.0, 0.0]]);
    let at = |name: &str| model.joints.iter().position(|j| j.name == name).unwrap();
    let (j, k) = (at("j"), at("k"));
    let mut sim = Sim::<f64>::new(Arc::new(model)).unwrap();
    step(&mut sim, 2000);
    let qpos = &sim.state.qpos;
    assert!((qpos[k] - (0.5 - 2.0 * qpos[j])).abs() < 1e-3, "{qpos:?}");
}

#[test]
fn only_joints_with_one_position_mimic_and_are_mimicked() {
    for (kind, other) in [
        ("planar", "revolute"),
        ("revolute", "planar"),
        ("revolute", "fixed"),
    ] {
        let model = loaded(&[
            link("a", ""),
            link("b", ""),
            link("c", ""),
            joint("j", other, "a", "b", ""),
            joint("k", kind, "a", "c", "<mimic joint='j'/>"),
        ]);
        assert!(model.equalities.is_empty());
        assert!(
            model.notes[0].contains("does not mimic"),
            "{:?}",
            model.notes
        );
    }
}

/// The names and the mimic relations are MuJoCo's: those of a planar joint have endings.
#[test]
fn joints_share_no_names() {
    let loaded_with = |joints: [[&str; 3]; 3]| {
        let links = ["a", "b", "c", "d"].map(|name| link(name, ""));
        let joints = joints.into_iter().zip(["b", "c", "d"]);
        let joints = joints.map(|([name, kind, more], child)| joint(name, kind, "a", child, more));
        let model = loaded(&links.into_iter().chain(joints).collect::<Vec<_>>());
        let names: Vec<String> = model
            .joints
            .iter()
            .map(|joint| joint.name.clone())
            .collect();
        let targets = model
            .equalities
            .iter()
            .map(|equality| match equality.target {
                EqualityTarget::Joint { joint1, joint2 } => (joint1, joint2),
                _ => panic!("not of joints"),
            });
        (names.join(" "), targets.collect::<Vec<_>>())
    };
    let mimic = "<mimic joint='j'/>";
    assert_eq!(
        loaded_with([
            ["j", "planar", ""],
            ["j", "continuous", ""],
            ["k", "continuous", mimic]
        ]),
        ("j_TX j_TY j_RZ j k".to_owned(), vec![(4, Some(3))])
    );
    assert_eq!(
        loaded_with([
            ["j", "continuous", ""],
            ["j", "floating", ""],
            ["k", "continuous", mimic]
        ]),
        ("j  k".to_owned(), vec![(2, Some(0))])
    );
    assert_eq!(
        loaded_with([
            ["i", "planar", ""],
            ["j", "continuous", ""],
            ["i_TX", "continuous", mimic]
        ]),
        ("i_TX i_TY i_RZ j ".to_owned(), vec![(0, Some(3))])
    );
}
