//! The joint-space mass matrix by composite rigid bodies (Featherstone 2008, §6.2).
//!
//! If only dof i moves, all bodies below it move as one rigid body of inertia `crb`. The momentum crb · cdof_i
//! projected onto an ancestor dof j is M_ij; dofs on different branches are not coupled.

use crate::dynamics::reflected::dof_armature;
use crate::model::{Model, Params};
use crate::part::Part;
use crate::stages::Positions;
use clench_math::{Real, kernel};
use clench_solver::TreeMatrix;

/// Computes `crb` and the mass matrix of some parts, including armature.
#[kernel]
pub fn composite_inertia<T: Real>(
    model: &Model,
    params: &Params<T>,
    parts: &[Part],
    pos: &mut Positions<T>,
    mass: &mut TreeMatrix<T>,
) {
    for part in parts {
        let bodies = part.bodies.clone();
        pos.crb[bodies.clone()].copy_from_slice(&pos.cinert[bodies.clone()]);
        for b in bodies.rev() {
            let parent = model.bodies[b].parent;
            if parent != 0 {
                let inertia = pos.crb[b];
                pos.crb[parent] += inertia;
            }
        }
        for i in part.dofs.clone() {
            let momentum = pos.crb[model.dofs[i].body] * pos.cdof[i];
            let row = mass.row_mut(&model.tree, i);
            for (entry, &j) in row.iter_mut().zip(model.tree.row(i)) {
                *entry = pos.cdof[j as usize].dot(momentum);
            }
            if let Some(diagonal) = row.last_mut() {
                *diagonal += dof_armature(model, params, i);
            }
        }
    }
}
