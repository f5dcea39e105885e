//! The derivatives of the forces of single rows: limits, dry friction and equalities of joints and tendons.

use super::coordinate::{AlongForce, Coordinate};
use super::row_forces::RowForces;
use super::slopes::Slopes;
use super::step::Step;
use clench_dynamics::constraint::equality_rates;
use clench_dynamics::dynamics::force_derivatives::ForceDerivatives;
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
        (force, slopes, forces): (f64, &Slopes, &mut RowForces),
        gradient: &mut ForceDerivatives<'_, f64>,
    ) {
        self.find_rates(step, block, source);
        let row = Coordinate {
            dofs: block.dofs,
            arms: block.jacobian,
            by_position: block.jacobian,
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
        for (k, (dof, arm)) in row.iter().enumerate() {
            let change = force.by_length * arm + row.change(k, moving);
            forces.add(block, dof, &[change]);
            forces.add(block, step.model.nv + dof, &[force.by_velocity * arm]);
        }
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
                EqualityTarget::Tendon { tendon1, tendon2 } => {
                    let follower = Coordinate::of_tendon(step, tendon1);
                    self.add(block.dofs, follower, 1.0);
                    let Some(leader) = tendon2 else { return };
                    let length = step.plain.position.ten_length[leader];
                    let x = length - step.params.tendon_length0[leader];
                    let [slope, curvature] = equality_rates(step.params, e, x);
                    let leader = Coordinate::of_tendon(step, leader);
                    self.add(block.dofs, leader, -slope);
                    self.add_outer(block.dofs, leader.iter(), -curvature);
                }
                EqualityTarget::Connect { .. } | EqualityTarget::Weld { .. } => {}
            },
            ConstraintSource::JointLimit(j) => match step.model.joints[j].kind {
                JointKind::Ball => self.set_cone(step, j),
                JointKind::Hinge | JointKind::Slide | JointKind::Free => {}
            },
            ConstraintSource::TendonFriction(t) | ConstraintSource::TendonLimit(t) => {
                let tendon = Coordinate::of_tendon(step, t);
                // An upper limit is the negative length.
                let upper = block.jacobian != tendon.arms;
                self.add(block.dofs, tendon, if upper { -1.0 } else { 1.0 });
            }
            ConstraintSource::DofFriction(_)
            | ConstraintSource::Dynamic { .. }
            | ConstraintSource::Contact(_) => {}
        }
    }

    /// Adds the rates of a coordinate times a factor.
    fn add(&mut self, dofs: &[u32], coordinate: Coordinate<'_>, factor: f64) {
        if coordinate.rates.is_empty() {
            return;
        }
        self.rates.resize(dofs.len() * dofs.len(), 0.0);
        let rows = coordinate.rates.chunks_exact(coordinate.dofs.len());
        for (dof, rates) in coordinate.dofs.iter().zip(rows) {
            for (other, rate) in coordinate.dofs.iter().zip(rates) {
                let found = (dofs.binary_search(dof), dofs.binary_search(other));
                if let (Ok(row), Ok(column)) = found {
                    self.rates[row * dofs.len() + column] += factor * rate;
                }
            }
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

    /// Sets the rates of the limit of a ball joint's angle φ. J is minus the axis u of its rotation, which changes with
    /// a rotation ω by ½ cot(φ/2) (ω − u u·ω) + ½ u × ω.
    fn set_cone(&mut self, step: &Step<'_>, joint: usize) {
        let rotation = Quat::from_slice(&step.before.qpos[step.model.joints[joint].qpos..]);
        let (axis, angle) = rotation.normalize().to_rotation_vector().normalize();
        // No axis.
        if angle < 1e-15 {
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
