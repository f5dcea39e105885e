//! What follows from the model as a whole at qpos0: total and subtree masses, inverse inertias, derived damping.
//!
//! The inverse inertia that a constraint with Jacobian J meets is A = J M⁻¹ Jᵀ; MuJoCo's `invweight0` are such numbers at
//! qpos0, averaged over the directions that belong together. With M = LᵀDL, A_ii = ‖D^(-1/2) L^(-T) J_iᵀ‖².

use super::BuildError;
use super::bodies::{is_null, is_null_position};
use super::check::describe;
use super::model_builder::ModelBuilder;
use clench_dynamics::dynamics::inertia::composite_inertia;
use clench_dynamics::dynamics::tendon_armature::add_tendon_inertia;
use clench_dynamics::dynamics::{tendon, transmission};
use clench_dynamics::model::{Actuator, JointKind, Model};
use clench_dynamics::singular::first_bad_pivot;
use clench_dynamics::stages::Positions;
use clench_math::Motion;
use clench_solver::{TreeFactor, TreeMatrix};

/// Smallest mass (kg), inertia (kg m²) or inverse that is divided by (MuJoCo's `mjMINVAL`).
const MIN_INERTIA: f64 = 1e-15;
/// Parts of a unit axis below which it does not lean that way (MuJoCo's `mjEPS`).
const ALIGNED: f64 = 1e-14;

/// Masses scaled to the author's total, and the mass of every subtree.
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
    p.body_subtreemass.clone_from(&p.body_mass);
    for b in (1..model.bodies.len()).rev() {
        let mass = p.body_subtreemass[b];
        p.body_subtreemass[model.bodies[b].parent] += mass;
    }
}

/// Every body with joints must have a mass and an inertia, its own or that of a body fixed to it.
///
/// # Errors
/// One that has not; `order` are the author's indices.
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

/// Fills in the `invweight0` of dofs, bodies and tendons, and what is derived from them: springs from `springdamper`,
/// servo damping from `dampratio`.
///
/// # Errors
/// A mass matrix that is not positive definite.
pub(super) fn derive(
    builder: &ModelBuilder,
    order: &[usize],
    springdampers: &[[f64; 2]],
    pose0: &mut Positions<f64>,
    model: &mut Model,
) -> Result<(), BuildError> {
    let mut inverse = InverseInertia::new(model, pose0)?;
    let with_inertia = bodies_of_tendons_with_inertia(model, pose0);
    for (b, &old) in order.iter().enumerate() {
        let may = !builder.bodies[old].never_simple && !with_inertia[b];
        model.bodies[b].diagonal_inertia = may && moves_alone(model, b);
    }
    let slides = |j: usize| model.joints[j].kind == JointKind::Slide;
    let bodies = model.bodies.iter();
    // MuJoCo takes 1/mass for their weights, in every direction and without armature (its `body_simple` of level two).
    let sliders: Vec<bool> = bodies
        .map(|body| body.diagonal_inertia && body.joints.clone().all(slides))
        .collect();
    dof_weights(&mut inverse, &sliders, model);
    body_weights(&mut inverse, &sliders, pose0, model);
    tendon_weights(&mut inverse, pose0, model);
    spring_dampers(springdampers, model);
    servo_damping(builder, &mut inverse, pose0, model);
    unit_accelerations(&mut inverse, pose0, model);
    Ok(())
}

/// M⁻¹ at qpos0.
struct InverseInertia {
    factor: TreeFactor<f64>,
    row: Vec<f64>,
}

impl InverseInertia {
    fn new(model: &Model, pose0: &mut Positions<f64>) -> Result<Self, BuildError> {
        let mut mass = TreeMatrix::zeros(&model.tree);
        composite_inertia(model, &model.params, pose0, &mut mass);
        add_tendon_inertia(model, &model.params, pose0, &mut mass);
        let mut factor = TreeFactor::zeros(&model.tree);
        match factor.factor(&model.tree, &mass) {
            true => Ok(InverseInertia {
                factor,
                row: vec![0.0; model.nv],
            }),
            false => Err(singular(model, mass)),
        }
    }

    /// J M⁻¹ Jᵀ for a sparse row.
    fn weight_of(&mut self, model: &Model, row: impl Iterator<Item = (usize, f64)>) -> f64 {
        self.row.fill(0.0);
        for (dof, entry) in row {
            self.row[dof] = entry;
        }
        self.factor.solve_half(&model.tree, &mut self.row);
        self.row.iter().map(|x| x * x).sum()
    }

    /// ‖M⁻¹ Jᵀ‖, likewise.
    fn acceleration_of(&mut self, model: &Model, row: impl Iterator<Item = (usize, f64)>) -> f64 {
        self.row.fill(0.0);
        for (dof, entry) in row {
            self.row[dof] = entry;
        }
        self.factor.solve(&model.tree, &mut self.row);
        self.row.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// As `weight_of`, for a row that is zero but on the path to dof `last`, where `entry` gives it.
    fn weight_along(&mut self, model: &Model, last: usize, entry: impl Fn(usize) -> f64) -> f64 {
        let path = model.tree.row(last);
        let row = &mut self.row[..path.len()];
        for (x, &dof) in row.iter_mut().zip(path) {
            *x = entry(dof as usize);
        }
        self.factor.solve_half_along(&model.tree, last, row);
        row.iter().map(|x| x * x).sum()
    }
}

/// The error of a mass matrix that cannot be factored: where that shows.
fn singular(model: &Model, mass: TreeMatrix<f64>) -> BuildError {
    let message = "in the initial configuration the mass matrix is not positive definite";
    let why = "masses, inertias or armatures are too small, too different, or not finite";
    let Some(dof) = first_bad_pivot(&model.tree, mass.values) else {
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

fn dof_weights(inverse: &mut InverseInertia, sliders: &[bool], model: &mut Model) {
    let mut weights: Vec<f64> = (0..model.nv)
        .map(|last| inverse.weight_along(model, last, |dof| f64::from(u8::from(dof == last))))
        .collect();
    for joint in &model.joints {
        let together = match joint.kind {
            JointKind::Free => 3,
            kind => kind.nv(),
        };
        let dofs = &mut weights[joint.dof..joint.dof + joint.kind.nv()];
        for group in dofs.chunks_mut(together) {
            group.fill(mean(group));
        }
        if sliders[joint.body] {
            dofs.fill(1.0 / model.params.body_mass[joint.body].max(MIN_INERTIA));
        }
    }
    model.params.dof_invweight0 = weights;
}

/// Mean over the three translations of the centre of mass, and over the three rotations.
fn body_weights(
    inverse: &mut InverseInertia,
    sliders: &[bool],
    pose0: &Positions<f64>,
    model: &mut Model,
) {
    let mut weights = vec![[0.0; 2]; model.nbody()];
    for (b, weight) in weights.iter_mut().enumerate() {
        if model.bodies[model.bodies[b].weld].joints.is_empty() {
            continue;
        }
        if sliders[b] {
            *weight = [1.0 / model.params.body_mass[b].max(MIN_INERTIA), 0.0];
            continue;
        }
        let offset = pose0.xipos[b] - pose0.subtree_com[model.bodies[b].root];
        let mut along = |part: &dyn Fn(Motion<f64>) -> f64| {
            let last = model.bodies[b].last_dof;
            last.map_or(0.0, |last| {
                inverse.weight_along(model, last, |dof| part(pose0.cdof[dof]))
            })
        };
        let translation = [0, 1, 2].map(|k| along(&|m| m.velocity_at(offset)[k]));
        let rotation = [0, 1, 2].map(|k| along(&|m| m.angular[k]));
        *weight = [mean(&translation), mean(&rotation)];
    }
    model.params.body_invweight0 = weights;
}

fn tendon_weights(inverse: &mut InverseInertia, pose0: &Positions<f64>, model: &mut Model) {
    let weight = |t| inverse.weight_of(model, tendon::gradient(model, pose0, t));
    let weights = (0..model.tendons.len()).map(weight).collect();
    model.params.tendon_invweight0 = weights;
}

/// Whether a tendon with armature moves each body: then, as in MuJoCo, its weights are those of the mass matrix.
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

/// Whether the body moves alone, carrying nothing, along and about coordinate axes of its own through its centre of mass: along
/// those of the world or of a body fixed to it, and then about one, or about all by a ball or free joint.
fn moves_alone(model: &Model, b: usize) -> bool {
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

/// Stiffness and damping that give a joint's time constant and damping ratio with its inertia at qpos0, as `solref` does.
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

/// A servo of gain kp that moves the inertia m = (J M⁻¹ Jᵀ)⁻¹ is an oscillator, whose damping ratio is kv / (2 √(kp m)). Of an orientation
/// servo J M⁻¹ Jᵀ is the mean about its three axes. A servo that moves nothing is not damped.
fn servo_damping(
    builder: &ModelBuilder,
    inverse: &mut InverseInertia,
    pose0: &Positions<f64>,
    model: &mut Model,
) {
    for (u, spec) in builder.actuators.iter().enumerate() {
        let Some(ratio) = spec.dampratio else {
            continue;
        };
        let outputs = model.actuators[u].outputs.clone();
        let share = 1.0 / outputs.len() as f64;
        let mut weight = 0.0;
        for output in outputs {
            weight += share * inverse.weight_of(model, transmission::moment(model, pose0, output));
        }
        // The gain of what pulls back is this too.
        let stiffness = -spec.biasprm[1];
        model.params.actuator_biasprm[u][2] = if weight > MIN_INERTIA {
            -2.0 * ratio * (stiffness * (1.0 / weight)).sqrt()
        } else {
            0.0
        };
    }
}

/// `actuator_acc0`, by which muscles scale their force.
fn unit_accelerations(inverse: &mut InverseInertia, pose0: &Positions<f64>, model: &mut Model) {
    let mut norm = |u: &Actuator| {
        let arms = transmission::moment(model, pose0, u.outputs.start);
        inverse.acceleration_of(model, arms)
    };
    let norms = model.actuators.iter().map(&mut norm).collect();
    model.params.actuator_acc0 = norms;
}
