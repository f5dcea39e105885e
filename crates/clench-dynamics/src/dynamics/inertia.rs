//! The joint-space mass matrix by composite rigid bodies (Featherstone 2008, §6.2).
//!
//! If only dof i moves, all bodies below it move as one rigid body of inertia `crb`. The momentum crb · cdof_i
//! projected onto an ancestor dof j is M_ij; dofs on different branches are not coupled.

use crate::dynamics::reflected::dof_armature;
use crate::model::{Model, Params};
use crate::stages::Positions;
use clench_math::{Real, kernel};
use clench_solver::TreeMatrix;

/// Computes `crb` and the mass matrix, including armature.
#[kernel]
pub fn composite_inertia<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &mut Positions<T>,
    mass: &mut TreeMatrix<T>,
) {
    pos.crb.copy_from_slice(&pos.cinert);
    for b in (1..model.nbody()).rev() {
        let parent = model.bodies[b].parent;
        if parent != 0 {
            let inertia = pos.crb[b];
            pos.crb[parent] += inertia;
        }
    }
    for (i, dof) in model.dofs.iter().enumerate() {
        let momentum = pos.crb[dof.body] * pos.cdof[i];
        let row = mass.row_mut(&model.tree, i);
        for (entry, &j) in row.iter_mut().zip(model.tree.row(i)) {
            *entry = pos.cdof[j as usize].dot(momentum);
        }
        if let Some(diagonal) = row.last_mut() {
            *diagonal += dof_armature(model, params, i);
        }
    }
}
