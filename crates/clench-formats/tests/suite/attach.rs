//! Models attached to models. The names and numbers are those of MuJoCo 4.0.0.

use crate::files::Files;
use clench_formats::read_str;
use clench_rigid::builder::{ModelBuilder, SensorSubject};

const ARM: &str = "<mujoco model='arm'>
  <compiler angle='radian' autolimits='false' eulerseq='zyx' inertiafromgeom='true' meshdir='stl'/>
  <option timestep='0.5'/>
  <default><geom size='.3'/><default class='x'><geom size='.4'/></default></default>
  <asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/><material name='mat'/></asset>
  <worldbody>
    <geom name='wg'/>
    <body name='A' childclass='x'>
      <joint name='ja' range='0 1' limited='true' ref='.5'/><geom name='ga'/>
      <body name='B'>
        <joint name='jb'/><geom name='gb' class='main' type='mesh' mesh='m' material='mat'/>
        <frame name='fr' pos='1 0 0'><body name='C'><joint name='jc'/><geom name='gc'/></body></frame>
      </body>
    </body>
    <body name='D'><joint name='jd'/><geom/></body>
  </worldbody>
  <actuator><motor name='ma' joint='ja'/><motor name='md' joint='jd'/></actuator>
  <sensor><clock name='c'/><jointpos name='sa' joint='ja'/><tactile name='st' mesh='m' geom='ga'/></sensor>
  <contact><exclude name='ex' body1='A' body2='B'/><exclude name='lost' body1='A' body2='D'/></contact>
  <equality><weld name='w' body1='A'/><weld name='lost' body1='A' body2='D'/></equality>
</mujoco>";

fn main_file(compiler: &str, attach: &str, sections: &str) -> String {
    format!(
        "<mujoco><compiler {compiler}/><asset><model name='arm' file='parts/arm.xml'/></asset>
         <worldbody><body name='P'><joint name='pj'/><geom size='1'/>{attach}</body></worldbody>{sections}</mujoco>"
    )
}

fn attached(attach: &str, sections: &str) -> ModelBuilder {
    let main = main_file("", attach, sections);
    let files = Files::new(&[("main.xml", main.as_str()), ("parts/arm.xml", ARM)]);
    files.read().unwrap()
}

fn names<T>(elements: &[T], name: impl Fn(&T) -> &str) -> Vec<&str> {
    elements.iter().map(name).collect()
}

#[test]
fn an_attached_body_brings_its_references_and_the_settings_of_its_file() {
    let model = attached(
        "<attach model='arm' body='A' prefix='p_'/>",
        "<actuator><motor name='own' joint='p_ja'/></actuator>",
    );
    let bodies = names(&model.bodies, |b| &b.name);
    assert_eq!(bodies, ["world", "P", "p_A", "p_B", "p_C"]);
    assert_eq!(names(&model.actuators, |a| &a.name), ["own", "p_ma"]);
    assert_eq!(names(&model.sensors, |s| &s.name), ["p_c", "p_sa", "p_st"]);
    let SensorSubject::Taxels { mesh, geom } = &model.sensors[2].subject else {
        panic!("not a skin")
    };
    assert_eq!([mesh, geom], ["p_m", "p_ga"]);
    assert_eq!(names(&model.excludes, |e| &e.name), ["p_ex"]);
    assert_eq!(names(&model.equalities, |e| &e.name), ["p_w"]);
    assert_eq!(names(&model.meshes, |m| &m.name), ["p_m"]);
    let arm = &model.bodies[2];
    assert_eq!(arm.joints[0].range, [0.0, 1.0], "in radians");
    assert_eq!(arm.geoms[0].size.x, 0.4, "of its childclass");
    assert_eq!(
        model.bodies[3].geoms[0].size.x, 0.3,
        "of the main class of its file"
    );
    assert_eq!(model.bodies[3].geoms[0].mesh, "p_m");
    assert_eq!(model.physics.timestep, 0.002, "its options are omitted");
    assert!(model.notes.iter().any(|note| note.contains("\"arm\"")));
    assert!(model.build().is_ok());
}

/// MuJoCo copies such a sensor for its mesh, and drops it if no model has the geom.
#[test]
fn a_tactile_sensor_follows_its_mesh_to_a_geom_of_the_enclosing_model() {
    let skinned = |geom: &str| {
        let part = ARM.replace("geom='ga'", &format!("geom='{geom}'"));
        let attach = "<geom name='fist' size='1'/><attach model='arm' body='A' prefix='p_'/>";
        let main = main_file("", attach, "");
        let files = Files::new(&[("main.xml", main.as_str()), ("parts/arm.xml", &part)]);
        let model = files.read().expect("a model");
        let mut sensors = model.sensors.iter();
        sensors.find_map(|sensor| match &sensor.subject {
            SensorSubject::Taxels { mesh, geom } => Some([mesh.clone(), geom.clone()]),
            _ => None,
        })
    };
    let both = |mesh: &str, geom: &str| Some([mesh.to_owned(), geom.to_owned()]);
    assert_eq!(skinned("fist"), both("p_m", "fist"));
    assert_eq!(skinned("ga"), both("p_m", "p_ga"));
    assert_eq!(skinned("none"), None);
}

/// The names are MuJoCo's. A class that the enclosing model uses refers to that model's assets.
#[test]
fn assets_that_classes_name_are_those_of_the_attached_file() {
    let arm = "<mujoco model='arm'>
      <default>
        <geom material='mat'/><tendon material='mat'/><material texture='tex'/>
        <default class='x'><geom type='mesh' mesh='m'/><site material='mat'/></default>
      </default>
      <asset>
        <mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/><material name='mat'/>
        <texture name='tex' type='2d' builtin='flat' width='2' height='2'/>
      </asset>
      <worldbody>
        <body name='A' childclass='x'><geom/><site name='s'/><geom class='main' size='1'/></body>
        <site name='t'/>
      </worldbody>
      <tendon><spatial><site site='s'/><site site='t'/></spatial></tendon>
    </mujoco>";
    let main = "<mujoco>
      <asset><model name='arm' file='arm.xml'/><mesh name='m' vertex='0 0 0 2 0 0 0 1 0 0 0 1'/>
        <material name='mat'/></asset>
      <worldbody>
        <frame><attach model='arm' prefix='p_'/></frame><frame><attach model='arm' prefix='q_'/></frame>
        <geom class='q_x'/>
      </worldbody></mujoco>";
    let files = Files::new(&[("main.xml", main), ("arm.xml", arm)]);
    let model = files.read().expect("it is a valid model");
    for (body, prefix) in [(1, "p_"), (2, "q_")] {
        let (mesh, material) = (format!("{prefix}m"), format!("{prefix}mat"));
        let body = &model.bodies[body];
        assert_eq!(names(&body.geoms, |g| &g.mesh), [&mesh, ""]);
        assert_eq!(
            names(&body.geoms, |g| &g.appearance.material),
            [&material; 2]
        );
        assert_eq!(&*body.sites[0].appearance.material, material);
    }
    assert_eq!(model.bodies[0].geoms[0].mesh, "m");
    let tendons = names(&model.tendons, |t| &t.appearance.material);
    assert_eq!(tendons, ["p_mat", "q_mat"]);
    let textures = names(&model.materials, |m| &m.texture);
    assert_eq!(textures, ["", "p_tex", "q_tex"]);
    assert!(model.build().is_ok());
}

#[test]
fn a_whole_world_stands_where_it_is_attached() {
    let model = attached("<attach model='arm' prefix='q'/>", "");
    let bodies = names(&model.bodies, |b| &b.name);
    assert_eq!(bodies, ["world", "P", "qA", "qB", "qC", "qD"]);
    assert_eq!(names(&model.bodies[1].geoms, |g| &g.name), ["", "qwg"]);
    assert_eq!(names(&model.actuators, |a| &a.name), ["qma", "qmd"]);
    assert_eq!(names(&model.excludes, |e| &e.name), ["qex", "qlost"]);
}

#[test]
fn a_frame_comes_without_the_frames_around_it_and_with_the_class_around_it() {
    let model = attached("<attach model='arm' frame='fr' prefix='p_'/>", "");
    assert_eq!(names(&model.bodies, |b| &b.name), ["world", "P", "p_C"]);
    assert_eq!(model.bodies[2].pos.to_array(), [1.0, 0.0, 0.0]);
    assert_eq!(model.bodies[2].geoms[0].size.x, 0.4);
    assert!(model.actuators.is_empty());
}

#[test]
fn a_model_can_be_attached_twice_and_lends_its_classes() {
    let model = attached(
        "<attach model='arm' body='B' prefix='l'/><attach model='arm' body='B' prefix='r'/><geom class='lx'/>",
        "",
    );
    let bodies = names(&model.bodies, |b| &b.name);
    assert_eq!(bodies, ["world", "P", "lB", "lC", "rB", "rC"]);
    assert_eq!(names(&model.meshes, |m| &m.name), ["lm", "rm"]);
    assert_eq!(model.bodies[1].geoms[1].size.x, 0.4);
}

#[test]
fn attached_elements_can_be_replicated() {
    let model = attached(
        "<replicate count='2'><attach model='arm' body='B' prefix='p_'/></replicate>",
        "<actuator><motor name='own' joint='p_jb'/></actuator>",
    );
    let bodies = names(&model.bodies, |b| &b.name);
    assert_eq!(bodies, ["world", "P", "p_B0", "p_C0", "p_B1", "p_C1"]);
    assert_eq!(names(&model.meshes, |m| &m.name), ["p_m"]);
    assert_eq!(names(&model.actuators, |a| &a.name), ["own0", "own1"]);
}

#[test]
fn a_model_attaches_parts_of_itself_that_stand_before() {
    let model = read_str(
        "<mujoco><worldbody>
           <body name='P'><joint name='pj'/><geom size='1'/>
             <body name='Q'><joint name='qj'/><geom size='1'/></body>
             <attach body='Q' prefix='x'/>
             <attach body='P' prefix='y'/>
           </body>
         </worldbody>
         <actuator><motor name='m' joint='qj'/></actuator></mujoco>",
    )
    .unwrap();
    let bodies = names(&model.bodies, |b| &b.name);
    assert_eq!(bodies, ["world", "P", "Q", "xQ", "yP", "yQ", "yxQ"]);
    let actuators = names(&model.actuators, |a| &a.name);
    assert_eq!(actuators, ["m", "xm", "ym", "yxm"]);
}

#[test]
fn elements_of_the_world_alone_are_not_attached_with_a_part() {
    let model = read_str(
        "<mujoco><worldbody><geom type='plane' size='1 1 1'/>
           <body name='b'><joint/><geom size='1'/></body><attach body='b' prefix='c_'/>
         </worldbody>
         <actuator><adhesion name='floor' body='world' ctrlrange='0 1'/>
           <adhesion name='own' body='b' ctrlrange='0 1'/></actuator>
         <equality><weld name='w' body1='world' body2='b'/></equality></mujoco>",
    )
    .unwrap();
    assert_eq!(
        names(&model.actuators, |a| &a.name),
        ["floor", "own", "c_own"]
    );
    assert_eq!(names(&model.equalities, |e| &e.name), ["w", "c_w"]);
}

#[test]
fn a_site_may_be_called_world() {
    let model = read_str(
        "<mujoco><worldbody>
           <body name='b'><joint/><geom size='1'/><site name='world'/>
             <body><joint/><geom size='1'/><site name='tip'/></body>
           </body>
           <attach body='b' prefix='c_'/>
         </worldbody>
         <tendon><spatial name='t'><site site='world'/><site site='tip'/></spatial></tendon>
         <actuator><motor name='m' site='world'/></actuator></mujoco>",
    )
    .unwrap();
    assert_eq!(names(&model.actuators, |a| &a.name), ["m", "c_m"]);
    assert_eq!(names(&model.tendons, |t| &t.name), ["t", "c_t"]);
    let path = format!("{:?}", model.tendons[1].path);
    assert!(path.contains("c_world") && path.contains("c_tip"), "{path}");
}

#[test]
fn files_of_attached_models_are_relative_to_those_models() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    let files = Files::new(&[
        (
            "main.xml",
            "<mujoco><compiler meshdir='nowhere'/><asset><model name='a' file='a/a.xml'/></asset>
             <worldbody><attach model='a' prefix='p'/></worldbody></mujoco>",
        ),
        (
            "a/a.xml",
            "<mujoco><compiler meshdir='stl'/><asset><model file='b/b.xml'/><mesh file='t.obj'/></asset>
             <worldbody><geom type='mesh' mesh='t'/><attach model='inner' prefix='q'/></worldbody></mujoco>",
        ),
        ("a/stl/t.obj", triangle),
        (
            "a/b/b.xml",
            "<mujoco model='inner'><asset><mesh file='u.obj'/></asset>
             <worldbody><geom type='mesh' mesh='u'/></worldbody></mujoco>",
        ),
        ("a/b/u.obj", triangle),
    ]);
    let model = files.read().unwrap();
    assert_eq!(names(&model.meshes, |m| &m.name), ["pt", "pqu"]);
    assert_eq!(names(&model.bodies[0].geoms, |g| &g.mesh), ["pt", "pqu"]);
}

#[test]
fn a_model_that_attaches_itself_is_refused_with_the_chain() {
    let files = Files::new(&[
        (
            "main.xml",
            "<mujoco><asset><model file='a.xml'/></asset></mujoco>",
        ),
        (
            "a.xml",
            "<mujoco><asset><model file='main.xml'/></asset></mujoco>",
        ),
    ]);
    let error = files.read().unwrap_err();
    assert!(error.message.contains("attaches itself"), "{error}");
    assert_eq!(error.message.matches("main.xml").count(), 2, "{error}");
    assert_eq!(error.message.matches("a.xml").count(), 1, "{error}");
}

#[test]
fn unsupported_attachments_are_refused_with_the_reason() {
    let refused = |compiler: &str, attach: &str, words: &str| {
        let main = main_file(compiler, attach, "");
        let files = Files::new(&[("main.xml", main.as_str()), ("parts/arm.xml", ARM)]);
        let error = files.read().unwrap_err();
        assert!(error.message.contains(words), "{error}");
    };
    refused(
        "",
        "<attach model='amr' prefix='p'/>",
        "did you mean \"arm\"",
    );
    refused(
        "",
        "<attach model='arm' body='Z' prefix='p'/>",
        "no body \"Z\"",
    );
    let files = Files::new(&[("main.xml", main_file("", "", "").as_str())]);
    let error = files.read().unwrap_err();
    assert!(error.message.contains("cannot read"), "{error}");
}

/// Returns time step, iterations, gravity and warnings of a model with options `own` that attaches parts with the
/// options `parts`.
fn merged(conflict: &str, own: &str, parts: &[&str]) -> Result<(f64, usize, f64, String), String> {
    let part = |options: &&str| {
        format!(
            "<mujoco>{options}<worldbody><body name='b'><geom size='1'/></body></worldbody></mujoco>"
        )
    };
    let parts: Vec<String> = parts.iter().map(part).collect();
    let names: Vec<String> = (0..parts.len()).map(|k| format!("{k}.xml")).collect();
    let models = (0..parts.len()).map(|k| format!("<model name='m{k}' file='{k}.xml'/>"));
    let attached = (0..parts.len()).map(|k| format!("<attach model='m{k}' prefix='p{k}'/>"));
    let main = format!(
        "<mujoco><compiler conflict='{conflict}'/>{own}<asset>{}</asset><worldbody>{}</worldbody></mujoco>",
        models.collect::<String>(),
        attached.collect::<String>()
    );
    let mut files = vec![("main.xml", main.as_str())];
    files.extend(
        names
            .iter()
            .map(String::as_str)
            .zip(parts.iter().map(String::as_str)),
    );
    let model = Files::new(&files)
        .read()
        .map_err(|error| error.to_string())?;
    let iterations = model.options.iterations.unwrap_or_default();
    let physics = &model.physics;
    Ok((
        physics.timestep,
        iterations,
        physics.gravity[2],
        model.notes.join("; "),
    ))
}

#[test]
fn options_of_attached_models_are_merged_if_possible() {
    let (timestep, iterations, gravity, notes) = merged(
        "merge",
        "<option timestep='.005' iterations='50'/>",
        &["<option timestep='.001' iterations='20' gravity='0 0 -10'><flag damper='disable'/></option>"],
    )
    .unwrap();
    assert_eq!((timestep, iterations, gravity), (0.001, 50, -10.0));
    assert!(notes.contains("timestep, gravity, damper"), "{notes}");
}

#[test]
fn options_adopted_from_an_earlier_attached_model_count_as_set() {
    let parts = ["<option timestep='.004'/>", "<option timestep='.001'/>"];
    assert_eq!(merged("merge", "", &parts).unwrap().0, 0.001);
    assert_eq!(merged("merge", "", &parts[..1]).unwrap().0, 0.004);
    assert_eq!(merged("warning", "", &parts).unwrap().0, 0.002);
    assert_eq!(merged("error", "", &parts).unwrap().0, 0.002);
}

#[test]
fn options_that_cannot_be_merged_are_refused_by_name() {
    let own = "<option gravity='0 0 -10' timestep='.005'><flag constraint='enable'/></option>";
    let part = ["<option gravity='0 0 -9' timestep='.001'><flag constraint='disable'/></option>"];
    let error = merged("merge", own, &part).unwrap_err();
    assert!(error.contains("main.xml:1: attach"), "{error}");
    assert!(
        error.contains("gravity: here 0 0 -10, there 0 0 -9"),
        "{error}"
    );
    assert!(!error.contains("timestep"), "{error}");
    let error = merged("error", own, &part).unwrap_err();
    assert!(
        error.contains("timestep") && error.contains("flag constraint"),
        "{error}"
    );
}

#[test]
fn urdf_can_be_attached_and_the_enclosing_model_determines_fusing() {
    let robot = "<robot name='r'>
      <link name='base'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>
      <link name='arm'>
        <inertial><mass value='2'/><inertia ixx='1' iyy='2' izz='2.5' ixy='.1' ixz='0' iyz='0'/></inertial>
        <collision name='col'><geometry><sphere radius='.1'/></geometry></collision>
        <visual><geometry><sphere radius='.2'/></geometry></visual>
      </link>
      <link name='tool'><inertial><mass value='.5'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>
      <joint name='j' type='revolute'><parent link='base'/><child link='arm'/><origin xyz='0 0 1' rpy='.1 .2 .3'/>
        <axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='5' velocity='1'/><dynamics damping='.3' friction='.1'/></joint>
      <joint name='f' type='fixed'><parent link='arm'/><child link='tool'/></joint>
    </robot>";
    let attached = |compiler: &str, attach: &str| {
        let main = format!(
            "<mujoco>{compiler}<asset><model name='r' file='r.urdf'/></asset>
             <worldbody><body name='P'><freejoint/><geom size='1'/>{attach}</body></worldbody></mujoco>"
        );
        let files = Files::new(&[("main.xml", main.as_str()), ("r.urdf", robot)]);
        let builder = files.read().unwrap();
        assert!(builder.notes.is_empty(), "{:?}", builder.notes);
        builder.build().unwrap()
    };
    let model = attached("", "<attach model='r' prefix='x_'/>");
    let bodies = names(&model.bodies, |b| &b.name);
    assert_eq!(bodies, ["world", "P", "x_base", "x_arm", "x_tool"]);
    assert_eq!(names(&model.geoms, |g| &g.name), ["", "x_col"]);
    assert_eq!(model.params.jnt_range[1], [-1.0, 1.0]);
    assert_eq!(model.params.jnt_actfrcrange[1], [-5.0, 5.0]);
    let fused = attached(
        "<compiler fusestatic='true' angle='radian'/>",
        "<attach model='r' body='arm' prefix='x_'/>",
    );
    assert_eq!(names(&fused.bodies, |b| &b.name), ["world", "P", "x_arm"]);
    assert_eq!(fused.params.body_mass[2], 2.5);
}
