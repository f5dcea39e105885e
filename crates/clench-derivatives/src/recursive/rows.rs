//! The derivatives of the forces of single rows: limits, dry friction and equalities of joints and tendons.

use super::coordinate::{AlongForce, Coordinate};
use super::slopes::Slopes;
use super::step::Step;
use clench_dynamics::constraint::equality_rates;
use clench_dynamics::dynamics::inverse_derivatives::Columns;
use clench_dynamics::model::{EqualityTarget, JointKind};
use clench_dynamics::record::ConstraintSource;
use clench_math::{Quat, Vec3};
use clench_solver::Block;

/// Scratch memory of these derivatives.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    /// The rates of a row: the derivative of each entry of J by the position of each dof.
    rates: Vec<f64>,
}

impl Rows {
    /// Subtracts the derivatives of the force of a row from the gradient.
    pub(super) fn subtract(
        &mut self,
        step: &Step<'_>,
        block: &Block<'_, f64>,
        source: ConstraintSource,
        (force, slopes): (f64, &Slopes),
        gradient: &mut Columns<'_, f64>,
    ) {
        self.find_rates(step, block, source);
        let row = Coordinate {
            dofs: block.dofs,
            arms: block.jacobian,
            rates: &self.rates,
        };
        let (by_residual, damping) = (slopes.by_residual[0][0], slopes.damping[0]);
        let force = AlongForce {
            value: force,
            by_length: slopes.by_distance[0],
            by_velocity: by_residual * damping,
        };
        let (qacc, qvel) = (&step.plain.qacc, &step.before.qvel);
        let moving = |dof: usize| by_residual * (qacc[dof] + damping * qvel[dof]);
        row.subtract((step.model.nv, gradient), force, moving, |_| 1.0);
    }

    /// Computes the rates of a row; none if they are zero.
    fn find_rates(&mut self, step: &Step<'_>, block: &Block<'_, f64>, source: ConstraintSource) {
        self.rates.clear();
        match source {
            ConstraintSource::Equality(e) => match step.model.equalities[e].target {
                EqualityTarget::Joint { joint2, .. } => {
                    let Some(leader) = joint2 else { return };
                    let joint = &step.model.joints[leader];
                    let x = step.before.qpos[joint.qpos] - step.params.qpos0[joint.qpos];
                    let [_, curvature] = equality_rates(step.params, e, x);
                    let gradient = [(joint.dof, 1.0)].into_iter();
                    self.add_outer(block.dofs, gradient, -curvature);
                }
                EqualityTarget::Tendon { tendon2, .. } => {
                    let Some(leader) = tendon2 else { return };
                    let length = step.plain.position.ten_length[leader];
                    let x = length - step.params.tendon_length0[leader];
                    let [_, curvature] = equality_rates(step.params, e, x);
                    let gradient = Coordinate::of_tendon(step, leader).iter();
                    self.add_outer(block.dofs, gradient, -curvature);
                }
                EqualityTarget::Connect { .. } | EqualityTarget::Weld { .. } => {}
            },
            ConstraintSource::JointLimit(j) => match step.model.joints[j].kind {
                JointKind::Ball => self.set_cone(step, j),
                JointKind::Hinge | JointKind::Slide | JointKind::Free => {}
            },
            ConstraintSource::DofFriction(_)
            | ConstraintSource::TendonFriction(_)
            | ConstraintSource::TendonLimit(_)
            | ConstraintSource::Dynamic { .. }
            | ConstraintSource::Contact(_) => {}
        }
    }

    /// Adds a gradient times its transpose, times a factor.
    fn add_outer(
        &mut self,
        dofs: &[u32],
        gradient: impl Iterator<Item = (usize, f64)> + Clone,
        factor: f64,
    ) {
        if factor == 0.0 {
            return;
        }
        self.rates.resize(dofs.len() * dofs.len(), 0.0);
        let index = |dof: usize| dofs.binary_search(&(dof as u32)).ok();
        for (dof, arm) in gradient.clone() {
            for (other, length) in gradient.clone() {
                if let (Some(row), Some(column)) = (index(dof), index(other)) {
                    self.rates[row * dofs.len() + column] += factor * arm * length;
                }
            }
        }
    }

    /// Sets the rates of the limit of a ball joint's angle φ. J is minus the axis u of its rotation, which changes with a
    /// rotation ω by ½ cot(φ/2) (ω − u u·ω) + ½ u × ω.
    fn set_cone(&mut self, step: &Step<'_>, joint: usize) {
        let rotation = Quat::from_slice(&step.before.qpos[step.model.joints[joint].qpos..]);
        let (axis, angle) = rotation.normalize().to_rotation_vector().normalize();
        if angle == 0.0 {
            return;
        }
        let cotangent = 1.0 / (0.5 * angle).tan();
        self.rates.resize(9, 0.0);
        for column in 0..3 {
            let mut turn = Vec3::ZERO;
            turn[column] = 1.0;
            let across = turn - axis * axis[column];
            let change = (across * cotangent + axis.cross(turn)) * -0.5;
            for row in 0..3 {
                self.rates[3 * row + column] = change[row];
            }
        }
    }
}
