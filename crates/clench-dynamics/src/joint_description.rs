//! Descriptions of joints for error messages: name, body and source location.

use crate::model::{Integrator, Joint, Model};
use crate::singular::first_bad_pivot;
use crate::state::{FIELDS, Size};
use crate::workspace::Workspace;
use clench_math::{Real, Scalar};
use clench_solver::{Tree, TreeMatrix};
use std::sync::Arc;

/// Describes the joint of number `index` of `field`, in the order of the model's coordinates or dofs. Returns `None`
/// for fields that do not belong to joints.
pub fn joint_of(model: &Model, field: &str, index: usize) -> Option<Arc<str>> {
    let of_state = FIELDS.iter().find(|known| known.name == field);
    let size = match (of_state, field) {
        (Some(known), _) => known.size,
        (None, "qacc" | "qfrc_constraint") => Size::Dofs,
        _ => return None,
    };
    let range = |joint: &Joint| size.of_joint(joint);
    let mut joints = model.joints.iter();
    let found = joints.find(|joint| range(joint).is_some_and(|range| range.contains(&index)));
    found.map(|joint| describe(model, joint))
}

/// Describes a joint for an error message: `joint "elbow" of body "arm" (arm.xml:12)`.
fn describe(model: &Model, joint: &Joint) -> Arc<str> {
    let body = &model.bodies[joint.body];
    let kind = format!("{:?}", joint.kind).to_lowercase();
    let mut text = match joint.name.as_str() {
        "" => format!("the {kind} joint of "),
        name => format!("joint \"{name}\" of "),
    };
    text += &match body.name.as_str() {
        "" => format!("body {}", joint.body),
        name => format!("body \"{name}\""),
    };
    if let Some(origin) = joint.origin.as_ref().or(body.origin.as_ref()) {
        text += &format!(" ({origin})");
    }
    text.into()
}

/// Returns the joint where the mass matrix of a lane, or the matrix of the implicit integrator, is not positive
/// definite.
pub fn massless<T: Real>(model: &Model, ws: &Workspace<T>, lane: usize) -> Option<Arc<str>> {
    let implicit = || match model.integrator {
        Integrator::Euler | Integrator::ImplicitFast | Integrator::Implicit => {
            bad_pivot(&model.tree, &ws.integration.matrix, lane)
        }
        Integrator::Discrete => bad_pivot(&model.tree, &ws.problem.mass, lane),
        Integrator::Rk4 => None,
    };
    let dof = bad_pivot(&model.tree, ws.mass(), lane).or_else(implicit)?;
    joint_of(model, "qvel", dof)
}

/// Returns the dof where the matrix of a lane is not positive definite.
fn bad_pivot<T: Real>(tree: &Tree, matrix: &TreeMatrix<T>, lane: usize) -> Option<usize> {
    let values = matrix.values.iter().map(|x| x.lane(lane).to_f64());
    first_bad_pivot(tree, values.collect())
}
