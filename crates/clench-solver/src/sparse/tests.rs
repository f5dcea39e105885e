//! The sparse factor against that over whole paths, and the pattern against elimination itself.

use super::*;
use crate::jacobian::Pattern;
use crate::threads::Threads;
use crate::tree::{CouplingScratch, Tree, TreeFactor, TreeMatrix};
use std::collections::BTreeSet;

struct Rng(u64);

impl Rng {
    fn unit(&mut self) -> f64 {
        self.0 = (self.0)
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }
}

/// Creates a forest of chains and branches, and couplings between any of its dofs.
fn random_scene(rng: &mut Rng, nv: usize, couplings: usize) -> (Tree, Vec<u32>) {
    let parents = Vec::from_iter((0..nv).map(|i| match rng.unit() {
        x if i == 0 || x < 0.2 => None,
        x if x < 0.8 => Some(i - 1),
        _ => Some(rng.below(i)),
    }));
    let tree = Tree::new(&parents).unwrap();
    let mut list = Vec::new();
    for _ in 0..couplings {
        let ends = [rng.below(nv), rng.below(nv)];
        let dofs = BTreeSet::from_iter(ends.iter().flat_map(|&dof| tree.row(dof)));
        list.push(dofs.len() as u32);
        list.extend(dofs);
    }
    (tree, list)
}

/// Calls `act` with the dofs of each coupling.
fn each(mut couplings: &[u32], mut act: impl FnMut(&[u32])) {
    while let Some((&count, rest)) = couplings.split_first() {
        let (dofs, rest) = rest.split_at(count as usize);
        act(dofs);
        couplings = rest;
    }
}

/// Adds a matrix over some dofs.
fn add(
    pattern: &impl Pattern,
    dofs: &[u32],
    values: &mut [f64],
    entry: impl Fn(usize, usize) -> f64,
) {
    pattern.each_part(dofs, |part| {
        for row in part.rows.clone() {
            let (columns, place) = part.row(row);
            for (k, column) in columns.enumerate() {
                values[place + k] += entry(row, column);
            }
        }
    });
}

/// Writes M + Σ w jᵀj with random numbers into a pattern.
fn fill(rng: &mut Rng, scene: &(Tree, Vec<u32>), pattern: &impl Pattern, values: &mut [f64]) {
    let (tree, couplings) = scene;
    for dof in 0..tree.nv() {
        let last = tree.row(dof).len() - 1;
        let row = Vec::from_iter(tree.row(dof).iter().map(|_| rng.unit() - 0.5));
        add(pattern, tree.row(dof), values, |k, c| match (k, c) {
            _ if k < last => 0.0,
            _ if c == last => 60.0,
            _ => row[c],
        });
    }
    each(couplings, |dofs| {
        let j = Vec::from_iter(dofs.iter().map(|_| rng.unit() - 0.5));
        add(pattern, dofs, values, |k, c| j[k] * j[c]);
    });
}

#[test]
fn factors_solutions_and_updates_equal_those_over_paths_to_the_bit() {
    let mut rng = Rng(5);
    let threads = [1, 2, 3].map(|count| Threads::new(count).unwrap());
    let mut pattern = SparsePattern::default();
    for k in 0..200 {
        let scene = random_scene(&mut rng, 1 + k / 2, k % 30);
        let (tree, couplings) = &scene;
        let mut coupled = Tree::default();
        assert!(coupled.rebuild_coupled(
            tree,
            couplings,
            usize::MAX,
            &mut CouplingScratch::default()
        ));
        let mut matrix = TreeMatrix::zeros(&coupled);
        fill(&mut Rng(k as u64), &scene, &coupled, &mut matrix.values);
        let mut paths = TreeFactor::zeros(&coupled);
        paths.factor_safely(&coupled, &matrix);

        assert!(pattern.analyse(tree, couplings, usize::MAX));
        let mut sparse = SparseFactor::default();
        sparse.resize(&pattern);
        sparse.values_mut().fill(0.0);
        fill(
            &mut Rng(k as u64),
            &scene,
            &Window::whole(&pattern),
            sparse.values_mut(),
        );
        sparse.factor_safely(&pattern, &threads[k % 3]);

        let x = Vec::from_iter((0..tree.nv()).map(|_| rng.unit()));
        for sigma in [0.0, 0.7] {
            each(couplings, |dofs| {
                let last = *dofs.last().unwrap() as usize;
                let mut along = vec![0.0; coupled.depth(last) + 1];
                let mut whole = vec![0.0; tree.nv()];
                for &dof in dofs {
                    let value = rng.unit();
                    along[coupled.depth(dof as usize)] = value;
                    whole[dof as usize] = value;
                }
                assert!(paths.update(&coupled, last, &mut along, sigma));
                assert!(sparse.update(&pattern, last, &mut whole, sigma));
                assert!(whole.iter().all(|&x| x == 0.0));
            });
            let (mut one, mut other) = (x.clone(), x.clone());
            paths.solve(&coupled, &mut one);
            sparse.solve(&pattern, &mut other);
            assert_eq!(one, other, "scene {k}");
        }
    }
}

#[test]
fn the_pattern_holds_what_is_filled_and_no_more() {
    let mut rng = Rng(9);
    for k in 0..100 {
        let (tree, couplings) = random_scene(&mut rng, 1 + k, k % 20);
        let nv = tree.nv();
        let mut rows = vec![BTreeSet::new(); nv];
        for dof in 0..nv {
            rows[dof].extend(tree.row(dof));
        }
        each(&couplings, |dofs| {
            (0..dofs.len()).for_each(|k| rows[dofs[k] as usize].extend(&dofs[..=k]));
        });
        for dof in (0..nv).rev() {
            let columns = Vec::from_iter(rows[dof].iter().copied().filter(|&c| c != dof as u32));
            for (place, &column) in columns.iter().enumerate() {
                rows[column as usize].extend(&columns[..place]);
            }
        }
        let mut pattern = SparsePattern::default();
        assert!(pattern.analyse(&tree, &couplings, usize::MAX));
        for dof in 0..nv {
            let s = pattern.supernode_of(dof);
            let own = s.first as u32..=dof as u32;
            let stored = BTreeSet::from_iter(pattern.columns(s).iter().copied().chain(own));
            assert_eq!(stored, rows[dof], "scene {k}, row {dof}");
        }
        assert!(!pattern.analyse(&tree, &couplings, pattern.nnz() - 1));
    }
}
