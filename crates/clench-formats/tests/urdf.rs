//! URDF: links, joints, meshes of packages, MuJoCo's extension, and what is wrong with a file.

mod assets;

use assets::Folder;
use clench_formats::{LoadError, Loader, load, load_str};
use clench_rigid::model::{EqualityTarget, JointKind};
use clench_rigid::{Model, Sim};
use std::path::Path;
use std::sync::Arc;

/// A link of one kilogram, with more in it.
fn link(name: &str, more: &str) -> String {
    format!(
        "<link name='{name}'><inertial><origin xyz='0 0 0.1'/><mass value='1'/>\
         <inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial>{more}</link>"
    )
}

/// A joint from link to link, with more in it.
fn joint(name: &str, kind: &str, from: &str, to: &str, more: &str) -> String {
    format!(
        "<joint name='{name}' type='{kind}'><parent link='{from}'/><child link='{to}'/>{more}</joint>"
    )
}

fn step(sim: &mut Sim<f64>, count: usize) {
    (0..count).for_each(|_| sim.step().unwrap());
}

fn robot(parts: &[String]) -> String {
    format!("<robot name='r'>\n{}\n</robot>", parts.join("\n"))
}

#[track_caller]
fn loaded(parts: &[String]) -> Model {
    load_str(&robot(parts)).unwrap_or_else(|error| panic!("{error}"))
}

/// One joint between two links, with this in it.
#[track_caller]
fn with_joint(kind: &str, more: &str) -> Model {
    loaded(&[
        link("a", ""),
        link("b", ""),
        joint("j", kind, "a", "b", more),
    ])
}

fn names<'a>(names: impl Iterator<Item = &'a String>) -> Vec<&'a str> {
    names.map(String::as_str).collect()
}

#[test]
fn each_kind_of_joint_moves_as_it_says() {
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
fn a_planar_joint_slides_across_its_axis_and_turns_about_it() {
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
    // A limit holds the first direction alone.
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
    // The first column of Rz(yaw) Ry(pitch) Rx(roll), and an entry that roll decides.
    let turn = model.params.body_quat[1].to_matrix();
    let expected = [cos(y) * cos(p), sin(y) * cos(p), -sin(p)];
    for (row, expected) in turn.rows.iter().zip(expected) {
        assert!((row.x - expected).abs() < 1e-15);
    }
    assert!((turn.rows[2].y - cos(p) * sin(r)).abs() < 1e-15);
    assert_eq!(model.params.body_pos[1].to_array(), [1.0, 2.0, 3.0]);
}

#[test]
fn limits_count_where_they_rise() {
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
    // MuJoCo ignores limits that cannot be, and so does this reader, but says so.
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
    // The flange stands at (1, 0, 0), its z axis along x: its centre of mass at (1.1, 0, 0), its ball at (2, 0, 0).
    near(fused.params.body_ipos[1].to_array(), [0.55, 0.0, 0.05]);
    near(fused.params.geom_pos[2].to_array(), [2.0, 0.0, 0.0]);
    near(fused.params.body_pos[2].to_array(), [3.0, 0.0, 0.0]);
    // Fused or not, it moves alike.
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
fn what_is_only_seen_is_left_out_unless_the_file_wants_it() {
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
    // It weighs nothing, and its colour, through which rays pass, is also that of what follows.
    assert_eq!(with.params.body_mass, without.params.body_mass);
    assert!(!with.geoms[0].visible && !with.geoms[1].visible);
}

#[test]
fn settings_of_mujoco_may_stand_in_a_file() {
    let model = loaded(&[
        "<mujoco><compiler boundmass='0.5' boundinertia='0.01'/><option timestep='0.001' gravity='0 0 -1'><flag contact='disable'/></option>\
         <size nkey='2'/></mujoco>"
            .to_owned(),
        "<link name='a'/><link name='b'/>".to_owned(),
        joint("j", "revolute", "a", "b", ""),
    ]);
    assert_eq!(model.params.timestep, 0.001);
    assert!(!model.flags.contact);
    assert_eq!(model.keyframes.len(), 2);
    assert_eq!(model.params.body_mass[1], 0.5);
}

#[test]
fn what_is_no_link_and_no_joint_is_ignored_and_mistakes_are_noted() {
    let text = "<robot name='r' xmlns:controller='http://example.org/c'>
      <gazebo reference='a'><controller:plugin controller:x='1' filename='x.so'/></gazebo>
      <transmission name='t'><joint name='j'/></transmission>
      <link name='a'/>
      <link name='b'>
        <inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>
        <colision/>
      </link>
      <joint name='j' type='revolute'><parent link='a'/><child link='b'/><limit lower='-1' uper='1' upper='1'/></joint>
    </robot>";
    let model = load_str(text).unwrap();
    assert_eq!(model.notes.len(), 2, "{:?}", model.notes);
    assert_eq!(
        model.notes[0],
        "line 7: <colision> of link \"b\" is ignored; did you mean \"collision\"?"
    );
    assert!(model.notes[1].contains("\"uper\"") && model.notes[1].contains("\"upper\""));
}

/// A tetrahedron of a side.
fn tetrahedron(side: f64) -> String {
    format!(
        "v 0 0 0\nv {side} 0 0\nv 0 {side} 0\nv 0 0 {side}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    )
}

fn with_meshes(files: &[&str]) -> String {
    let shape = |file: &&str| format!("<collision><geometry><mesh {file}/></geometry></collision>");
    let shapes: String = files.iter().map(shape).collect();
    robot(&[
        link("a", ""),
        link("b", &shapes),
        joint("j", "revolute", "a", "b", ""),
    ])
}

#[test]
fn meshes_of_packages_are_found_around_the_model_and_on_the_path() {
    let folder = Folder::new("urdf-packages");
    let deep = |name: &str, bytes: &str| {
        let path = folder.0.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    };
    deep("share/arm/meshes/part.obj", &tetrahedron(1.0));
    deep("elsewhere/hand/part.obj", &tetrahedron(2.0));
    let model = "share/arm/urdf/arm.urdf";
    let path = folder.0.join(model);
    let text = |file: &str| with_meshes(&[&format!("filename='{file}'")]);

    deep(model, &text("package://arm/meshes/part.obj"));
    assert_eq!(load(&path).unwrap().meshes[0].name, "part");
    deep(model, &text("../meshes/part.obj"));
    load(&path).unwrap();
    deep(
        model,
        &text(&format!(
            "file://{}/share/arm/meshes/part.obj",
            folder.0.display()
        )),
    );
    load(&path).unwrap();

    deep(model, &text("package://hand/part.obj"));
    let error = load(&path).unwrap_err().to_string();
    assert!(error.contains("the package \"hand\""), "{error}");
    for place in ["elsewhere", "elsewhere/hand"] {
        let loader = Loader::new().package_path([folder.0.join(place)]);
        loader.load(&path).unwrap();
    }
    let stripped = text("package://hand/part.obj").replace(
        "<link name='a'>",
        "<mujoco><compiler strippath='true' meshdir='../meshes'/></mujoco><link name='a'>",
    );
    deep(model, &stripped);
    load(&path).unwrap();
}

#[test]
fn a_mesh_is_read_once_for_each_scale() {
    let folder = Folder::new("urdf-scales");
    folder.write("part.obj", tetrahedron(1.0));
    folder.write("parts/part.obj", tetrahedron(2.0));
    folder.write(
        "model.urdf",
        with_meshes(&[
            "filename='part.obj'",
            "filename='part.obj' scale='2 2 2'",
            "filename='part.obj' scale='2 2 2'",
            "filename='parts/part.obj'",
        ]),
    );
    let model = load(folder.0.join("model.urdf")).unwrap();
    assert_eq!(
        names(model.meshes.iter().map(|m| &m.name)),
        ["part", "part1", "part2"]
    );
    let meshes: Vec<_> = model.geoms.iter().map(|geom| geom.mesh).collect();
    assert_eq!(meshes, [Some(0), Some(1), Some(1), Some(2)]);
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

fn rejected(parts: &[&str]) -> LoadError {
    let parts: Vec<String> = parts.iter().map(|part| (*part).to_owned()).collect();
    match load_str(&robot(&parts)) {
        Ok(_) => panic!("was accepted: {parts:?}"),
        Err(error) => error,
    }
}

#[test]
fn an_error_names_line_element_and_link() {
    let (a, b) = (&link("a", "")[..], &link("b", "")[..]);
    let ab = |kind: &str, more: &str| joint("j", kind, "a", "b", more);
    let cases: [(&[&str], u32, &str, &str); 16] = [
        (&["<link/>"], 2, "link", "\"name\" is required"),
        (&[a, a], 3, "link \"a\"", "taken already"),
        (
            &[a, &joint("j", "fixed", "a", "c", "")],
            3,
            "child of joint \"j\"",
            "no link \"c\"",
        ),
        (
            &[a, b, &ab("revolut", "")],
            4,
            "joint \"j\"",
            "not one of revolute",
        ),
        (
            &[
                a,
                b,
                "<joint name='j'><parent link='a'/><child link='b'/></joint>",
            ],
            4,
            "joint \"j\"",
            "\"type\" is required",
        ),
        (
            &[
                a,
                b,
                "<joint name='j' type='fixed'><child link='b'/></joint>",
            ],
            4,
            "joint \"j\"",
            "<parent> is required",
        ),
        (
            &[a, b, &ab("fixed", ""), &ab("fixed", "")],
            5,
            "joint \"j\"",
            "link \"b\" has a parent already",
        ),
        (
            &[a, b, &ab("fixed", ""), &joint("k", "fixed", "b", "a", "")],
            4,
            "joint \"j\"",
            "loop",
        ),
        (
            &[a, b, &ab("revolute", "<axis xyz='1 0'/>")],
            4,
            "axis of joint \"j\"",
            "needs 3 numbers",
        ),
        (
            &[a, b, &ab("revolute", "<axis xyz='0 0 0'/>")],
            4,
            "joint \"j\" of body \"b\"",
            "axis is zero",
        ),
        (
            &[a, b, &ab("revolute", "<limit lower='x'/>")],
            4,
            "limit of joint \"j\"",
            "\"x\" in lower",
        ),
        (
            &["<link name='a'><inertial><mass value='1'/></inertial></link>"],
            2,
            "inertial of link \"a\"",
            "<inertia> is required",
        ),
        (
            &["<link name='a'><collision/></link>"],
            2,
            "collision of link \"a\"",
            "<geometry> is required",
        ),
        (
            &["<link name='a'><collision><geometry/></collision></link>"],
            2,
            "geometry of link \"a\"",
            "needs a <box>",
        ),
        (
            &[
                "<link name='a'><collision><geometry><mesh filename='x.stl'/></geometry></collision></link>",
            ],
            2,
            "mesh of link \"a\"",
            "cannot find the file \"x.stl\"",
        ),
        (
            &[a, "<mujoco><compiler balanceinertias='true'/></mujoco>"],
            3,
            "compiler",
            "did you mean \"balanceinertia\"",
        ),
    ];
    for (parts, line, element, message) in cases {
        let error = rejected(parts);
        assert_eq!(error.line, Some(line), "{error}");
        assert_eq!(error.element.as_deref(), Some(element), "{error}");
        assert!(error.message.contains(message), "{error}");
    }
}

#[test]
fn inertias_that_no_body_has_name_the_link() {
    let with = |mass: &str, inertia: [&str; 3]| {
        let [x, y, z] = inertia;
        let b = format!(
            "<link name='b'><inertial><mass value='{mass}'/>\
             <inertia ixx='{x}' iyy='{y}' izz='{z}' ixy='0' ixz='0' iyz='0'/></inertial></link>"
        );
        rejected(&[
            "<link name='a'/>",
            &b,
            &joint("j", "revolute", "a", "b", ""),
        ])
    };
    let cases = [
        (with("1", ["1", "1", "3"]), "balanceinertia"),
        (with("1", ["-1", "1", "1"]), "positive definite"),
        (with("1", ["0", "0", "0"]), "a moving body must have a mass"),
        (with("-1", ["1", "1", "1"]), "cannot be negative"),
    ];
    for (error, message) in cases {
        assert_eq!(error.line, Some(3), "{error}");
        assert!(
            error
                .element
                .as_deref()
                .is_some_and(|e| e.contains("body \"b\"")),
            "{error}"
        );
        assert!(error.message.contains(message), "{error}");
    }
}

#[test]
fn a_long_chain_of_links_needs_no_stack() {
    let count = 3000;
    let mut text = String::from("<robot><link name='l0'/>");
    for k in 1..count {
        let above = k - 1;
        text += &format!(
            "<link name='l{k}'/><joint name='j{k}' type='fixed'><parent link='l{above}'/><child link='l{k}'/></joint>"
        );
    }
    text += "</robot>";
    let thread = std::thread::Builder::new().stack_size(128 * 1024);
    let model = thread
        .spawn(move || load_str(&text))
        .unwrap()
        .join()
        .unwrap();
    assert_eq!(model.unwrap().nbody(), 1);
}
