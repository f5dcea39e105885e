//! Robots that get a free joint at the base.

use super::{joint, link, names, robot};
use clench_formats::{LoadError, Loader};
use clench_rigid::Model;
use clench_rigid::model::JointKind;

fn floating(parts: &[String]) -> Result<Model, LoadError> {
    Loader::new().floating(true).load_str(&robot(parts))
}

#[track_caller]
fn refused(parts: &[String], because: &str) {
    let error = floating(parts).expect_err("it is refused");
    assert!(error.message.contains(because), "{error}");
    assert_eq!(error.line, Some(1));
}

#[test]
fn the_base_gets_a_free_joint_and_is_otherwise_unchanged() {
    let parts = [
        link("trunk", ""),
        link("imu", ""),
        link("leg", ""),
        joint("mount", "fixed", "trunk", "imu", "<origin xyz='0 0 0.2'/>"),
        joint(
            "hip",
            "continuous",
            "trunk",
            "leg",
            "<origin xyz='0.3 0 0'/>",
        ),
    ];
    let model = floating(&parts).expect("it loads");
    assert_eq!(
        names(model.joints.iter().map(|j| &j.name)),
        ["floating_base", "hip"]
    );
    assert_eq!(model.joints[0].kind, JointKind::Free);
    // The fixed link is fused into the base, as in a file that frees the base itself.
    assert_eq!(
        names(model.bodies.iter().map(|b| &b.name)),
        ["world", "trunk", "leg"]
    );
    assert_eq!(model.params.body_mass, [0.0, 2.0, 1.0]);
    assert_eq!(model.params.body_pos[1].to_array(), [0.0; 3]);
    assert_eq!(model.params.qpos0, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn a_base_fixed_to_a_link_world_floats_at_its_pose() {
    let model = floating(&[
        "<link name='world'/>".to_owned(),
        link("trunk", ""),
        joint(
            "floating_base",
            "fixed",
            "world",
            "trunk",
            "<origin xyz='0 0 0.4'/>",
        ),
    ]);
    let model = model.expect("it loads");
    assert_eq!(model.params.qpos0[..3], [0.0, 0.0, 0.4]);
    assert_eq!(model.joints[0].name, "floating_base");
}

#[test]
fn a_base_that_a_file_frees_stays_as_it_is_and_names_stay_unique() {
    let free = floating(&[
        "<link name='world'/>".to_owned(),
        link("trunk", ""),
        joint("root", "floating", "world", "trunk", ""),
    ]);
    assert_eq!(
        names(free.expect("it loads").joints.iter().map(|j| &j.name)),
        ["root"]
    );
    let taken = floating(&[
        link("trunk", ""),
        link("leg", ""),
        joint("floating_base", "revolute", "trunk", "leg", ""),
    ]);
    let taken = taken.expect("it loads");
    let joints = names(taken.joints.iter().map(|j| &j.name));
    assert_eq!(joints, ["floating_base_1", "floating_base"]);
}

#[test]
fn models_without_a_base_to_free_are_refused() {
    refused(
        &[link("a", ""), link("b", "")],
        "several are fixed to the world: a, b",
    );
    refused(
        &["<link name='world'/>".to_owned()],
        "no link other than the world",
    );
    let rail = joint("rail", "prismatic", "world", "cart", "");
    refused(
        &["<link name='world'/>".to_owned(), link("cart", ""), rail],
        "the joint \"rail\" already moves it",
    );
    let mjcf = Loader::new()
        .floating(true)
        .load_str("<mujoco/>")
        .expect_err("it is refused");
    assert!(mjcf.message.contains("<freejoint/>"), "{mjcf}");
}
