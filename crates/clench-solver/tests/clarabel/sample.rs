//! Random problems with prescribed conditioning: the condition number of M and the range of D.

use crate::common::{Rng, humanoid, norm, random_forest};
use clench_solver::{Cost, Problem, Tree};
use std::sync::Arc;

/// The parameters of a random problem.
#[derive(Clone, Debug)]
pub struct Recipe {
    pub costs: Vec<Cost>,
    /// The condition number of M.
    pub mass: f64,
    /// The ratio of the largest to the smallest D among blocks.
    pub stiffness: f64,
    /// True if D is in units of the effective inertia of the block, as in softness formulas; otherwise it is unscaled.
    pub scaled: bool,
}

/// Draws a problem of 1 to 30 dofs and 1 to 12 blocks.
pub fn problem(rng: &mut Rng, recipe: &Recipe) -> Problem<f64> {
    let nv = 1 + rng.below(30);
    let parents = match rng.below(4) {
        0 => humanoid(),
        1 => (0..nv).map(|i| i.checked_sub(1)).collect(),
        _ => random_forest(rng, nv),
    };
    let tree = Arc::new(Tree::new(&parents).unwrap());
    let mut problem = Problem::new(tree);
    set_mass(rng, &mut problem, recipe.mass);
    for a in &mut problem.qacc_smooth {
        *a = rng.range(-10.0, 10.0);
    }
    let blocks = 1 + rng.below(12);
    let (softest, stiffest) = two_of(rng, blocks);
    for k in 0..blocks {
        let exponent = match k {
            k if k == softest => -0.5,
            k if k == stiffest => 0.5,
            _ => rng.range(-0.5, 0.5),
        };
        push(rng, recipe, &mut problem, recipe.stiffness.powf(exponent));
    }
    problem.check().unwrap();
    problem
}

/// Returns two different numbers below `n`, if there are two.
fn two_of(rng: &mut Rng, n: usize) -> (usize, usize) {
    let first = rng.below(n);
    (first, (first + 1 + rng.below(n.max(2) - 1)) % n)
}

/// Sets M = LᵀDL with the range of D at least the requested condition number (a lower bound on that of M), then adds
/// the multiple of the identity that reduces it to the requested one.
fn set_mass(rng: &mut Rng, problem: &mut Problem<f64>, condition: f64) {
    let tree = problem.tree().clone();
    let nv = tree.nv();
    let (lightest, heaviest) = two_of(rng, nv);
    for k in 0..nv {
        let exponent = match k {
            k if k == lightest => -0.5,
            k if k == heaviest => 0.5,
            _ => rng.range(-0.5, 0.5),
        };
        let d = condition.powf(exponent);
        let row = tree.row(k);
        let last = row.len() - 1;
        let l: Vec<f64> = (0..=last)
            .map(|j| if j == last { 1.0 } else { rng.range(-0.6, 0.6) })
            .collect();
        for (j, &i) in row.iter().enumerate() {
            let target = problem.mass.row_mut(&tree, i as usize);
            target
                .iter_mut()
                .zip(&l)
                .for_each(|(m, lc)| *m += d * l[j] * lc);
        }
    }
    let (low, high) = extreme_eigenvalues(problem);
    let shift = (high - condition * low) / (condition - 1.0).max(1e-3);
    for i in 0..nv {
        if let Some(diagonal) = problem.mass.row_mut(&tree, i).last_mut() {
            *diagonal += shift.max(0.0);
        }
    }
    assert!(problem.factor_mass());
}

/// Returns the smallest and largest eigenvalue of M, to a few percent, by power iteration.
pub fn extreme_eigenvalues(problem: &mut Problem<f64>) -> (f64, f64) {
    let tree = problem.tree().clone();
    let nv = tree.nv();
    assert!(problem.factor_mass());
    let grow = |multiply: &dyn Fn(&mut Vec<f64>)| {
        let mut x: Vec<f64> = (0..nv).map(|i| 1.0 + (i as f64 * 0.7).sin()).collect();
        let mut growth = 1.0;
        for _ in 0..60 {
            let before = norm(&x);
            x.iter_mut().for_each(|x| *x /= before);
            multiply(&mut x);
            growth = norm(&x);
        }
        growth
    };
    let high = grow(&|x| {
        let mut product = vec![0.0; nv];
        problem.mass.mul(&tree, x, &mut product);
        *x = product;
    });
    let low = 1.0 / grow(&|x| problem.mass_factor.solve(&tree, x));
    (low, high)
}

fn push(rng: &mut Rng, recipe: &Recipe, problem: &mut Problem<f64>, stiffness: f64) {
    let tree = problem.tree().clone();
    let nv = tree.nv();
    let cost = recipe.costs[rng.below(recipe.costs.len())];
    let dim = match cost {
        Cost::Quadratic => [1, 3, 6][rng.below(3)],
        Cost::OneSided | Cost::Huber => [1, 1, 3][rng.below(3)],
        Cost::Pyramid | Cost::Elliptic => [2, 3, 4, 6][rng.below(4)],
        Cost::Coulomb => unreachable!("Coulomb's law is not a convex problem"),
    };
    let mut dofs = tree.row(rng.below(nv)).to_vec();
    if rng.unit() < 0.3 {
        dofs.extend_from_slice(tree.row(rng.below(nv)));
        dofs.sort_unstable();
        dofs.dedup();
    }
    let mut jacobian: Vec<f64> = (0..dim * dofs.len())
        .map(|_| rng.range(-1.0, 1.0))
        .collect();
    if problem.nblock() > 0 && rng.unit() < 0.1 {
        // Repeats the rows: contacts of one face are redundant.
        let other = problem.block(rng.below(problem.nblock()));
        if other.dim == dim {
            dofs = other.dofs.to_vec();
            jacobian = other.jacobian.to_vec();
        }
    }
    let unit = if recipe.scaled {
        1.0 / inverse_inertia(problem, &dofs, &jacobian[..dofs.len()])
    } else {
        1.0
    };
    let block = problem.push(cost, dim, &dofs);
    block.jacobian.copy_from_slice(&jacobian);
    block
        .aref
        .iter_mut()
        .for_each(|aref| *aref = rng.range(-20.0, 20.0));
    block.d.fill(stiffness * unit);
    match cost {
        Cost::Huber => block
            .shape
            .iter_mut()
            .for_each(|eta| *eta = rng.scale(1e-2, 1e2)),
        Cost::Pyramid | Cost::Elliptic => {
            block.shape[1..]
                .iter_mut()
                .for_each(|mu| *mu = rng.scale(0.05, 2.0));
        }
        Cost::Quadratic | Cost::OneSided => {}
        Cost::Coulomb => unreachable!("Coulomb's law is not a convex problem"),
    }
    if cost == Cost::Elliptic {
        // The coefficient is divided by the square root of impratio.
        block.shape[0] = block.shape[1] / rng.scale(0.3, 10.0);
        for j in 1..dim {
            block.d[j] = block.d[0] * (block.shape[j] / block.shape[0]).powi(2);
        }
    }
    for (r, d) in block.r.iter_mut().zip(&*block.d) {
        *r = 1.0 / d;
    }
}

/// Returns J M⁻¹ Jᵀ of one row.
fn inverse_inertia(problem: &Problem<f64>, dofs: &[u32], row: &[f64]) -> f64 {
    let mut x = vec![0.0; problem.nv()];
    for (&dof, &j) in dofs.iter().zip(row) {
        x[dof as usize] = j;
    }
    let j = x.clone();
    problem.mass_factor.solve(problem.tree(), &mut x);
    x.iter().zip(&j).map(|(x, j)| x * j).sum()
}
