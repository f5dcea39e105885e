//! The common layout of several models, and what may not differ.

use crate::scenes::{models, scene};
use clench::rigid::model::FrameObject;
use clench::{
    Anchors, Axes, Batch, BatchOptions, Ik, IkOptions, IkStatus, IkTarget, IkTask, Model,
    QueryInput, RayFilter, RigidOptions, SimError, load_str,
};
use std::sync::Arc;

fn load(text: &str) -> Arc<Model> {
    Arc::new(load_str(text).expect("valid"))
}

fn error(first: &str, second: &str) -> String {
    let models = [load(first), load(second)];
    let batch = Batch::<f64>::of_models(&models, &[0, 1], BatchOptions::default());
    batch.expect_err("models that differ").to_string()
}

#[test]
fn geoms_of_one_class_share_a_place() {
    let models = models();
    let batch = Batch::<f64>::of_models(&models, &[0; 4], BatchOptions::default()).unwrap();
    let layout = batch.model();
    // The floor, two boxes and a height field; palm and fingers; box, sphere, mesh and so on.
    let object = layout.bodies.last().expect("a body").geoms.clone();
    assert!(object.len() <= 9, "{} geoms of objects", object.len());
    assert_eq!(layout.bodies[0].geoms.len(), 4);
    for (model, own) in models.iter().enumerate() {
        let geoms = batch.geoms_of(model).expect("exists");
        assert_eq!(geoms.len(), own.geoms.len());
        assert!(
            geoms.is_sorted_by(|a, b| a < b),
            "the order of model {model} changed"
        );
        for (geom, &slot) in own.geoms.iter().zip(&geoms) {
            assert_eq!(geom.kind, layout.geoms[slot].kind);
            assert_eq!(geom.body, layout.geoms[slot].body);
        }
    }
    // Equal meshes of different files are one; those that no geom uses have no hull.
    let hulls = layout.meshes.iter().filter(|mesh| mesh.hull.is_some());
    assert_eq!(hulls.count(), 3);
}

#[test]
fn errors_name_both_models_and_the_element() {
    let geoms = r#"<geom type="sphere" size=".1"/>"#;
    let first = scene("first", geoms, "");
    let second = scene("second", geoms, "");
    for (from, to, expected) in [
        (
            "name=\"turn\" type=\"hinge\"",
            "name=\"twist\" type=\"hinge\"",
            "name of joint 1, \"turn\" in one",
        ),
        (
            "type=\"hinge\"",
            "type=\"slide\" armature=\"1\"",
            "kind of joint 1, \"turn\"",
        ),
        ("range=\"-.3 .3\"", "", "limited of joint 0, \"lift\""),
        (
            "<motor name=\"turn\" joint=\"turn\" gear=\".2\"/>",
            "",
            "2 and 1 of kind actuator",
        ),
        (
            "gear=\".2\"",
            "gear=\".2\" forcelimited=\"true\" forcerange=\"-1 1\"",
            "forcelimited of actuator 1, \"turn\"",
        ),
        (
            "reduce=\"mindist\"",
            "reduce=\"maxforce\"",
            "target of sensor 3, \"hits\"",
        ),
        (
            "<worldbody>",
            "<option integrator=\"RK4\"/><worldbody>",
            "their integrator",
        ),
        (
            "<worldbody>",
            "<option iterations=\"7\"/><worldbody>",
            "their options",
        ),
        ("<worldbody>", "<worldbody><body/>", "3 and 4 bodies"),
    ] {
        let changed = second.replace(from, to);
        let changed = match to.contains("twist") {
            true => changed.replace("joint=\"turn\"", "joint=\"twist\""),
            false => changed,
        };
        assert_ne!(changed, second, "{from} is not in the scene");
        let error = error(&first, &changed);
        assert!(error.contains(expected), "{error}");
        assert!(
            error.contains("\"first\"") && error.contains("\"second\""),
            "{error}"
        );
    }
}

#[test]
fn sensors_of_distances_need_the_same_geoms() {
    let sensor =
        r#"<sensor><distance name="gap" body1="hand" body2="object body" cutoff="1"/></sensor>"#;
    let with = |geoms: &str| {
        scene("object body", geoms, "").replace("</mujoco>", &format!("{sensor}</mujoco>"))
    };
    let (ball, cube) = (
        r#"<geom type="sphere" size=".1"/>"#,
        r#"<geom type="box" size=".1 .1 .1"/>"#,
    );
    let mesh = |name: &str| format!(r#"<geom type="mesh" mesh="{name}" mass="1"/>"#);
    for (first, second) in [
        (ball.to_owned(), cube.to_owned()),
        (format!("{ball}{cube}{ball}"), format!("{ball}{ball}")),
        (mesh("wedge"), mesh("octahedron")),
    ] {
        let error = error(&with(&first), &with(&second));
        assert!(error.contains("\"gap\""), "{error}");
    }
    let first = with(ball);
    let models = [
        load(&first),
        load(&with(r#"<geom type="sphere" size=".2"/>"#)),
    ];
    assert!(Batch::<f64>::of_models(&models, &[0, 1], BatchOptions::default()).is_ok());
}

#[test]
fn no_model_and_stiction_are_errors() {
    let none = Batch::<f64>::of_models(&[], &[], BatchOptions::default());
    assert_eq!(none.err(), Some(SimError::NoModel));
    let models = models();
    assert!(Batch::<f64>::of_models(&models, &[0, 99], BatchOptions::default()).is_err());
    let options = BatchOptions {
        options: RigidOptions::new().stiction(true),
        ..BatchOptions::default()
    };
    let refused = Batch::<f64>::of_models(&models, &[0, 1], options).err();
    assert_eq!(refused, Some(SimError::OneModel("the option stiction")));
}

#[test]
fn queries_have_no_answer_where_a_model_lacks_the_geom() {
    let world = |geoms: &str, terrain: &str| {
        load(&format!(
            "<mujoco><asset><hfield name='hills' nrow='2' ncol='2' size='1 1 .1 .1' elevation='0 1 1 0'/></asset>
               <worldbody>{terrain}<body><joint name='turn' axis='0 1 0'/>{geoms}</body></worldbody></mujoco>"
        ))
    };
    let models = [
        world("<geom size='.1' pos='.3 0 0'/>", ""),
        world(
            "<geom type='box' size='.1 .1 .1' pos='.2 0 0'/>",
            "<geom type='hfield' hfield='hills'/>",
        ),
    ];
    let mut batch = Batch::<f64>::of_models(&models, &[0, 1, 0], BatchOptions::default())
        .expect("the same joints");
    let places = batch.geoms_of(1).expect("a model");
    let [terrain, cube] = [0, 1].map(|own| places[own]);
    let object = FrameObject::Geom(cube);
    let some = QueryInput::Shared(&[0.1, 0.1, 5.0, 0.0, 0.0, -1.0][..]);
    let at = QueryInput::Shared(&[0.1, 0.1][..]);
    let filter = RayFilter::default();
    let answers = [
        batch.jacobian(Anchors::Object(object)),
        batch.jacobian_rate(Anchors::Object(object)),
        batch.velocity(object, Axes::World),
        batch.acceleration(object, Axes::World),
        batch.rays(some, Some(object), &filter),
        batch.heights(terrain, at, None),
    ];
    for (query, rows) in answers.into_iter().enumerate() {
        let rows = rows.expect("a geom of the layout");
        for env in 0..3 {
            let known = rows.row(env).iter().all(|number| !number.is_nan());
            assert_eq!(known, env == 1, "query {query}, environment {env}");
        }
    }
    let everywhere = batch.rays(some, None, &filter).expect("valid");
    assert!(everywhere.as_slice().iter().all(|number| !number.is_nan()));
    let task = IkTask::new(batch.model(), IkTarget::Position(object), 1.0);
    let ik = Ik::new(batch.model(), vec![task], IkOptions::default()).expect("valid");
    let goal = QueryInput::Shared(&[0.0, 0.0, 0.2][..]);
    let found = batch.ik(&ik, goal, None).expect("valid");
    let statuses = found.iter().map(|solution| solution.status);
    let expected = [IkStatus::NonFinite, IkStatus::Reached, IkStatus::NonFinite];
    assert_eq!(Vec::from_iter(statuses), expected);
    assert!(found[0].qpos[0].is_nan() && found[0].errors[0].is_nan());
}
