//! Freeing of the base of a robot whose file fixes it to the world.

use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{JointSpec, ModelBuilder};
use clench_dynamics::model::JointKind;

/// The name of the joint, or `floating_base_1` and so on if the name is taken.
const NAME: &str = "floating_base";

/// Adds a free joint to the link fixed to the world. An existing one is retained.
///
/// # Errors
/// Returns an error if there is no such link, several, or one that another joint moves.
pub(super) fn float(root: &Element, builder: &mut ModelBuilder) -> Result<(), LoadError> {
    let on_world = |&body: &usize| builder.bodies[body].parent == ModelBuilder::WORLD;
    let bases = Vec::from_iter((1..builder.bodies.len()).filter(on_world));
    let &[base] = &bases[..] else {
        let names = bases.iter().map(|&body| builder.bodies[body].name.as_str());
        return Err(root.error(match bases.is_empty() {
            true => "there is no link other than the world to which a free joint could be added"
                .to_owned(),
            false => format!(
                "only one link can float, but several are fixed to the world: {}",
                Vec::from_iter(names).join(", ")
            ),
        }));
    };
    let body = &builder.bodies[base];
    match body.joints.first() {
        Some(joint) if joint.kind == JointKind::Free => return Ok(()),
        Some(joint) => {
            return Err(root.error(format!(
                "the link \"{}\" cannot float: the joint \"{}\" already moves it relative to the world",
                body.name, joint.name
            )));
        }
        None => {}
    }
    let is_used = |name: &str| {
        let mut joints = builder.bodies.iter().flat_map(|body| &body.joints);
        joints.any(|joint| joint.name == name)
    };
    let mut name = NAME.to_owned();
    for number in 1.. {
        if !is_used(&name) {
            break;
        }
        name = format!("{NAME}_{number}");
    }
    let joint = JointSpec {
        origin: body.origin.clone(),
        ..JointSpec::free(name)
    };
    builder.bodies[base].joints.push(joint);
    Ok(())
}
