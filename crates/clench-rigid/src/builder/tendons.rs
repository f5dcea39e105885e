//! Fixed tendons.

use super::element::{Element, resolve_range};
use super::resolve::AllNames;
use super::{BuildError, ModelBuilder, TendonSpec};
use crate::model::{JointKind, Model, Tendon};

/// Adds all tendons.
///
/// # Errors
/// A tendon of no joint, of one joint twice, or of a joint without a scalar position; ranges that do not rise.
pub(super) fn add_all(
    builder: &ModelBuilder,
    names: &AllNames,
    model: &mut Model,
) -> Result<(), BuildError> {
    for spec in &builder.tendons {
        let joints = joints(spec, names, model)?;
        let autolimits = builder.compiler.autolimits;
        let limited = resolve_range(spec, "", spec.limited, spec.range, autolimits)?;
        let (said, range) = (spec.actuatorfrclimited, spec.actuatorfrcrange);
        let actfrclimited = resolve_range(spec, "actuatorfrc", said, range, autolimits)?;
        if actfrclimited && (range[0] > 0.0 || range[1] < 0.0) {
            return Err(spec.error("actuatorfrcrange must contain 0"));
        }
        if spec.springlength.is_some_and(|[low, high]| low > high) {
            return Err(spec.error("springlength must not fall"));
        }
        let start = model.params.wrap_coef.len();
        let dofs = joints.iter().map(|&j| model.joints[j].dof as u32);
        model.tendon_dofs.push(dofs);
        model.tendons.push(Tendon {
            name: spec.name.clone(),
            coefs: start..start + joints.len(),
            joints,
            limited,
            actfrclimited,
            frictionloss: spec.frictionloss > 0.0,
        });
        push_params(spec, model);
    }
    Ok(())
}

fn joints(spec: &TendonSpec, names: &AllNames, model: &Model) -> Result<Vec<usize>, BuildError> {
    if spec.terms.is_empty() {
        return Err(spec.error("has no joint"));
    }
    let mut joints = Vec::with_capacity(spec.terms.len());
    for (name, _) in &spec.terms {
        let joint = names.joints.find(name, spec)?;
        if joints.contains(&joint) {
            return Err(spec.error(format!("has the joint \"{name}\" twice")));
        }
        require_scalar(spec, name, joint, model)?;
        joints.push(joint);
    }
    Ok(joints)
}

/// A joint whose position is one number.
///
/// # Errors
/// A ball or free joint.
pub(super) fn require_scalar(
    user: &impl Element,
    name: &str,
    joint: usize,
    model: &Model,
) -> Result<(), BuildError> {
    match model.joints[joint].kind {
        JointKind::Slide | JointKind::Hinge => Ok(()),
        JointKind::Ball | JointKind::Free => {
            Err(user.error(format!("the joint \"{name}\" must be a slide or a hinge")))
        }
    }
}

fn push_params(spec: &TendonSpec, model: &mut Model) {
    let tendon = &model.tendons[model.tendons.len() - 1];
    let p = &mut model.params;
    p.wrap_coef.extend(spec.terms.iter().map(|&(_, coef)| coef));
    let length = |qpos: &[f64]| {
        let terms = tendon.joints.iter().zip(&spec.terms);
        terms
            .map(|(&j, (_, coef))| coef * qpos[model.joints[j].qpos])
            .sum::<f64>()
    };
    let rest = length(&p.qpos_spring);
    p.tendon_length0.push(length(&p.qpos0));
    p.tendon_lengthspring
        .push(spec.springlength.unwrap_or([rest; 2]));
    p.tendon_stiffness.push(spec.stiffness);
    p.tendon_damping.push(spec.damping);
    p.tendon_range.push(spec.range);
    p.tendon_margin.push(spec.margin);
    p.tendon_actfrcrange.push(spec.actuatorfrcrange);
    p.tendon_frictionloss.push(spec.frictionloss);
    p.tendon_solref_lim.push(spec.solref_limit);
    p.tendon_solimp_lim.push(spec.solimp_limit);
    p.tendon_solref_fri.push(spec.solref_friction);
    p.tendon_solimp_fri.push(spec.solimp_friction);
}
