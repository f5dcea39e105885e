//! Forces and torques of constraints other than contacts, in world coordinates, for drawing as arrows.
//!
//! Connects and welds act on two bodies at their anchors. A limit or an equality of joints is a generalized force Jᵀf
//! on the dofs of its joints: along the axis of a slide, about that of a hinge, about the three axes of a ball.
//! Constraints of tendons have no single point of action and are omitted.

use super::blocks::active_blocks;
use crate::output::{Source, each_joint_of_bodies};
use clench_dynamics::constraint::ConstraintSource;
use clench_dynamics::model::{Coupled, JointKind};
use clench_math::{Real, Scalar, Vec3};
use clench_solver::Block;

/// The force and torque of a constraint on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// The constraint.
    pub source: ConstraintSource,
    /// The body on which it acts.
    pub body: usize,
    /// The point of action, m.
    pub at: [f64; 3],
    /// Force, N.
    pub force: [f64; 3],
    /// Torque, N m.
    pub torque: [f64; 3],
}

/// Returns the forces of the constraints of lane `lane`. A connect or weld appears once, for its first body if that can
/// move, otherwise for its second.
pub(crate) fn pushes<T: Real>(s: &Source<T>, lane: usize) -> Vec<Push> {
    let mut found = Vec::new();
    let plain = |v: Vec3<T>| v.to_array().map(|x| x.lane(lane).to_f64());
    each_joint_of_bodies(s, |source, bodies, wrenches| {
        let moves = |body: usize| s.model.tree_of_body(body).is_some();
        let (end, sign) = match moves(bodies[0]) {
            true => (0, T::ONE),
            false => (1, -T::ONE),
        };
        let wrench = &wrenches[end];
        found.push(Push {
            source,
            body: bodies[end],
            at: plain(wrench.at),
            force: plain(wrench.force * sign),
            torque: plain(wrench.couple * sign),
        });
    });
    for (index, block) in active_blocks(s.ws, lane) {
        let source = s.ws.record.blocks[index].source;
        let joints = match source {
            ConstraintSource::JointLimit(_) => true,
            ConstraintSource::Equality(e) => {
                matches!(s.model.equalities[e].target.coupled(), Coupled::Joints(..))
            }
            ConstraintSource::Dynamic { .. }
            | ConstraintSource::DofFriction(_)
            | ConstraintSource::TendonFriction(_)
            | ConstraintSource::TendonLimit(_)
            | ConstraintSource::Contact(_) => false,
        };
        if joints {
            let forces = &s.ws.solver.force()[block.rows()];
            found.extend(of_joints(s, source, &block, forces, lane));
        }
    }
    // Constraints that the lane does not have are zero.
    found.retain(|push| push.force.iter().chain(&push.torque).any(|&x| x != 0.0));
    found
}

/// Returns the forces of a block on each joint whose dofs it contains.
fn of_joints<T: Real>(
    s: &Source<T>,
    source: ConstraintSource,
    block: &Block<T>,
    forces: &[T],
    lane: usize,
) -> Vec<Push> {
    let width = block.dofs.len();
    let pos = &s.ws.position;
    let number = |x: T| x.lane(lane).to_f64();
    let plain = |v: Vec3<T>| v.to_array().map(number);
    let mut found: Vec<Push> = Vec::new();
    for (column, &dof) in block.dofs.iter().enumerate() {
        let rows = forces.iter().enumerate();
        let size: f64 = rows
            .map(|(row, &f)| number(block.jacobian[row * width + column]) * number(f))
            .sum();
        let joint = s.model.dofs[dof as usize].joint;
        let described = &s.model.joints[joint];
        let mut push = Push {
            source,
            body: described.body,
            at: plain(pos.xanchor[joint]),
            force: [0.0; 3],
            torque: [0.0; 3],
        };
        match described.kind {
            JointKind::Slide => push.force = plain(pos.xaxis[joint]).map(|x| size * x),
            JointKind::Hinge => push.torque = plain(pos.xaxis[joint]).map(|x| size * x),
            // Dofs of a ball, and the last three of a free joint, rotate about the axes of the body.
            JointKind::Ball | JointKind::Free => {
                let axis = plain(pos.cdof[dof as usize].angular);
                push.torque = axis.map(|x| size * x);
            }
        }
        match found
            .last_mut()
            .filter(|last| last.at == push.at && last.body == push.body)
        {
            Some(last) if described.kind == JointKind::Ball => {
                for (sum, more) in last.torque.iter_mut().zip(push.torque) {
                    *sum += more;
                }
            }
            _ => found.push(push),
        }
    }
    found
}
