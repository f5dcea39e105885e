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
        Part::first(model, model.nbody())
    }

    /// Creates the part of the first bodies. If their trees continue, `subtree_com` holds other points than centres of
    /// mass, about which spatial vectors are still consistent.
    pub fn first(model: &Model, bodies: usize) -> Self {
        let joints = model.bodies[..bodies]
            .last()
            .map_or(0, |body| body.joints.end);
        Part {
            bodies: 0..bodies,
            joints: 0..joints,
            dofs: 0..first_dof(model, joints),
        }
    }

    /// Replaces `parts` by those of the bodies for which `includes` returns true.
    pub(crate) fn list(model: &Model, includes: &dyn Fn(usize) -> bool, parts: &mut Vec<Part>) {
        parts.clear();
        for (b, body) in model.bodies.iter().enumerate() {
            if !includes(b) {
                continue;
            }
            let joints = body.joints.clone();
            match parts.last_mut() {
                Some(last) if last.bodies.end == b => {
                    last.bodies.end = b + 1;
                    (last.joints.end, last.dofs.end) = (joints.end, first_dof(model, joints.end));
                }
                _ => parts.push(Part {
                    bodies: b..b + 1,
                    dofs: first_dof(model, joints.start)..first_dof(model, joints.end),
                    joints,
                }),
            }
        }
    }
}

/// Returns the first dof of the joints from `joint` on.
fn first_dof(model: &Model, joint: usize) -> usize {
    model.joints.get(joint).map_or(model.nv, |joint| joint.dof)
}
