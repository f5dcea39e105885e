//! Compiler, options, equalities, contacts, tendons and keyframes.

use clench_formats::{SaveModel, load_str, read_str};
use clench_math::Vec3;
use clench_rigid::builder::{ConnectAnchor, EqualityKind, InertiaFromGeom, ModelBuilder, WrapSpec};
use clench_rigid::model::Integrator;
use clench_rigid::options::{ContactModel, FrictionCone, RigidOption};
use clench_solver::{ConstraintSolver, Switch};
use std::collections::HashMap;

fn read(sections: &str) -> ModelBuilder {
    match read_str(&format!("<mujoco>{sections}</mujoco>")) {
        Ok(builder) => builder,
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn a_file_without_options_has_the_defaults_of_its_format() {
    let model = read("");
    let options = model.options;
    assert_eq!(
        (options.iterations, options.constraint_timeconst),
        (Some(100), Some(0.0))
    );
    let others = RigidOption::ALL
        .iter()
        .filter(|&&o| options.get(o).is_some());
    assert_eq!(others.count(), 2, "the rest is left to the precision");
    assert_eq!(
        (model.physics.timestep, model.physics.gravity),
        (0.002, [0.0, 0.0, -9.81])
    );
    assert_eq!(model.name, "MuJoCo Model");
}

#[test]
fn options_are_read_and_the_last_word_counts() {
    let model = read(
        "<option timestep='0.01' gravity='1 2 3' integrator='RK4' cone='elliptic' solver='CG' jacobian='dense'
                 iterations='7' tolerance='1e-5' impratio='10' density='1.2' viscosity='0.1' wind='1 0 0'
                 noslip_iterations='3' actuatorgroupdisable='1 3 1'/>
         <option timestep='0.02'/>",
    );
    assert_eq!(
        (model.physics.timestep, model.physics.gravity),
        (0.02, [1.0, 2.0, 3.0])
    );
    assert_eq!(model.physics.integrator, Integrator::Rk4);
    assert_eq!((model.physics.density, model.physics.viscosity), (1.2, 0.1));
    assert_eq!(model.physics.wind, [1.0, 0.0, 0.0]);
    assert_eq!(model.physics.disabled_actuator_groups, [1, 3]);
    let options = model.options;
    assert_eq!(options.constraint_solver, Some(ConstraintSolver::Cg));
    assert_eq!(options.friction_cone, Some(FrictionCone::Elliptic));
    assert_eq!(options.sparse_solve, Some(Switch::Off));
    assert_eq!(
        (options.iterations, options.tolerance),
        (Some(7), Some(1e-5))
    );
    assert_eq!(
        (options.impratio, options.noslip_iterations),
        (Some(10.0), Some(3))
    );
}

#[test]
fn an_option_that_mujoco_lacks_is_a_text_that_it_ignores() {
    let text = |data: &str| {
        format!(
            "<custom><text name='clench.contact_model' data='{data}'/><text name='own' data='coulomb'/></custom>"
        )
    };
    let model = read(&text("coulomb"));
    assert_eq!(model.options.contact_model, Some(ContactModel::Coulomb));
    assert_eq!(
        model.custom.texts,
        [("own".to_owned(), "coulomb".to_owned())]
    );
    let error = read_str(&format!("<mujoco>{}</mujoco>", text("sticky")))
        .err()
        .unwrap();
    assert!(
        error
            .to_string()
            .contains("clench.contact_model is \"sticky\", but must be convex or coulomb"),
        "{error}"
    );
    let twice = format!("<mujoco>{}{}</mujoco>", text("convex"), text("coulomb"));
    let error = read_str(&twice).err().unwrap().to_string();
    assert!(error.contains("the name is repeated"), "{error}");
}

#[test]
fn a_replaced_solver_is_reported_once() {
    let model = read("<option solver='PGS'/><option/>");
    assert_eq!(
        model.options.constraint_solver,
        Some(ConstraintSolver::Newton)
    );
    assert_eq!(model.notes.len(), 1);
    assert!(model.notes[0].contains("PGS"));
    assert!(
        read("<option solver='PGS'/><option solver='CG'/>")
            .notes
            .is_empty()
    );
}

#[test]
fn flags_switch_features_and_solver_options() {
    let model = read(
        "<option><flag contact='disable' gravity='disable' warmstart='disable' island='disable'
                       constraint='disable' energy='enable' multiccd='disable' sleep='disable'/></option>
         <option><flag contact='enable'/></option>",
    );
    let flags = model.physics.flags;
    assert!(flags.contact && !flags.gravity && !flags.multiccd);
    assert!(read("").physics.flags.multiccd);
    assert_eq!(model.options.warmstart, Some(false));
    assert_eq!(model.options.islands, Some(Switch::Off));
    assert_eq!(model.options.disable_constraint, Some(true));
}

/// MuJoCo resets a simulation that diverges unless a file disables it; here a file must enable it.
#[test]
fn a_file_sets_autoreset() {
    let flag = |value: &str| read(&format!("<option><flag autoreset='{value}'/></option>"));
    assert_eq!(flag("enable").options.autoreset, Some(true));
    assert_eq!(flag("disable").options.autoreset, Some(false));
    assert_eq!(read("").options.autoreset, None);
}

#[test]
fn contact_override_needs_its_flag() {
    let values = "o_margin='0.1' o_solref='0.5' o_friction='2'";
    assert!(
        read(&format!("<option {values}/>"))
            .physics
            .contact_override
            .is_none()
    );
    let model = read(&format!(
        "<option {values}><flag override='enable'/></option>"
    ));
    let contact = model.physics.contact_override.unwrap();
    assert_eq!((contact.margin, contact.solref), (0.1, [0.5, 1.0]));
    assert_eq!(contact.friction, [2.0, 1.0, 0.005, 0.0001, 0.0001]);
}

#[test]
fn compiler_settings_are_read_and_the_last_word_counts() {
    let compiler = read(
        "<compiler autolimits='false' boundmass='1' boundinertia='2' settotalmass='3' balanceinertia='true'
                   inertiafromgeom='true' inertiagrouprange='1 2' alignfree='true' coordinate='local'
                   fusestatic='false'/>
         <compiler boundmass='4'/>",
    )
    .compiler;
    assert!(!compiler.autolimits && compiler.balanceinertia && compiler.alignfree);
    assert_eq!((compiler.boundmass, compiler.boundinertia), (4.0, 2.0));
    assert_eq!(compiler.settotalmass, Some(3.0));
    assert_eq!(compiler.inertiafromgeom, InertiaFromGeom::Always);
    assert_eq!(compiler.inertiagrouprange, [1, 2]);
    assert_eq!(
        read("<compiler settotalmass='-1'/>").compiler.settotalmass,
        None
    );
}

fn equality(element: &str) -> EqualityKind {
    read(&format!("<equality>{element}</equality>")).equalities[0]
        .kind
        .clone()
}

#[test]
fn connects_hold_bodies_or_sites() {
    let bodies = ConnectAnchor::Bodies {
        body1: "a".into(),
        body2: String::new(),
        anchor: Vec3::new(1.0, 2.0, 3.0),
    };
    assert_eq!(
        equality("<connect body1='a' anchor='1 2 3'/>"),
        EqualityKind::Connect(bodies)
    );
    let sites = ConnectAnchor::Sites {
        site1: "s".into(),
        site2: "t".into(),
    };
    assert_eq!(
        equality("<connect site1='s' site2='t'/>"),
        EqualityKind::Connect(sites)
    );
}

#[test]
fn a_weld_without_a_rotation_keeps_the_initial_pose() {
    for relpose in ["", "relpose='1 2 3 0 0 0 0'"] {
        let EqualityKind::Weld {
            relpose,
            torquescale,
            ..
        } = equality(&format!("<weld body1='a' {relpose}/>"))
        else {
            panic!("a weld was written");
        };
        assert_eq!((relpose, torquescale), (None, 1.0));
    }
    let EqualityKind::Weld {
        anchor,
        relpose,
        torquescale,
    } = equality(
        "<weld body1='a' body2='b' anchor='1 1 1' relpose='1 2 3 2 0 0 0' torquescale='5'/>",
    )
    else {
        panic!("a weld was written");
    };
    let (pos, quat) = relpose.unwrap();
    assert_eq!(
        (pos.to_array(), quat.to_array()),
        ([1.0, 2.0, 3.0], [1.0, 0.0, 0.0, 0.0])
    );
    assert_eq!(torquescale, 5.0);
    assert!(matches!(anchor, ConnectAnchor::Bodies { body2, .. } if body2 == "b"));
}

#[test]
fn couplings_start_as_the_identity() {
    let EqualityKind::Joint {
        joint2, polycoef, ..
    } = equality("<joint joint1='a' joint2='b'/>")
    else {
        panic!("a joint equality was written");
    };
    assert_eq!(
        (joint2.as_deref(), polycoef),
        (Some("b"), [0.0, 1.0, 0.0, 0.0, 0.0])
    );
    let EqualityKind::Tendon {
        tendon2, polycoef, ..
    } = equality("<tendon tendon1='a' polycoef='2'/>")
    else {
        panic!("a tendon equality was written");
    };
    assert_eq!((tendon2, polycoef), (None, [2.0, 1.0, 0.0, 0.0, 0.0]));
}

#[test]
fn pairs_have_defaults_of_their_own() {
    let model = read(
        "<contact>
           <pair geom1='a' geom2='b'/>
           <pair geom1='a' geom2='c' condim='1' friction='2 3' solreffriction='0.3' margin='0.1'/>
           <exclude name='e' body1='x' body2='y'/>
         </contact>",
    );
    let [plain, rich] = &model.pairs[..] else {
        panic!("two pairs were written");
    };
    assert_eq!(
        (plain.condim, plain.margin, plain.gap),
        (Some(3), Some(0.0), Some(0.0))
    );
    assert_eq!(plain.friction, Some([1.0, 1.0, 0.005, 0.0001, 0.0001]));
    assert_eq!(plain.solreffriction, None);
    assert_eq!(rich.friction, Some([2.0, 3.0, 0.005, 0.0001, 0.0001]));
    assert_eq!(
        (rich.condim, rich.solreffriction),
        (Some(1), Some([0.3, 0.0]))
    );
    let exclude = &model.excludes[0];
    assert_eq!((exclude.body1.as_str(), exclude.body2.as_str()), ("x", "y"));
}

#[test]
fn a_saved_exclude_has_its_name() {
    let body = |name: &str| format!("<body name='{name}'><joint/><geom size='1'/></body>");
    let bodies = ["x", "y", "z"].map(body).concat();
    let excludes = "<exclude name='own' body1='y' body2='x'/><exclude body1='y' body2='z'/>";
    let text =
        format!("<mujoco><worldbody>{bodies}</worldbody><contact>{excludes}</contact></mujoco>");
    let model = load_str(&text).expect("a model");
    let saved = load_str(&model.to_mjcf().expect("MJCF")).expect("the saved model");
    assert_eq!(saved.excludes, model.excludes);
    let named = HashMap::from([((1, 2), "own".to_owned())]);
    assert_eq!(
        (&model.exclude_names, &saved.exclude_names),
        (&named, &named)
    );
}

#[test]
fn fixed_tendons_sum_joints() {
    let model = read(
        "<tendon><fixed name='t' range='0 1' springlength='-1' stiffness='2 0 0'>
           <joint joint='a' coef='2'/><joint joint='b' coef='-1'/>
         </fixed></tendon>",
    );
    let tendon = &model.tendons[0];
    let joint = |joint: &str, coef| WrapSpec::Joint {
        joint: joint.to_owned(),
        coef,
    };
    assert_eq!(tendon.path, [joint("a", 2.0), joint("b", -1.0)]);
    assert_eq!(
        (tendon.springlength, tendon.stiffness),
        (None, [2.0, 0.0, 0.0])
    );
    assert_eq!((tendon.range, tendon.limited), ([0.0, 1.0], None));
}

#[test]
fn spatial_tendons_pass_sites_geoms_and_pulleys() {
    let model = read(
        "<default><tendon armature='0.1' width='1'/></default>
         <tendon><spatial name='t' stiffness='1 2' damping='0 0 3' springlength='0.1 0.2' springyield='0.3' rgba='1 0 0 1'>
           <pulley divisor='2'/><site site='a'/><geom geom='g' sidesite='s'/><site site='b'/>
           <pulley divisor='0.5'/><site site='a'/><geom geom='h'/><site site='c'/>
         </spatial></tendon>",
    );
    let tendon = &model.tendons[0];
    let site = |name: &str| WrapSpec::Site(name.into());
    let geom = |name: &str, side: Option<&str>| WrapSpec::Geom {
        geom: name.into(),
        side: side.map(Into::into),
    };
    let path = [
        WrapSpec::Pulley(2.0),
        site("a"),
        geom("g", Some("s")),
        site("b"),
        WrapSpec::Pulley(0.5),
        site("a"),
        geom("h", None),
        site("c"),
    ];
    assert_eq!(tendon.path, path);
    assert_eq!(
        (tendon.stiffness, tendon.damping),
        ([1.0, 2.0, 0.0], [0.0, 0.0, 3.0])
    );
    assert_eq!(
        (tendon.armature, tendon.springlength, tendon.springyield),
        (0.1, Some([0.1, 0.2]), 0.3)
    );
}

#[test]
fn keyframes_are_read_and_filled_up() {
    let model = read(
        "<size nkey='3'/>
         <keyframe><key name='home' time='2' qpos='1 2' ctrl='3' mpos='0 0 1' mquat='1 0 0 0' plastic='4 5'/></keyframe>",
    );
    assert_eq!(model.keyframes.len(), 3);
    let home = &model.keyframes[0];
    assert_eq!((home.name.as_str(), home.time), ("home", 2.0));
    assert_eq!(
        (home.qpos.as_deref(), home.qvel.as_deref()),
        (Some(&[1.0, 2.0][..]), None)
    );
    assert_eq!(home.mocap_pos.as_deref(), Some(&[0.0, 0.0, 1.0][..]));
    assert_eq!(home.plastic.as_deref(), Some(&[4.0, 5.0][..]));
}
