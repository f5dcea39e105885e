//! Location of the singularity of a mass matrix.

use clench_solver::Tree;

/// Returns the dof at which the factorization LᵀDL, from the last dof to the first, meets the first pivot that is not
/// positive: the last dof without mass or inertia of its own. `values` is the matrix in the pattern of the tree.
pub fn first_bad_pivot(tree: &Tree, mut values: Vec<f64>) -> Option<usize> {
    for dof in (0..tree.nv()).rev() {
        let (start, end) = (tree.row_start(dof), tree.row_start(dof + 1));
        let pivot = values[end - 1];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return Some(dof);
        }
        // The row of an ancestor is as long as its index in this row, and lists the same dofs.
        for (place, &ancestor) in tree.row(dof).iter().enumerate().take(end - 1 - start) {
            let multiplier = values[start + place] / pivot;
            let above = tree.row_start(ancestor as usize);
            for k in 0..=place {
                values[above + k] -= multiplier * values[start + k];
            }
        }
    }
    None
}
