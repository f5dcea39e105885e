//! Joints and their degrees of freedom.

use super::element::{Element, resolve_limited, resolve_range};
use super::model_builder::ModelBuilder;
use super::{BuildError, DOF_NUMBERS, JOINT_NUMBERS, JointSpec, element_number};
use clench_dynamics::model::{Dof, Joint, JointKind, Model};
use clench_math::{Quat, Vec3};
use std::sync::Arc;

/// The minimum length of an axis (its square is MuJoCo's `mjEPS`).
const MIN_AXIS_LENGTH: f64 = 1e-7;

/// Adds a joint of body `b`, whose pose in its parent is `pose`.
///
/// # Errors
/// Returns an error if the axis is zero, a range is not ascending, a spring-damper is not positive, or the spring of a
/// free joint yields.
pub(super) fn add(
    builder: &ModelBuilder,
    spec: &JointSpec,
    b: usize,
    pose: (Vec3<f64>, Quat<f64>),
    model: &mut Model,
) -> Result<(), BuildError> {
    if spec.springdamper != [0.0; 2] && spec.springdamper.iter().any(|&s| s <= 0.0) {
        return Err(spec.error("springdamper must be two positive numbers"));
    }
    let autolimits = builder.compiler.autolimits;
    let (limited, actfrclimited) = limits(spec, autolimits)?;
    let plastic = plastic(spec, model)?;
    let joint = model.joints.len();
    model.joints.push(Joint {
        name: spec.name.clone(),
        kind: spec.kind,
        body: b,
        qpos: model.nq,
        dof: model.nv,
        plastic,
        limited,
        actfrclimited,
        actgravcomp: spec.actuatorgravcomp,
        reflecting: Vec::new(),
        group: spec.group,
        user: Arc::clone(&spec.user),
        origin: spec.origin.clone(),
    });
    push_params(spec, placement(spec)?, pose, model);
    for _ in 0..spec.kind.nv() {
        add_dof(spec, b, joint, model);
    }
    model.nq += spec.kind.nq();
    Ok(())
}

/// Allocates the rest position of a yielding spring in the state: a position, or the orientation of a ball joint.
fn plastic(spec: &JointSpec, model: &mut Model) -> Result<Option<usize>, BuildError> {
    if spec.springyield == 0.0 {
        return Ok(None);
    }
    if spec.kind == JointKind::Free {
        return Err(spec.error("springyield has no meaning for a free joint"));
    }
    let start = model.nplastic;
    model.nplastic += spec.kind.nq();
    Ok(Some(start))
}

/// Resolves whether the range limits positions, and actuator forces. Free joints are never limited; ball joints by
/// their angle, but not in force.
fn limits(spec: &JointSpec, autolimits: bool) -> Result<(bool, bool), BuildError> {
    let force = |spec: &JointSpec| {
        let (said, range) = (spec.actuatorfrclimited, spec.actuatorfrcrange);
        resolve_range(spec, "actuatorfrc", said, range, autolimits)
    };
    match spec.kind {
        JointKind::Free => Ok((false, false)),
        JointKind::Ball => {
            let limited = resolve_limited(spec, "", spec.limited, spec.range, autolimits)?;
            if limited && spec.range[0] != 0.0 {
                return Err(spec.error(format!(
                    "the range of a ball joint starts at 0, not at {}",
                    spec.range[0]
                )));
            }
            Ok((limited, false))
        }
        JointKind::Slide | JointKind::Hinge => {
            let limited = resolve_range(spec, "", spec.limited, spec.range, autolimits)?;
            Ok((limited, force(spec)?))
        }
    }
}

/// Returns the anchor and unit axis in the body frame.
fn placement(spec: &JointSpec) -> Result<(Vec3<f64>, Vec3<f64>), BuildError> {
    let z = Vec3::new(0.0, 0.0, 1.0);
    match spec.kind {
        JointKind::Free => Ok((Vec3::ZERO, z)),
        JointKind::Ball => Ok((spec.pos, z)),
        JointKind::Slide | JointKind::Hinge => match spec.axis.normalize() {
            (_, length) if length < MIN_AXIS_LENGTH => Err(spec.error("axis is zero")),
            (axis, _) => Ok((spec.pos, axis)),
        },
    }
}

fn push_params(
    spec: &JointSpec,
    (pos, axis): (Vec3<f64>, Vec3<f64>),
    (body_pos, body_quat): (Vec3<f64>, Quat<f64>),
    model: &mut Model,
) {
    let p = &mut model.params;
    p.jnt_pos.push(pos);
    p.jnt_axis.push(axis);
    let [linear, higher @ ..] = spec.stiffness;
    p.jnt_stiffness.push(linear);
    p.jnt_stiffnesspoly.push(higher);
    p.jnt_range.push(spec.range);
    p.jnt_actfrcrange.push(spec.actuatorfrcrange);
    p.jnt_solref.push(spec.solref_limit);
    p.jnt_solimp.push(spec.solimp_limit);
    element_number::push(&JOINT_NUMBERS, &spec.joint_numbers(), p);
    let start = p.qpos0.len();
    match spec.kind {
        JointKind::Free => {
            p.qpos0.extend(body_pos.to_array());
            p.qpos0.extend(body_quat.to_array());
        }
        JointKind::Ball => p.qpos0.extend(Quat::<f64>::IDENTITY.to_array()),
        JointKind::Slide | JointKind::Hinge => p.qpos0.push(spec.reference),
    }
    match spec.kind {
        JointKind::Free | JointKind::Ball => p.qpos_spring.extend_from_slice(&p.qpos0[start..]),
        JointKind::Slide | JointKind::Hinge => p.qpos_spring.push(spec.springref),
    }
}

fn add_dof(spec: &JointSpec, b: usize, joint: usize, model: &mut Model) {
    let body = &mut model.bodies[b];
    model.dofs.push(Dof {
        body: b,
        joint,
        parent: body.last_dof,
        frictionloss: spec.frictionloss > 0.0,
    });
    body.last_dof = Some(model.nv);
    model.nv += 1;
    let p = &mut model.params;
    let [linear, higher @ ..] = spec.damping;
    p.dof_damping.push(linear);
    p.dof_dampingpoly.push(higher);
    p.dof_solref.push(spec.solref_friction);
    p.dof_solimp.push(spec.solimp_friction);
    element_number::push(&DOF_NUMBERS, &spec.dof_numbers(), p);
}
