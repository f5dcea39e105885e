//! A part of a model: consecutive bodies that form whole trees.

use crate::model::Model;
use std::ops::Range;

/// Consecutive bodies that form whole trees on the world, with their joints and dofs. The world itself may be the first
/// of the bodies.
#[derive(Clone, Debug)]
pub struct Part {
    /// The bodies.
    pub bodies: Range<usize>,
    /// Their joints.
    pub joints: Range<usize>,
    /// Their degrees of freedom.
    pub dofs: Range<usize>,
}

impl Part {
    /// Creates the part that is the whole model.
    pub fn whole(model: &Model) -> Self {
        Part {
            bodies: 0..model.nbody(),
            joints: 0..model.joints.len(),
            dofs: 0..model.nv,
        }
    }

    /// Replaces `parts` by those of the bodies for which `includes` returns true.
    pub(crate) fn list(model: &Model, includes: &dyn Fn(usize) -> bool, parts: &mut Vec<Part>) {
        parts.clear();
        let dof = |joint: usize| model.joints.get(joint).map_or(model.nv, |joint| joint.dof);
        for (b, body) in model.bodies.iter().enumerate() {
            if !includes(b) {
                continue;
            }
            let joints = body.joints.clone();
            match parts.last_mut() {
                Some(last) if last.bodies.end == b => {
                    last.bodies.end = b + 1;
                    (last.joints.end, last.dofs.end) = (joints.end, dof(joints.end));
                }
                _ => parts.push(Part {
                    bodies: b..b + 1,
                    dofs: dof(joints.start)..dof(joints.end),
                    joints,
                }),
            }
        }
    }
}
