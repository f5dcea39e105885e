//! The tree kernels against dense algebra, and patterns against brute force.

use super::*;

struct Rng(u64);

impl Rng {
    fn unit(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }
}

fn random_tree(rng: &mut Rng, nv: usize) -> Tree {
    let parents: Vec<Option<usize>> = (0..nv)
        .map(|i| {
            if i == 0 || rng.unit() < 0.15 {
                None
            } else {
                Some(rng.below(i))
            }
        })
        .collect();
    Tree::new(&parents).unwrap()
}

/// Creates a diagonally dominant matrix in the pattern of the tree.
fn random_matrix(rng: &mut Rng, tree: &Tree) -> TreeMatrix<f64> {
    let mut matrix = TreeMatrix::zeros(tree);
    for i in 0..tree.nv() {
        for v in matrix.row_mut(tree, i) {
            *v = rng.unit() - 0.5;
        }
        matrix.row_mut(tree, i)[tree.depth(i)] = tree.nv() as f64;
    }
    matrix
}

fn dense_mul(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    matrix
        .chunks_exact(x.len())
        .map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum())
        .collect()
}

fn far(x: &[f64], y: &[f64]) -> f64 {
    x.iter()
        .zip(y)
        .map(|(x, y)| (x - y).abs())
        .fold(0.0, f64::max)
}

#[test]
fn products_and_solutions_equal_dense_ones() {
    let mut rng = Rng(1);
    for nv in 1..40 {
        let tree = random_tree(&mut rng, nv);
        let matrix = random_matrix(&mut rng, &tree);
        let dense = matrix.to_dense(&tree);
        let x: Vec<f64> = (0..nv).map(|_| rng.unit()).collect();
        let mut product = vec![f64::NAN; nv];
        matrix.mul(&tree, &x, &mut product);
        assert!(far(&product, &dense_mul(&dense, &x)) < 1e-12);
        let mut factor = TreeFactor::zeros(&tree);
        assert!(factor.factor(&tree, &matrix));
        let mut solution = x.clone();
        factor.solve(&tree, &mut solution);
        assert!(far(&dense_mul(&dense, &solution), &x) < 1e-12);
        let mut half = x.clone();
        factor.solve_half(&tree, &mut half);
        let squared: f64 = half.iter().map(|h| h * h).sum();
        let expected: f64 = x.iter().zip(&solution).map(|(a, b)| a * b).sum();
        assert!((squared - expected).abs() < 1e-13);
    }
}

#[test]
fn what_is_not_symmetric_is_solved_too() {
    let mut rng = Rng(7);
    for nv in 1..40 {
        let tree = random_tree(&mut rng, nv);
        let (lower, upper) = (
            random_matrix(&mut rng, &tree),
            random_matrix(&mut rng, &tree),
        );
        let mut dense = lower.to_dense(&tree);
        let mut lu = TreeLu::zeros(&tree);
        for i in 0..nv {
            let (row, column) = lu.dof_mut(&tree, i);
            row.copy_from_slice(lower.row(&tree, i));
            column.copy_from_slice(upper.row(&tree, i));
            for (&j, &value) in tree.row(i).iter().zip(upper.row(&tree, i)) {
                if j as usize != i {
                    dense[j as usize * nv + i] = value;
                }
            }
        }
        let right: Vec<f64> = (0..nv).map(|_| rng.unit()).collect();
        let mut solution = right.clone();
        assert!(lu.factor(&tree));
        lu.solve(&tree, &mut solution);
        assert!(far(&dense_mul(&dense, &solution), &right) < 1e-12);
    }
}

#[test]
fn a_factor_written_row_by_row_solves() {
    let mut rng = Rng(3);
    for nv in 1..40 {
        let tree = random_tree(&mut rng, nv);
        let mut matrix = TreeMatrix::zeros(&tree);
        let mut factor = TreeFactor::zeros(&tree);
        for k in 0..nv {
            // D_k l lᵀ, l the row of L.
            let pivot = 0.5 + rng.unit();
            let mut l = vec![0.0; nv];
            for &c in tree.row(k) {
                l[c as usize] = 0.6 * rng.unit() - 0.3;
            }
            l[k] = 1.0;
            for &i in tree.row(k) {
                let row = matrix.row_mut(&tree, i as usize);
                for (value, &c) in row.iter_mut().zip(tree.row(i as usize)) {
                    *value += pivot * l[i as usize] * l[c as usize];
                }
            }
            assert!(factor.set_row(&tree, k, pivot, |j| pivot * l[j]));
        }
        let x: Vec<f64> = (0..nv).map(|_| rng.unit()).collect();
        let mut solution = x.clone();
        factor.solve(&tree, &mut solution);
        let product = dense_mul(&matrix.to_dense(&tree), &solution);
        assert!(far(&product, &x) < 1e-11, "{nv}");
        assert!(!factor.set_row(&tree, 0, 0.0, |_| 0.0));
    }
}

#[test]
fn a_matrix_that_is_not_positive_is_reported() {
    let tree = Tree::dense(2);
    let matrix = TreeMatrix {
        values: vec![1.0, 2.0, 1.0],
    };
    assert!(!TreeFactor::<f64>::zeros(&tree).factor(&tree, &matrix));
}

#[test]
fn an_updated_factor_is_that_of_the_changed_matrix() {
    let mut rng = Rng(2);
    for nv in 1..40 {
        let tree = random_tree(&mut rng, nv);
        let mut matrix = random_matrix(&mut rng, &tree);
        let mut factor = TreeFactor::zeros(&tree);
        factor.factor(&tree, &matrix);
        for _ in 0..10 {
            let last = rng.below(nv);
            let sigma = if rng.unit() < 0.7 { 1.0 } else { -0.1 };
            let path: Vec<f64> = tree.row(last).iter().map(|_| rng.unit() - 0.5).collect();
            assert!(factor.update(&tree, last, &mut path.clone(), sigma));
            for (i, &dof) in tree.row(last).iter().enumerate() {
                for (c, v) in matrix.row_mut(&tree, dof as usize).iter_mut().enumerate() {
                    *v += sigma * path[i] * path[c];
                }
            }
        }
        let mut expected = TreeFactor::zeros(&tree);
        expected.factor(&tree, &matrix);
        let x: Vec<f64> = (0..nv).map(|_| rng.unit()).collect();
        let (mut a, mut b) = (x.clone(), x);
        factor.solve(&tree, &mut a);
        expected.solve(&tree, &mut b);
        assert!(far(&a, &b) < 1e-13);
    }
}

#[test]
fn a_downdate_that_consumes_a_pivot_is_reported() {
    let tree = Tree::dense(2);
    let mut factor = TreeFactor::<f64>::zeros(&tree);
    factor.factor(
        &tree,
        &TreeMatrix {
            values: vec![2.0, 1.0, 2.0],
        },
    );
    assert!(factor.clone().update(&tree, 1, &mut [0.0, 1.0], -1.0));
    assert!(!factor.clone().update(&tree, 1, &mut [0.0, 1.0], -1.5));
    assert!(!factor.update(&tree, 1, &mut [0.0, 1.0], -2.0));
}

#[test]
fn coupling_branches_holds_all_fill_and_no_path_that_is_not_needed() {
    let mut rng = Rng(3);
    let mut coupled = Tree::default();
    for round in 0..300 {
        let nv = 1 + round % 25;
        let tree = random_tree(&mut rng, nv);
        let mut couplings = Vec::new();
        let mut filled = vec![vec![false; nv]; nv];
        (0..nv).for_each(|i| {
            tree.row(i)
                .iter()
                .for_each(|&c| filled[i][c as usize] = true)
        });
        for _ in 0..rng.below(4) {
            let mut dofs: Vec<u32> = (0..1 + rng.below(4))
                .map(|_| rng.below(nv) as u32)
                .collect();
            dofs.sort_unstable();
            dofs.dedup();
            couplings.push(dofs.len() as u32);
            couplings.extend_from_slice(&dofs);
            for (k, &i) in dofs.iter().enumerate() {
                dofs[..=k]
                    .iter()
                    .for_each(|&c| filled[i as usize][c as usize] = true);
            }
        }
        // Eliminate by definition: row k couples every two of its columns.
        for k in (0..nv).rev() {
            let columns: Vec<usize> = (0..k).filter(|&c| filled[k][c]).collect();
            for &i in &columns {
                columns
                    .iter()
                    .filter(|&&c| c <= i)
                    .for_each(|&c| filled[i][c] = true);
            }
        }
        coupled.rebuild_coupled(
            &tree,
            &couplings,
            usize::MAX,
            &mut CouplingScratch::default(),
        );
        for k in 0..nv {
            let first = (0..k).rev().find(|&c| filled[k][c]);
            assert_eq!(
                coupled.parent(k),
                first,
                "the parent is the last column filled"
            );
            (0..k)
                .filter(|&c| filled[k][c])
                .for_each(|c| assert!(coupled.row(k).contains(&(c as u32))));
        }
    }
}

#[test]
fn descendants_are_listed() {
    let mut rng = Rng(4);
    for nv in 0..30 {
        let tree = random_tree(&mut rng, nv);
        for i in 0..nv {
            let below = (i + 1..nv).filter(|&k| tree.row(k).contains(&(i as u32)));
            let starts: Vec<u32> = below.map(|k| tree.row_start(k) as u32).collect();
            assert_eq!(tree.descendants(i), starts);
        }
    }
}
