//! A written model loads to the same model: every record, every number.

use super::SaveModel;
use crate::load_str;
use crate::loader::Loader;
use clench_dynamics::model::{
    Body, Geom, HeightField, Joint, Mesh, ParamField, Sensor, SensorKind, SensorTarget,
};
use clench_math::Vec3;
use clench_rigid::options::ContactModel;
use clench_rigid::{Model, Sim};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The tolerance of written numbers: exact except for unit quaternions, which are normalized again.
const ROUNDING: f64 = 1e-14;
/// The tolerance of derived numbers, which take more arithmetic, such as the principal axes of meshes.
const COMPUTED: f64 = 1e-9;

/// The treatment of a field of a model's numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fate {
    /// It is always written.
    Written,
    /// It is written if nonzero.
    WrittenIfAny,
    /// It is written as part of a pose, an axis or a shape, or only for some kinds of elements.
    InPart,
    /// It is computed from others.
    Computed,
}

fn fate(field: ParamField) -> Fate {
    use Fate::{Computed, InPart, Written, WrittenIfAny};
    use ParamField as F;
    match field {
        F::timestep | F::gravity | F::wind | F::magnetic | F::density | F::viscosity => Written,
        F::override_margin | F::override_solref | F::override_solimp | F::override_friction => {
            InPart
        }
        F::qpos0 | F::qpos_spring => InPart,
        F::body_mass | F::body_inertia | F::body_pos | F::body_ipos => WrittenIfAny,
        F::body_gravcomp => WrittenIfAny,
        F::body_quat | F::body_iquat => InPart,
        F::body_subtreemass | F::body_invweight0 => Computed,
        F::jnt_pos | F::jnt_range => WrittenIfAny,
        F::jnt_axis => InPart,
        F::jnt_stiffness | F::jnt_stiffnesspoly | F::jnt_margin | F::jnt_actfrcrange => Written,
        F::jnt_springyield | F::tendon_springyield => WrittenIfAny,
        F::jnt_solref | F::jnt_solimp => Written,
        F::dof_armature | F::dof_damping | F::dof_dampingpoly | F::dof_frictionloss => Written,
        F::dof_solref | F::dof_solimp => Written,
        F::sleep_tolerance => Written,
        F::dof_invweight0 | F::dof_length => Computed,
        F::geom_pos | F::geom_quat | F::geom_size => InPart,
        F::geom_rbound => Computed,
        F::geom_friction | F::geom_margin | F::geom_gap | F::geom_solmix => Written,
        F::geom_solref | F::geom_solimp => Written,
        F::geom_surfacevel | F::geom_adhesion | F::geom_fluidcoef => Written,
        F::geom_virtualmass | F::geom_virtualinertia => Computed,
        F::site_pos => WrittenIfAny,
        F::site_size | F::site_quat => InPart,
        F::wrap_coef | F::tendon_armature => WrittenIfAny,
        F::tendon_stiffness | F::tendon_stiffnesspoly | F::tendon_margin => Written,
        F::tendon_damping | F::tendon_dampingpoly => Written,
        F::tendon_lengthspring | F::tendon_range | F::tendon_actfrcrange => Written,
        F::tendon_frictionloss | F::tendon_solref_lim | F::tendon_solimp_lim => Written,
        F::tendon_solref_fri | F::tendon_solimp_fri => Written,
        F::tendon_length0 | F::tendon_invweight0 => Computed,
        F::actuator_gear | F::actuator_dynprm | F::actuator_gainprm => Written,
        F::actuator_biasprm | F::actuator_ctrlrange | F::actuator_forcerange => Written,
        F::actuator_actrange => Written,
        F::actuator_damping | F::actuator_dampingpoly | F::actuator_armature => WrittenIfAny,
        F::actuator_delay | F::sensor_delay | F::sensor_interval => InPart,
        F::actuator_cranklength => InPart,
        F::cam_pos => WrittenIfAny,
        F::cam_quat | F::cam_fovy | F::cam_sensorsize | F::cam_intrinsic => InPart,
        F::cam_pos0 | F::cam_poscom0 | F::cam_mat0 => Computed,
        F::actuator_lengthrange => WrittenIfAny,
        F::actuator_acc0 => Computed,
        F::eq_anchor1 | F::eq_anchor2 | F::eq_quat1 | F::eq_quat2 | F::eq_torquescale => InPart,
        F::eq_polycoef => WrittenIfAny,
        F::eq_solref | F::eq_solimp => Written,
        F::pair_friction | F::pair_solref | F::pair_solreffriction | F::pair_solimp => Written,
        F::pair_margin | F::pair_gap | F::pair_adhesion => Written,
    }
}

/// The paths of this repository's models.
fn files() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folders = [
        "models",
        "parity/models",
        "parity/shapes",
        "fuzz/seeds/mjcf",
    ];
    let mut found = vec![root.join("models/gripper/gripper.urdf")];
    for folder in folders {
        for entry in std::fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            // The seeds refer to files that the fuzzer provides.
            let own = name.ends_with(".xml") && !name.starts_with("bad-");
            if own && name != "assets.xml" && name != "part.xml" {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The loaded models.
fn models() -> impl Iterator<Item = (String, Model)> {
    files().into_iter().map(|path| {
        let model = Loader::new()
            .load(&path)
            .unwrap_or_else(|error| panic!("{error}"));
        let name = path.display().to_string();
        // A file stores 24 bits of a mesh deformed by frames; a model saved once is unchanged by a second save.
        let whole = |mesh: &Mesh| mesh.spec.vertices.iter().all(in_single_precision);
        match model.meshes.iter().all(|mesh| whole(mesh)) {
            true => (name, model),
            false => (name.clone(), saved(&name, &model)),
        }
    })
}

fn in_single_precision(point: &Vec3<f64>) -> bool {
    point.to_array().iter().all(|&x| f64::from(x as f32) == x)
}

/// Only the vertices are rounded, to the 24 bits that a file stores.
#[test]
fn a_mesh_deformed_by_frames_is_saved_rounded() {
    let model = load_str(
        "<mujoco><asset><mesh name='m' vertex='0 0 0  0.1 0 0  0 0.2 0  0 0 0.3'/></asset><worldbody>
           <frame scale='1 2 3' scaling='geometry'><body euler='0 0 30'><freejoint/><geom type='mesh' mesh='m'/></body></frame>
         </worldbody></mujoco>",
    );
    let model = model.unwrap();
    assert!(
        !model.meshes[0]
            .spec
            .vertices
            .iter()
            .all(in_single_precision)
    );
    let again = saved("a stretched mesh", &model);
    let vertices = |model: &Model| model.meshes[0].spec.vertices.clone();
    for (a, e) in vertices(&again).into_iter().zip(vertices(&model)) {
        assert!((a - e).norm() < 1e-7 * e.norm().max(1e-3), "{a:?} {e:?}");
    }
}

fn saved(name: &str, model: &Model) -> Model {
    let text = model
        .to_mjcf()
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    load_str(&text).unwrap_or_else(|error| panic!("{name}: {error}\n{text}"))
}

#[track_caller]
fn assert_near(what: &str, actual: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(actual.len(), expected.len(), "{what}");
    let largest = expected
        .iter()
        .filter(|x| x.is_finite())
        .fold(0.0, |m: f64, x| m.max(x.abs()));
    for (k, (a, e)) in actual.iter().zip(expected).enumerate() {
        let near = a == e || (a - e).abs() <= tolerance * largest.max(1e-3);
        assert!(near, "{what}[{k}]: {a:?} instead of {e:?}");
    }
}

/// Formats every record of structure as text, without its source location.
fn records(model: &Model) -> Vec<String> {
    let mut found = vec![
        format!(
            "{} {} {} {} {}",
            model.name, model.nq, model.nv, model.na, model.nmocap
        ),
        format!("{:?} {:?}", model.integrator, model.override_contacts),
    ];
    let mut flags = model.flags;
    (flags.constraint, flags.warmstart, flags.island) = (true, true, true);
    found.push(format!("{flags:?}"));
    found.extend(model.bodies.iter().map(|b| {
        format!(
            "{:?}",
            Body {
                origin: None,
                ..b.clone()
            }
        )
    }));
    found.extend(model.joints.iter().map(|j| {
        format!(
            "{:?}",
            Joint {
                origin: None,
                ..j.clone()
            }
        )
    }));
    found.extend(model.geoms.iter().map(|g| {
        format!(
            "{:?}",
            Geom {
                origin: None,
                ..g.clone()
            }
        )
    }));
    found.extend(model.sensors.iter().map(|s| {
        format!(
            "{:?}",
            Sensor {
                origin: None,
                ..s.clone()
            }
        )
    }));
    found.extend(model.dofs.iter().map(|x| format!("{x:?}")));
    found.extend(model.cameras.iter().map(|x| format!("{x:?}")));
    found.extend(model.sites.iter().map(|x| format!("{x:?}")));
    found.extend(model.tendons.iter().map(|x| format!("{x:?}")));
    found.extend(model.actuators.iter().map(|x| format!("{x:?}")));
    found.extend(model.equalities.iter().map(|x| format!("{x:?}")));
    found.extend(model.pairs.iter().map(|x| format!("{x:?}")));
    let mut excludes: Vec<_> = model.excludes.iter().collect();
    excludes.sort();
    found.push(format!("{excludes:?}"));
    found
}

#[test]
fn every_record_comes_back() {
    for (name, model) in models() {
        let again = saved(&name, &model);
        for (actual, expected) in records(&again).iter().zip(&records(&model)) {
            assert_eq!(actual, expected, "{name}");
        }
        for (a, e) in again.meshes.iter().zip(&model.meshes) {
            let hull = |mesh: &Mesh| mesh.hull.is_some();
            assert_eq!(
                (&a.name, &a.faces, hull(a)),
                (&e.name, &e.faces, hull(e)),
                "{name}"
            );
            assert_eq!(a.spec.vertices, e.spec.vertices, "{name}");
        }
        for (a, e) in again.height_fields.iter().zip(&model.height_fields) {
            let HeightField {
                name: field,
                shape,
                heights: _,
            } = &**e;
            assert_eq!((&a.name, &a.shape), (field, shape), "{name}");
        }
        for (a, e) in again.keyframes.iter().zip(&model.keyframes) {
            assert_eq!((&a.name, a.time), (&e.name, e.time));
            let vectors = [
                (&a.qpos, &e.qpos),
                (&a.qvel, &e.qvel),
                (&a.act, &e.act),
                (&a.ctrl, &e.ctrl),
            ];
            let mocap = [(&a.mocap_pos, &e.mocap_pos), (&a.mocap_quat, &e.mocap_quat)];
            for (actual, expected) in vectors.into_iter().chain(mocap) {
                assert_near(&name, actual, expected, ROUNDING);
            }
        }
    }
}

#[test]
fn every_number_comes_back() {
    for (name, model) in models() {
        let again = saved(&name, &model);
        let shaped = !model.meshes.is_empty() || !model.height_fields.is_empty();
        // The crank length has no meaning for an actuator without a crank.
        let all = ParamField::ALL.iter().copied();
        for field in all.filter(|&field| field != ParamField::actuator_cranklength) {
            let tolerance = match fate(field) {
                Fate::Written | Fate::WrittenIfAny => ROUNDING,
                Fate::InPart if shaped => COMPUTED,
                Fate::InPart => ROUNDING,
                Fate::Computed => COMPUTED,
            };
            let [actual, expected] = [&again, &model].map(|m| m.params.read_lane(field, 0));
            assert_near(
                &format!("{name}: {}", field.name()),
                &actual,
                &expected,
                tolerance,
            );
        }
    }
}

#[test]
fn a_number_that_is_not_what_files_have_comes_back_too() {
    use ParamField as F;
    // Signs and zeros have a meaning here: a positive velocity coefficient is a damping ratio, without gains there is
    // no controller, an input of one has a range or none, and the range of a norm begins at 0.
    let signed = [
        F::actuator_gainprm,
        F::actuator_biasprm,
        F::actuator_dynprm,
        F::actuator_ctrlrange,
        F::actuator_forcerange,
    ];
    for (name, mut model) in models() {
        for &field in ParamField::ALL {
            let shift = match fate(field) {
                _ if signed.contains(&field) => 0.0,
                Fate::Written => 0.003,
                Fate::WrittenIfAny => 0.0,
                Fate::InPart | Fate::Computed => continue,
            };
            let mut values = model.params.read_lane(field, 0);
            values.iter_mut().for_each(|x| *x = *x * 1.25 + shift);
            model.params.write_lane(field, 0, &values);
        }
        let again = saved(&name, &model);
        for &field in ParamField::ALL {
            if matches!(fate(field), Fate::Written | Fate::WrittenIfAny) {
                let [actual, expected] = [&again, &model].map(|m| m.params.read_lane(field, 0));
                assert_near(
                    &format!("{name}: {}", field.name()),
                    &actual,
                    &expected,
                    ROUNDING,
                );
            }
        }
    }
}

#[test]
fn every_kind_of_sensor_is_written() {
    let mut kinds: Vec<SensorKind> = models()
        .flat_map(|(_, model)| model.sensors.iter().map(|s| s.kind).collect::<Vec<_>>())
        .collect();
    kinds.dedup();
    for kind in SensorKind::ALL {
        assert!(
            kinds.contains(kind),
            "no model of ours has a {}",
            kind.name()
        );
    }
}

#[test]
fn a_saved_model_moves_equally() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/humanoid.xml");
    let model = Loader::new().load(path).unwrap();
    let again = saved("humanoid", &model);
    let run = |model: Model| {
        let mut sim = Sim::<f64>::new(Arc::new(model)).unwrap();
        (0..100).for_each(|_| sim.step().unwrap());
        sim.state.qpos
    };
    assert_near("qpos", &run(again), &run(model), 1e-9);
}

#[test]
fn enclosed_objects_are_saved_with_their_search_limits() {
    let text = "<mujoco><option ccd_iterations='7' ccd_tolerance='0.25'/>
      <worldbody><site name='room' size='1'/><body name='b'><freejoint/><geom size='0.1'/></body></worldbody>
      <sensor><insidesite site='room' objtype='body' objname='b' enclosed='true'/></sensor></mujoco>";
    let again = saved("enclosed", &load_str(text).expect("a model"));
    let SensorTarget::Inside { enclosed, .. } = again.sensors[0].target else {
        panic!("{:?}", again.sensors[0].target);
    };
    assert!(enclosed);
    let bounds = (again.options.ccd_iterations, again.options.ccd_tolerance);
    assert_eq!(bounds, (Some(7), Some(0.25)));
}

#[test]
fn an_option_that_mujoco_lacks_comes_back() {
    let text = "<mujoco><custom><text name='clench.contact_model' data='coulomb'/>
        <text name='clench.stiction' data='true'/></custom></mujoco>";
    let model = load_str(text).unwrap();
    let again = saved("coulomb", &model);
    assert_eq!(again.options.contact_model, Some(ContactModel::Coulomb));
    assert_eq!(again.options.stiction, Some(true));
    assert_eq!(again.options, model.options);
}

#[test]
fn controls_that_share_a_range_have_it_again() {
    let text =
        "<mujoco><worldbody><body><joint name='j'/><geom size='1'/></body></worldbody><actuator>
        <dcmotor joint='j' input='vel' ctrlrange='-1 2' resistance='1' motorconst='1'/>
        <dcmotor joint='j' input='vel ff' ctrlrange='-3 4' resistance='1' motorconst='1'/>
        <pid joint='j' input='vel' velrange='-5 6' kp='1'/></actuator></mujoco>";
    let model = load_str(text).expect("a model");
    let again = saved("ranges", &model);
    let ranges = [[-1.0, 2.0], [-3.0, 4.0], [-3.0, 4.0], [-5.0, 6.0]];
    assert_eq!(again.params.actuator_ctrlrange, ranges);
    let mut limited = again.actuators.iter().flat_map(|a| &a.ctrllimited);
    assert!(limited.all(|&is_limited| is_limited));
}

#[test]
fn distances_are_between_two_elements_that_mujoco_accepts() {
    let text =
        "<mujoco><asset><hfield name='h' nrow='2' ncol='2' size='1 1 1 1'/></asset><worldbody>
        <geom name='ground' type='hfield' hfield='h'/><body name='a' mocap='true'/><body name='b'/>
        <body name='ball'><geom name='g' size='1'/></body></worldbody><sensor>
        <distance body1='b' body2='a'/><fromto body1='world' body2='ball'/></sensor></mujoco>";
    let model = load_str(text).expect("a model");
    let text = model.to_mjcf().expect("it can be saved");
    for expected in [
        "<distance body1=\"a\" body2=\"b\"",
        "<fromto body1=\"world\" geom2=\"g\"",
    ] {
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn names_are_written_as_xml_wants_them() {
    let odd = "<mujoco model='a &lt; b &amp; \"c\"'><worldbody><body name='tab&#9;&apos;&#xe9;'><freejoint/><geom size='1'/></body></worldbody></mujoco>";
    let model = load_str(odd).unwrap();
    let again = saved("odd", &model);
    assert_eq!(again.name, "a < b & \"c\"");
    assert_eq!(again.bodies[1].name, "tab\t'é");
}

#[test]
fn elements_that_mjcf_lacks_are_errors() {
    let text = "<mujoco><worldbody><body><joint name='j' type='ball'/><geom size='1'/></body></worldbody></mujoco>";
    let mut model = load_str(text).unwrap();
    model.params.dof_damping[1] = 1.0;
    let error = model.to_mjcf().unwrap_err().to_string();
    assert!(
        error.starts_with("joint \"j\" cannot be written as MJCF"),
        "{error}"
    );
    let mut model = load_str(text).unwrap();
    model.options.constraint_timeconst = Some(0.05);
    let error = model.to_mjcf().unwrap_err().to_string();
    assert!(error.contains("constraint_timeconst"), "{error}");
}
