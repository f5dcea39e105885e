//! Links: shapes, inertias, and links that are fused into one body.

use super::{joint, link, loaded, names, step};
use clench_formats::load;
use clench_rigid::{Model, Sim};
use std::path::Path;
use std::sync::Arc;

#[test]
fn links_that_no_joint_moves_become_part_of_their_parents() {
    let ball = |name: &str| {
        let name = format!("name='{name}'");
        format!(
            "<collision {name}><origin xyz='0 0 1'/><geometry><sphere radius='0.1'/></geometry></collision>"
        )
    };
    let parts = |extension: &str| {
        [
            format!("<mujoco>{extension}</mujoco>"),
            link("a", &ball("on_a")),
            link("b", &ball("on_b")),
            link("flange", &ball("on_flange")),
            link("c", &ball("on_c")),
            joint("j", "revolute", "a", "b", ""),
            joint(
                "f",
                "fixed",
                "b",
                "flange",
                "<origin xyz='1 0 0' rpy='0 1.5707963267948966 0'/>",
            ),
            joint("k", "revolute", "flange", "c", "<origin xyz='0 0 2'/>"),
        ]
    };
    let fused = loaded(&parts(""));
    assert_eq!(
        names(fused.bodies.iter().map(|b| &b.name)),
        ["world", "b", "c"]
    );
    assert_eq!(
        names(fused.geoms.iter().map(|g| &g.name)),
        ["on_a", "on_b", "on_flange", "on_c"]
    );
    assert_eq!(fused.params.body_mass, [0.0, 2.0, 1.0]);
    let near = |actual: [f64; 3], expected: [f64; 3]| {
        let off = actual.iter().zip(expected).map(|(a, e)| (a - e).abs());
        assert!(off.fold(0.0, f64::max) < 1e-15, "{actual:?} {expected:?}");
    };
    // The flange is at (1, 0, 0), its z axis along x: its centre of mass at (1.1, 0, 0), its ball at (2, 0, 0).
    near(fused.params.body_ipos[1].to_array(), [0.55, 0.0, 0.05]);
    near(fused.params.geom_pos[2].to_array(), [2.0, 0.0, 0.0]);
    near(fused.params.body_pos[2].to_array(), [3.0, 0.0, 0.0]);
    // The motion is the same with and without fusing.
    let apart = loaded(&parts("<compiler fusestatic='false'/>"));
    assert_eq!(apart.nbody(), 5);
    let fall = |model: Model| {
        let mut sim = Sim::<f64>::new(Arc::new(model)).unwrap();
        step(&mut sim, 100);
        sim.state.qpos
    };
    let (fused, apart) = (fall(fused), fall(apart));
    assert!(fused.iter().zip(&apart).all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn the_first_shape_of_the_file_keeps_a_name() {
    let ball = |name: &str| {
        let ball = "<collision name='ball'><geometry><sphere radius='0.1'/></geometry></collision>";
        link(name, ball)
    };
    let model = loaded(&[
        ball("c"),
        ball("a"),
        ball("b"),
        joint("j", "revolute", "a", "b", ""),
        joint("k", "revolute", "b", "c", ""),
    ]);
    // Bodies are in the order of the tree; the link `c` is the first of the file.
    assert_eq!(names(model.geoms.iter().map(|g| &g.name)), ["", "", "ball"]);
    assert_eq!(model.notes.len(), 2);
}

/// MuJoCo 4.0's numbers.
#[test]
fn a_link_without_mass_has_its_inertia_and_its_own_offset() {
    let inertial = |mass: f64, inertia: f64| {
        format!(
            "<inertial><origin xyz='0.1 0 0.2'/><mass value='{mass}'/><inertia ixx='{inertia}' \
             iyy='{inertia}' izz='{inertia}' ixy='0' ixz='0' iyz='0'/></inertial>"
        )
    };
    let named = |name: &str, more: &str| format!("<link name='{name}'>{more}</link>");
    let model = loaded(&[
        named("base", ""),
        named("a", &inertial(0.0, 0.2)),
        named("b", &inertial(1.0, 0.1)),
        named("c", &inertial(0.0, 0.3)),
        joint("j", "revolute", "base", "a", ""),
        joint("f", "fixed", "a", "b", "<origin xyz='0 0 1'/>"),
        joint("g", "fixed", "b", "c", "<origin xyz='0 1 0'/>"),
    ]);
    // The moments of `a` and `b`; `c` is ignored.
    let moments = model.params.body_inertia[1].to_array();
    assert!(
        moments.iter().all(|m| (m - 0.3).abs() < 1e-15),
        "{moments:?}"
    );
    assert_eq!(model.params.body_ipos[1].to_array(), [0.1, 0.0, 1.2]);

    let empty = loaded(&[
        "<mujoco><compiler boundmass='0.5' boundinertia='0.01'/></mujoco>".to_owned(),
        named("base", ""),
        named("stand", ""),
        named("tip", ""),
        joint("f", "fixed", "base", "stand", "<origin xyz='1 0 0'/>"),
        joint("j", "revolute", "stand", "tip", "<origin xyz='0 0 2'/>"),
    ]);
    assert_eq!(empty.params.body_pos[1].to_array(), [1.0, 0.0, 2.0]);
    assert_eq!(empty.params.body_ipos[1].to_array(), [0.0, 0.0, 2.0]);
}

#[test]
fn the_link_world_is_the_world() {
    let model = loaded(&[
        "<link name='world'><collision><geometry><box size='2 2 2'/></geometry></collision></link>"
            .to_owned(),
        link("a", ""),
        joint("j", "floating", "world", "a", "<origin xyz='0 0 3'/>"),
    ]);
    assert_eq!(names(model.bodies.iter().map(|b| &b.name)), ["world", "a"]);
    assert_eq!(model.geoms[0].body, 0);
    assert_eq!(model.params.qpos0[..3], [0.0, 0.0, 3.0]);
}

#[test]
fn shapes_have_the_sizes_that_are_written() {
    let shape = |words: &str| {
        let geometry = format!("<collision><geometry><{words}/></geometry></collision>");
        let model = loaded(&[
            link("a", ""),
            link("b", &geometry),
            joint("j", "revolute", "a", "b", ""),
        ]);
        model.params.geom_size[0].to_array()
    };
    assert_eq!(shape("box size='1 2 3'"), [0.5, 1.0, 1.5]);
    assert_eq!(shape("sphere radius='2'"), [2.0, 0.0, 0.0]);
    assert_eq!(shape("cylinder radius='2' length='3'"), [2.0, 1.5, 0.0]);
    assert_eq!(shape("capsule radius='2' length='3'"), [2.0, 1.5, 0.0]);
}

#[test]
fn visual_geoms_are_omitted_unless_the_file_keeps_them() {
    let visual = "<visual name='skin'><geometry><sphere radius='1'/></geometry>\
         <material name='glass'/></visual>\
         <collision name='core'><geometry><sphere radius='0.5'/></geometry></collision>";
    let parts = |extension: &str| {
        [
            extension.to_owned(),
            "<material name='glass'><color rgba='1 1 1 0'/></material>".to_owned(),
            link("a", ""),
            format!("<link name='b'>{visual}</link>"),
            joint("j", "revolute", "a", "b", ""),
        ]
    };
    let without = loaded(&parts(""));
    assert_eq!(names(without.geoms.iter().map(|g| &g.name)), ["core"]);
    let with = loaded(&parts("<mujoco><compiler discardvisual='false'/></mujoco>"));
    assert_eq!(names(with.geoms.iter().map(|g| &g.name)), ["skin", "core"]);
    assert_eq!(
        (
            with.geoms[0].contype,
            with.geoms[0].conaffinity,
            with.geoms[0].group
        ),
        (0, 0, 1)
    );
    // The visual has no mass. Its transparent colour, which rays pass through, also applies to the elements after it.
    assert_eq!(with.params.body_mass, without.params.body_mass);
    assert!(!with.geoms[0].visible && !with.geoms[1].visible);
}

#[test]
fn settings_of_mujoco_may_stand_in_a_file() {
    let model = loaded(&[
        "<mujoco><compiler boundmass='0.5' boundinertia='0.01'/><option timestep='0.001' gravity='0 0 -1'><flag contact='disable'/></option>\
         <size nkey='2' nuser_body='3'/></mujoco>"
            .to_owned(),
        "<link name='a'/><link name='b'/>".to_owned(),
        joint("j", "revolute", "a", "b", ""),
    ]);
    assert_eq!(model.params.timestep, 0.001);
    assert!(!model.flags.contact);
    assert_eq!(model.keyframes.len(), 2);
    assert_eq!(model.params.body_mass[1], 0.5);
    assert_eq!(model.bodies[1].user.len(), 3);
}

#[test]
fn our_own_robot_grips() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/gripper/gripper.urdf");
    let model = load(path).unwrap();
    assert_eq!(
        names(model.bodies.iter().map(|b| &b.name)),
        ["world", "forearm", "left_finger", "right_finger"]
    );
    assert!((model.params.body_mass[1] - 1.0).abs() < 1e-15);
    let mut sim = Sim::<f64>::new(Arc::new(model)).unwrap();
    sim.state.qfrc_applied[1] = 0.5;
    step(&mut sim, 500);
    let [left, right] = [1, 2].map(|j| sim.state.qpos[j]);
    assert!(left > 0.03 && (left - right).abs() < 2e-3, "{left} {right}");
}
