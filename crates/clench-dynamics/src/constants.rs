//! Constants that follow from a model's parameters in its initial configuration qpos0 (MuJoCo's `mj_setConst`): subtree
//! masses, inverse inertias, tendon lengths, camera frames, anchors of equality constraints.
//!
//! The inverse inertia of a constraint with Jacobian J is A = J M⁻¹ Jᵀ. MuJoCo's `invweight0` are such values at qpos0,
//! averaged over the directions of a group. With M = LᵀDL, A_ii = ‖D^(-1/2) L^(-T) J_iᵀ‖².

use crate::dynamics::added_mass::AddedMass;
use crate::dynamics::camera::fixed_pose;
use crate::dynamics::ellipsoid::semi_axes;
use crate::dynamics::inertia::composite_inertia;
use crate::dynamics::kinematics::Computed;
use crate::dynamics::tendon_armature::add_tendon_inertia;
use crate::dynamics::{tendon, transmission};
use crate::error::SimError;
use crate::model::{CameraMode, Coupled, JointKind, Model, ParamField, Params};
use crate::part::Part;
use crate::singular::first_bad_pivot;
use crate::stages::Positions;
use crate::{State, Step};
use clench_math::{Motion, Quat, Scalar, Vec3};
use clench_solver::{TreeFactor, TreeMatrix};

/// The smallest mass (kg), inertia (kg m²) or inverse that is used as a divisor (MuJoCo's `mjMINVAL`).
pub const MIN_INERTIA: f64 = 1e-15;
/// The minimum size of a body, m (as in MuJoCo).
const MIN_SIZE: f64 = 1e-5;

/// The fields that [`Constants`] sets.
pub const CONSTANTS: [ParamField; 16] = [
    ParamField::body_subtreemass,
    ParamField::body_invweight0,
    ParamField::dof_invweight0,
    ParamField::dof_length,
    ParamField::geom_virtualmass,
    ParamField::geom_virtualinertia,
    ParamField::tendon_length0,
    ParamField::tendon_invweight0,
    ParamField::actuator_acc0,
    ParamField::cam_pos0,
    ParamField::cam_poscom0,
    ParamField::cam_mat0,
    ParamField::eq_anchor1,
    ParamField::eq_anchor2,
    ParamField::eq_quat1,
    ParamField::eq_quat2,
];

/// A mass matrix that is singular or nearly singular at qpos0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SingularMass {
    /// The dof with the bad pivot, if it is known.
    pub dof: Option<usize>,
}

/// The poses of a model at qpos0, and its mass matrix there.
pub struct Constants {
    pose: Positions<f64>,
    mass: TreeFactor<f64>,
    row: Vec<f64>,
}

impl SingularMass {
    /// Returns the error of a simulation, or of an environment of a batch.
    pub fn error(self, model: &Model, env: Option<usize>) -> SimError {
        let place = self.dof.map(|dof| {
            let name = &model.joints[model.dofs[dof].joint].name;
            format!(" (joint \"{name}\", dof {dof})")
        });
        SimError::SingularMass {
            env,
            place: place.unwrap_or_default(),
        }
    }
}

impl Constants {
    /// Computes the mass matrix of a model with these parameters; `pose` are the poses at qpos0.
    ///
    /// # Errors
    /// Returns an error if the mass matrix is not positive definite.
    pub fn new(
        model: &Model,
        params: &Params<f64>,
        mut pose: Positions<f64>,
    ) -> Result<Self, SingularMass> {
        let mut mass = TreeMatrix::zeros(&model.tree);
        let whole = [Part::whole(model)];
        composite_inertia(model, params, &whole, &mut pose, &mut mass);
        add_tendon_inertia(model, params, &pose, &mut mass);
        let mut factor = TreeFactor::zeros(&model.tree);
        if !factor.factor(&model.tree, &mass) {
            let dof = first_bad_pivot(&model.tree, mass.values);
            return Err(SingularMass { dof });
        }
        Ok(Constants {
            pose,
            mass: factor,
            row: vec![0.0; model.nv],
        })
    }

    /// Computes the fields of [`CONSTANTS`] from the others.
    ///
    /// # Errors
    /// Returns an error if the mass matrix is so nearly singular that inverse inertias are not finite.
    pub fn set(&mut self, model: &Model, params: &mut Params<f64>) -> Result<(), SingularMass> {
        params.derive(model, ParamField::body_mass);
        self.set_dof_lengths(model, params);
        self.set_dof_weights(model, params);
        self.set_body_weights(model, params);
        set_added_masses(model, params);
        self.set_tendons(model, params);
        self.set_unit_accelerations(model, params);
        self.set_cameras(model, params);
        self.set_anchors(model, params);
        require_finite(&rows::<f64>(params))
    }

    /// Computes J M⁻¹ Jᵀ for actuator output `output` (below `Model::nout`).
    pub fn weight_of_output(&mut self, model: &Model, output: usize) -> f64 {
        let row = transmission::moment(model, &self.pose, output);
        fill(&mut self.row, row);
        self.weight(model)
    }

    /// Computes J M⁻¹ Jᵀ for `row`.
    fn weight(&mut self, model: &Model) -> f64 {
        self.mass.solve_half(&model.tree, &mut self.row);
        self.row.iter().map(|x| x * x).sum()
    }

    /// Sets the lengths of dofs; for rotations the largest distance of a body's joints and geoms from its centre of
    /// mass.
    fn set_dof_lengths(&self, model: &Model, params: &mut Params<f64>) {
        let pose = &self.pose;
        let mut sizes = vec![0.0f64; model.nbody()];
        for (j, joint) in model.joints.iter().enumerate() {
            for body in [joint.body, model.bodies[joint.body].parent] {
                let distance = (pose.xipos[body] - pose.xanchor[j]).norm();
                sizes[body] = sizes[body].max(distance);
            }
        }
        for (g, geom) in model.geoms.iter().enumerate() {
            let radius = params.geom_rbound[g];
            if radius > 0.0 {
                let distance = (pose.xipos[geom.body] - pose.geom_xpos[g]).norm();
                sizes[geom.body] = sizes[geom.body].max(radius + distance);
            }
        }
        let lengths = model.dofs.iter().enumerate().map(|(i, dof)| {
            let joint = &model.joints[dof.joint];
            match joint.kind {
                JointKind::Slide => 1.0,
                JointKind::Free if i < joint.dof + 3 => 1.0,
                JointKind::Free | JointKind::Ball | JointKind::Hinge => {
                    sizes[dof.body].max(MIN_SIZE)
                }
            }
        });
        params.dof_length = lengths.collect();
    }

    fn set_dof_weights(&mut self, model: &Model, params: &mut Params<f64>) {
        let mut weight_of = |last: usize| {
            let unit = |dof: usize| f64::from(u8::from(dof == last));
            weight_along(&self.mass, &mut self.row, model, last, unit)
        };
        let mut weights = Vec::from_iter((0..model.nv).map(&mut weight_of));
        for joint in &model.joints {
            let together = match joint.kind {
                JointKind::Free => 3,
                JointKind::Ball | JointKind::Slide | JointKind::Hinge => joint.kind.nv(),
            };
            let dofs = &mut weights[joint.dof..joint.dof + joint.kind.nv()];
            for group in dofs.chunks_mut(together) {
                group.fill(mean(group));
            }
            if only_slides(model, joint.body) {
                dofs.fill(1.0 / params.body_mass[joint.body].max(MIN_INERTIA));
            }
        }
        params.dof_invweight0 = weights;
    }

    /// Averages over the three translations of the centre of mass, and over the three rotations.
    fn set_body_weights(&mut self, model: &Model, params: &mut Params<f64>) {
        let Constants { pose, mass, row } = self;
        let mut weights = vec![[0.0; 2]; model.nbody()];
        for (b, weight) in weights.iter_mut().enumerate() {
            if model.bodies[model.bodies[b].weld].joints.is_empty() {
                continue;
            }
            if only_slides(model, b) {
                *weight = [1.0 / params.body_mass[b].max(MIN_INERTIA), 0.0];
                continue;
            }
            let Some(last) = model.bodies[b].last_dof else {
                continue;
            };
            let offset = pose.xipos[b] - pose.subtree_com[model.bodies[b].root];
            let mut along = |part: &dyn Fn(Motion<f64>) -> f64| {
                weight_along(mass, row, model, last, |dof| part(pose.cdof[dof]))
            };
            let translation = [0, 1, 2].map(|k| along(&|m| m.velocity_at(offset)[k]));
            let rotation = [0, 1, 2].map(|k| along(&|m| m.angular[k]));
            *weight = [mean(&translation), mean(&rotation)];
        }
        params.body_invweight0 = weights;
    }

    fn set_tendons(&mut self, model: &Model, params: &mut Params<f64>) {
        params.tendon_length0.clone_from(&self.pose.ten_length);
        let weights = (0..model.tendons.len()).map(|t| {
            fill(&mut self.row, tendon::gradient(model, &self.pose, t));
            self.weight(model)
        });
        params.tendon_invweight0 = weights.collect();
    }

    /// Computes ‖M⁻¹ Jᵀ‖ of the first force of each actuator, by which muscles scale their force.
    fn set_unit_accelerations(&mut self, model: &Model, params: &mut Params<f64>) {
        let norms = model.actuators.iter().map(|actuator| {
            let arms = transmission::moment(model, &self.pose, actuator.outputs.start);
            fill(&mut self.row, arms);
            self.mass.solve(&model.tree, &mut self.row);
            self.row.iter().map(|x| x * x).sum::<f64>().sqrt()
        });
        params.actuator_acc0 = norms.collect();
    }

    /// Sets the reference frames of tracking cameras.
    fn set_cameras(&self, model: &Model, params: &mut Params<f64>) {
        let pose = &self.pose;
        let count = model.cameras.len();
        params.cam_pos0 = vec![Vec3::ZERO; count];
        params.cam_poscom0 = vec![Vec3::ZERO; count];
        params.cam_mat0 = vec![[0.0; 9]; count];
        for (c, camera) in model.cameras.iter().enumerate() {
            let (pos, mat) = fixed_pose(model, params, pose, c);
            let from = match camera.mode {
                CameraMode::TrackCom(Some(body))
                | CameraMode::TargetBody(body)
                | CameraMode::TargetBodyCom(body) => body,
                CameraMode::Fixed | CameraMode::Track | CameraMode::TrackCom(None) => camera.body,
            };
            params.cam_pos0[c] = pos - pose.xpos[camera.body];
            params.cam_poscom0[c] = pos - pose.subtree_com[from];
            for (to, row) in params.cam_mat0[c].chunks_exact_mut(3).zip(mat.rows) {
                row.write(to);
            }
        }
    }

    /// Sets the anchors. A connect's second anchor coincides with the first at qpos0, as do the frames of a weld
    /// without a pose of its own; sites are their own anchors.
    fn set_anchors(&self, model: &Model, params: &mut Params<f64>) {
        params.derive(model, ParamField::site_pos);
        params.derive(model, ParamField::site_quat);
        for (i, equality) in model.equalities.iter().enumerate() {
            match (equality.sites, equality.target.coupled()) {
                (Some(_), _) => {}
                (None, Coupled::Points(bodies)) => {
                    params.eq_anchor2[i] = carry(&self.pose, bodies, params.eq_anchor1[i]);
                }
                (None, Coupled::Frames(bodies)) if equality.pose_at_qpos0 => {
                    let (point, quat) = relative_pose(&self.pose, bodies, params.eq_anchor2[i]);
                    (params.eq_anchor1[i], params.eq_quat1[i]) = (point, quat);
                }
                (None, Coupled::Frames(_) | Coupled::Joints(..) | Coupled::Tendons(..)) => {}
            }
        }
    }
}

/// Sets the inertia of the medium that ellipsoids move.
fn set_added_masses(model: &Model, params: &mut Params<f64>) {
    for (g, geom) in model.geoms.iter().enumerate() {
        // A layout of several models also has geoms that this model lacks.
        if geom.fluid_ellipsoid && params.geom_rbound[g] >= 0.0 {
            let added = AddedMass::of_ellipsoid(semi_axes(geom.kind, params.geom_size[g]));
            params.geom_virtualmass[g] = added.mass;
            params.geom_virtualinertia[g] = added.inertia;
        }
    }
}

/// Computes the fields of [`CONSTANTS`] from the others, and returns their values in the precision of a simulation.
///
/// # Errors
/// Returns an error if the mass matrix is not positive definite, or if a value is not finite in this precision.
pub fn constants<S: Scalar>(
    model: &Model,
    params: &mut Params<f64>,
) -> Result<Vec<Vec<S>>, SingularMass> {
    let pose = pose(model, params, &params.qpos0);
    Constants::new(model, params, pose)?.set(model, params)?;
    let rows = rows(params);
    require_finite(&rows)?;
    Ok(rows)
}

/// Returns the values of the fields of [`CONSTANTS`].
fn rows<S: Scalar>(params: &Params<f64>) -> Vec<Vec<S>> {
    let row = |field: &ParamField| {
        params
            .read_lane(*field, 0)
            .into_iter()
            .map(S::new)
            .collect()
    };
    CONSTANTS.iter().map(row).collect()
}

fn require_finite<S: Scalar>(rows: &[Vec<S>]) -> Result<(), SingularMass> {
    match rows.iter().flatten().all(|x| x.is_finite()) {
        true => Ok(()),
        false => Err(SingularMass { dof: None }),
    }
}

/// Computes poses, and everything that depends only on them, at `qpos`; mocap bodies are where the parameters place
/// them.
pub fn pose(model: &Model, params: &Params<f64>, qpos: &[f64]) -> Positions<f64> {
    let mut state = State::new(model);
    state.qpos.copy_from_slice(qpos);
    for (b, body) in model.bodies.iter().enumerate() {
        if let Some(m) = body.mocap {
            state.mocap_pos[m] = params.body_pos[b];
            state.mocap_quat[m] = params.body_quat[b];
        }
    }
    let mut pos = Positions::new(model);
    let whole = [Part::whole(model)];
    (Step::compiled().poses)(model, params, &state, Computed::all(&whole), &mut pos);
    pos
}

/// Transforms a point from the frame of the first body to that of the second.
pub fn carry(pose: &Positions<f64>, [from, to]: [usize; 2], point: Vec3<f64>) -> Vec3<f64> {
    let world = pose.xpos[from] + pose.xmat[from] * point;
    pose.xmat[to].transpose_mul(world - pose.xpos[to])
}

/// Returns the pose in the first body of a point of the second, with the orientation of the second.
pub fn relative_pose(
    pose: &Positions<f64>,
    [body1, body2]: [usize; 2],
    point: Vec3<f64>,
) -> (Vec3<f64>, Quat<f64>) {
    let quat = pose.xquat[body1].conjugate() * pose.xquat[body2];
    (carry(pose, [body2, body1], point), quat)
}

/// Computes J M⁻¹ Jᵀ for a row that is zero except on the path to dof `last`, where `entry` returns it.
fn weight_along(
    mass: &TreeFactor<f64>,
    row: &mut [f64],
    model: &Model,
    last: usize,
    entry: impl Fn(usize) -> f64,
) -> f64 {
    let path = model.tree.row(last);
    let row = &mut row[..path.len()];
    for (x, &dof) in row.iter_mut().zip(path) {
        *x = entry(dof as usize);
    }
    mass.solve_half_along(&model.tree, last, row);
    row.iter().map(|x| x * x).sum()
}

/// Writes a sparse row to a dense one.
fn fill(to: &mut [f64], row: impl Iterator<Item = (usize, f64)>) {
    to.fill(0.0);
    for (dof, entry) in row {
        to[dof] = entry;
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Returns true if a body's weights depend only on its mass: MuJoCo then takes 1/mass in every direction, without
/// armature (its `body_simple` of level two).
fn only_slides(model: &Model, body: usize) -> bool {
    let slides = |j: usize| model.joints[j].kind == JointKind::Slide;
    let body = &model.bodies[body];
    body.diagonal_inertia && body.joints.clone().all(slides)
}
