//! Quantities of the whole model at qpos0: total masses, [`Constants`], and parameters given by time constants and
//! damping ratios.

use super::BuildError;
use super::bodies::{is_null, is_null_position};
use super::check::describe;
use super::model_builder::ModelBuilder;
use clench_dynamics::constants::{Constants, MIN_INERTIA, SingularMass};
use clench_dynamics::dynamics::tendon;
use clench_dynamics::model::{JointKind, Model, ParamField};
use clench_dynamics::stages::Positions;

/// Components of a unit axis below this count as zero (MuJoCo's `mjEPS`).
const ALIGNED: f64 = 1e-14;

/// Scales masses to the author's total, and sums those of subtrees.
pub(super) fn masses(builder: &ModelBuilder, model: &mut Model) {
    let p = &mut model.params;
    if let Some(wanted) = builder.compiler.settotalmass {
        let total: f64 = p.body_mass.iter().sum();
        let scale = f64::max(MIN_INERTIA, wanted / f64::max(MIN_INERTIA, total));
        for (mass, inertia) in p.body_mass.iter_mut().zip(&mut p.body_inertia) {
            *mass *= scale;
            *inertia = *inertia * scale;
        }
    }
    let mut params = std::mem::take(&mut model.params);
    params.derive(model, ParamField::body_mass);
    model.params = params;
}

/// Checks that every body with joints has a mass and an inertia, its own or that of a body fixed to it.
///
/// # Errors
/// Returns an error if a body lacks either; `order` are the author's indices.
pub(super) fn require_inertia(model: &Model, order: &[usize]) -> Result<(), BuildError> {
    let p = &model.params;
    let heavy = |b: usize| {
        p.body_mass[b] >= MIN_INERTIA
            && p.body_inertia[b]
                .to_array()
                .iter()
                .all(|&i| i >= MIN_INERTIA)
    };
    let mut carries: Vec<bool> = (0..model.nbody()).map(heavy).collect();
    for (b, body) in model.bodies.iter().enumerate().skip(1).rev() {
        if body.joints.is_empty() {
            carries[body.parent] |= carries[b];
        } else if !carries[b] {
            let mut error = BuildError::new(
                describe(&body.name, order[b]),
                format!(
                    "a moving body must have a mass and principal moments of at least {MIN_INERTIA:e}, but has mass {:?} and \
                     moments {:?}",
                    p.body_mass[b],
                    p.body_inertia[b].to_array()
                ),
            );
            error.origin = body.origin.clone();
            return Err(error);
        }
    }
    Ok(())
}

/// Sets the constants of the initial configuration, and derived parameters: springs from `springdamper`, servo damping
/// from `dampratio`.
///
/// # Errors
/// Returns an error if the mass matrix is not positive definite.
pub(super) fn derive(
    builder: &ModelBuilder,
    order: &[usize],
    springdampers: &[[f64; 2]],
    pose0: Positions<f64>,
    model: &mut Model,
) -> Result<(), BuildError> {
    let with_inertia = bodies_of_tendons_with_inertia(model, &pose0);
    for (b, &old) in order.iter().enumerate() {
        let may = !builder.bodies[old].never_simple && !with_inertia[b];
        model.bodies[b].diagonal_inertia = may && moves_independently(model, b);
    }
    let constants = Constants::new(model, &model.params, pose0);
    let mut constants = constants.map_err(|found| singular(model, found))?;
    let mut params = std::mem::take(&mut model.params);
    let set = constants.set(model, &mut params);
    model.params = params;
    set.map_err(|found| singular(model, found))?;
    spring_dampers(springdampers, model);
    servo_damping(builder, &mut constants, model);
    Ok(())
}

/// Creates the error of a mass matrix that cannot be factored, with the location.
fn singular(model: &Model, found: SingularMass) -> BuildError {
    let message = "in the initial configuration the mass matrix is not positive definite";
    let why = "masses, inertias or armatures are too small, too different, or not finite";
    let Some(dof) = found.dof else {
        return BuildError::new("model", format!("{message}: {why}"));
    };
    let joint = &model.joints[model.dofs[dof].joint];
    let body = &model.bodies[joint.body];
    let name = match joint.name.as_str() {
        "" => "unnamed joint".to_owned(),
        name => format!("joint \"{name}\""),
    };
    let mut error = BuildError::new(name, format!("{message} at this joint (dof {dof}): {why}"));
    error.origin = joint.origin.clone().or_else(|| body.origin.clone());
    error.of_body(&describe(&body.name, joint.body))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Returns true for each body that a tendon with armature moves: its weights are then those of the mass matrix, as in
/// MuJoCo.
fn bodies_of_tendons_with_inertia(model: &Model, pose0: &Positions<f64>) -> Vec<bool> {
    let mut found = vec![false; model.nbody()];
    for (t, &armature) in model.params.tendon_armature.iter().enumerate() {
        if armature > 0.0 {
            for (dof, _) in tendon::gradient(model, pose0, t) {
                found[model.joints[model.dofs[dof].joint].body] = true;
            }
        }
    }
    found
}

/// Returns true if the body moves independently, without children, along and about its own coordinate axes through its
/// centre of mass: along those of the world or of a body fixed to it, and then about one, or about all by a ball or
/// free joint.
fn moves_independently(model: &Model, b: usize) -> bool {
    let body = &model.bodies[b];
    let p = &model.params;
    let on_fixed = {
        let parent = &model.bodies[body.parent];
        body.root == b || parent.parent == 0 && parent.joints.is_empty()
    };
    let is_aligned = |j: usize| {
        let axis = p.jnt_axis[j].to_array();
        axis.iter().filter(|a| a.abs() > ALIGNED).count() == 1
    };
    let mut turned = false;
    let mut is_simple = |j: usize| {
        let kind = model.joints[j].kind;
        let straight = match kind {
            JointKind::Hinge | JointKind::Slide => is_aligned(j),
            JointKind::Ball | JointKind::Free => true,
        };
        let simple = !turned && straight && is_null_position(p.jnt_pos[j]);
        turned |= matches!(kind, JointKind::Ball | JointKind::Hinge);
        simple
    };
    !body.joints.is_empty()
        && on_fixed
        && is_null(p.body_ipos[b], p.body_iquat[b])
        && body.joints.clone().all(&mut is_simple)
        && model.bodies.get(b + 1).is_none_or(|next| next.parent != b)
}

/// Computes the stiffness and damping that give a joint's time constant and damping ratio with its inertia at qpos0, as
/// `solref` does.
fn spring_dampers(springdampers: &[[f64; 2]], model: &mut Model) {
    for (j, &[timeconst, dampratio]) in springdampers.iter().enumerate() {
        if timeconst <= 0.0 || dampratio <= 0.0 {
            continue;
        }
        let dofs = model.joints[j].dof..model.joints[j].dof + model.joints[j].kind.nv();
        let p = &mut model.params;
        let inertia = 1.0 / mean(&p.dof_invweight0[dofs.clone()]).max(MIN_INERTIA);
        let squared = timeconst * timeconst * dampratio * dampratio;
        p.jnt_stiffness[j] = inertia / squared.max(MIN_INERTIA);
        p.dof_damping[dofs].fill(2.0 * inertia / timeconst.max(MIN_INERTIA));
    }
}

/// Damps servos. A servo of gain kp that moves the inertia m = (J M⁻¹ Jᵀ)⁻¹ is an oscillator with the damping ratio kv
/// / (2 √(kp m)). For an orientation servo J M⁻¹ Jᵀ is the mean about its three axes. A servo that moves nothing is not
/// damped.
fn servo_damping(builder: &ModelBuilder, constants: &mut Constants, model: &mut Model) {
    for (u, spec) in builder.actuators.iter().enumerate() {
        let Some(ratio) = spec.dampratio else {
            continue;
        };
        let outputs = model.actuators[u].outputs.clone();
        let share = 1.0 / outputs.len() as f64;
        let mut weight = 0.0;
        for output in outputs {
            weight += share * constants.weight_of_output(model, output);
        }
        // For a restoring bias this is also the gain.
        let stiffness = -spec.biasprm[1];
        model.params.actuator_biasprm[u][2] = if weight > MIN_INERTIA {
            -2.0 * ratio * (stiffness * (1.0 / weight)).sqrt()
        } else {
            0.0
        };
    }
}
