//! A model as JSON, for `clench inspect --json`. Elements are listed in the model's order; references are indices into
//! these lists.

use clench::Sim;
use clench::collide::ShapeKind;
use clench::rigid::model::{Actuator, JointKind, Model, Transmission};
use serde_json::{Value, json};

/// Returns sizes, elements, ranges and the effective options.
pub(crate) fn describe(sim: &Sim) -> Value {
    let model = sim.model();
    let names = |names: Vec<&String>| json!(names);
    json!({
        "name": model.name,
        "nq": model.nq,
        "nv": model.nv,
        "nu": model.nu(),
        "na": model.na,
        "nsensordata": model.sensors.iter().map(|sensor| sensor.numbers.len()).sum::<usize>(),
        "timestep": sim.params().timestep,
        "integrator": format!("{:?}", model.integrator).to_lowercase(),
        "bodies": bodies(model),
        "joints": joints(model),
        "geoms": geoms(model),
        "sites": list(&model.sites, |site| json!({"name": site.name, "body": site.body})),
        "tendons": names(model.tendons.iter().map(|tendon| &tendon.name).collect()),
        "actuators": list(&model.actuators, |actuator| self::actuator(model, actuator)),
        "sensors": list(&model.sensors, |sensor| json!({
            "name": sensor.name,
            "type": sensor.kind.name(),
            "adr": sensor.numbers.start,
            "dim": sensor.numbers.len(),
        })),
        "equalities": list(&model.equalities, |equality| json!({
            "name": equality.name,
            "type": equality.target.kind(),
            "active": equality.active0,
        })),
        "keyframes": names(model.keyframes.iter().map(|key| &key.name).collect()),
    })
}

fn list<T>(elements: &[T], describe: impl Fn(&T) -> Value) -> Value {
    elements.iter().map(describe).collect()
}

fn bodies(model: &Model) -> Value {
    let bodies = model.bodies.iter().zip(&model.params.body_mass);
    bodies
        .map(|(body, mass)| json!({"name": body.name, "parent": body.parent, "mass": mass}))
        .collect()
}

fn joints(model: &Model) -> Value {
    let joints = model.joints.iter().zip(&model.params.jnt_range);
    let describe = |(joint, range): (&clench::rigid::model::Joint, &[f64; 2])| {
        json!({
            "name": joint.name,
            "type": match joint.kind {
                JointKind::Free => "free",
                JointKind::Ball => "ball",
                JointKind::Slide => "slide",
                JointKind::Hinge => "hinge",
            },
            "body": joint.body,
            "qposadr": joint.qpos,
            "dofadr": joint.dof,
            "range": joint.limited.then_some(range),
        })
    };
    joints.map(describe).collect()
}

fn geoms(model: &Model) -> Value {
    list(&model.geoms, |geom| {
        let shape = match geom.kind {
            ShapeKind::HeightField => "hfield".to_owned(),
            kind => format!("{kind:?}").to_lowercase(),
        };
        json!({"name": geom.name, "type": shape, "body": geom.body, "group": geom.group})
    })
}

fn actuator(model: &Model, actuator: &Actuator) -> Value {
    let (kind, targets) = match actuator.transmission {
        Transmission::Joint(joint) => ("joint", vec![joint]),
        Transmission::JointInParent(joint) => ("jointinparent", vec![joint]),
        Transmission::Tendon(tendon) => ("tendon", vec![tendon]),
        Transmission::Site(site) => ("site", vec![site]),
        Transmission::SiteInFrame(sites) => ("site", sites.to_vec()),
        Transmission::SliderCrank(sites) => ("slidercrank", sites.to_vec()),
        Transmission::Body(body) => ("body", vec![body]),
        Transmission::Rotation(joint) => ("joint", vec![joint]),
        Transmission::RotationInFrame(sites) => ("site", sites.to_vec()),
    };
    let limits = model.params.actuator_ctrlrange[actuator.controls.clone()].iter();
    let limits = limits.zip(&actuator.ctrllimited);
    let ranges: Vec<_> = limits
        .map(|(range, limited)| limited.then_some(range))
        .collect();
    json!({
        "name": actuator.name,
        "transmission": kind,
        "targets": targets,
        "ctrladr": actuator.controls.start,
        "ctrlranges": ranges,
    })
}
