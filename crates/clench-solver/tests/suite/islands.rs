//! Solving by islands changes the work but not the result.

use crate::common::*;
use clench_math::{Lanes, Real};
use clench_solver::{Cost, Problem, Solver, SolverOptions, Status, Switch};
use std::collections::BTreeSet;

fn scenes(count: usize) -> impl Iterator<Item = Problem<f64>> {
    let mut rng = Rng(3);
    (0..count).map(move |k| {
        // Many small trees. More couplings in each scene: islands of several trees and free trees at first, one island
        // at the end.
        let parents = (0..30)
            .map(|i: usize| {
                if i.is_multiple_of(3) {
                    None
                } else {
                    Some(i - 1)
                }
            })
            .collect();
        let mut shape = Shape::new(parents, 1 + k % 24);
        shape.cross = 0.4;
        random_problem(&mut rng, &shape)
    })
}

fn options(islands: Switch) -> SolverOptions {
    SolverOptions::new()
        .tolerance(0.0)
        .iterations(200)
        .islands(islands)
}

fn solve(problem: &Problem<f64>, options: SolverOptions) -> Solver<f64> {
    let mut solver = Solver::new(problem.tree());
    solver
        .solve(problem, &options.resolve::<f64>(), None)
        .unwrap();
    solver
}

#[test]
fn islands_and_the_whole_problem_agree() {
    let mut large = 0;
    for (k, problem) in scenes(200).enumerate() {
        let on = solve(&problem, options(Switch::On));
        let off = solve(&problem, options(Switch::Off));
        assert!(difference(on.qacc(), off.qacc()) < 1e-9, "scene {k}");
        let tree = problem.tree();
        let coupled: BTreeSet<usize> = (problem.blocks())
            .flat_map(|block| block.dofs.iter().map(|&dof| tree.tree_of(dof as usize)))
            .collect();
        large += u32::from(coupled.len() > 8 && on.stats().lane(0).islands == 1);
        assert!(
            difference(on.qfrc_constraint(), off.qfrc_constraint()) < 1e-8,
            "scene {k}"
        );
        assert!(difference(on.force(), off.force()) < 1e-8, "scene {k}");
        for block in 0..problem.nblock() {
            assert!(
                difference(
                    on.edge_forces(&problem, block),
                    off.edge_forces(&problem, block)
                ) < 1e-7,
                "scene {k}"
            );
        }
    }
    assert!(
        large > 5,
        "{large} scenes were one island of nearly all trees"
    );
}

#[test]
fn free_trees_are_untouched_and_islands_counted() {
    for problem in scenes(50) {
        let solver = solve(&problem, options(Switch::Auto));
        // Merges islands independently: relabels trees until nothing changes.
        let tree = problem.tree();
        let mut label: Vec<usize> = (0..tree.ntree()).collect();
        let mut touched = vec![false; tree.ntree()];
        for _ in 0..tree.ntree() {
            for block in problem.blocks() {
                let trees: Vec<usize> = block
                    .dofs
                    .iter()
                    .map(|&dof| tree.tree_of(dof as usize))
                    .collect();
                let lowest = trees.iter().map(|&t| label[t]).min().unwrap();
                for t in trees {
                    label[t] = lowest;
                    touched[t] = true;
                }
            }
        }
        let mut islands: Vec<usize> = (0..tree.ntree())
            .filter(|&t| touched[t])
            .map(|t| label[t])
            .collect();
        islands.sort_unstable();
        islands.dedup();
        assert_eq!(solver.stats().lane(0).islands, islands.len());
        for dof in 0..problem.nv() {
            if !touched[tree.tree_of(dof)] {
                assert_eq!(solver.qacc()[dof], problem.qacc_smooth[dof]);
                assert_eq!(solver.qfrc_constraint()[dof], 0.0);
            }
        }
    }
}

#[test]
fn each_island_is_as_if_alone() {
    for problem in scenes(50) {
        // Solves again without the island of one tree: the remaining islands must have the same bits.
        let all = solve(&problem, options(Switch::On));
        let gone = problem.tree().tree_of(problem.block(0).dofs[0] as usize);
        let mut rest = Problem::new(problem.tree().clone());
        rest.mass = problem.mass.clone();
        rest.factor_mass();
        rest.qacc_smooth = problem.qacc_smooth.clone();
        let tree = problem.tree();
        let mut island = vec![gone];
        for _ in 0..tree.ntree() {
            for block in problem.blocks() {
                let trees: Vec<usize> = block
                    .dofs
                    .iter()
                    .map(|&dof| tree.tree_of(dof as usize))
                    .collect();
                if trees.iter().any(|t| island.contains(t)) {
                    island.extend(trees);
                }
            }
        }
        for block in problem
            .blocks()
            .filter(|b| !island.contains(&tree.tree_of(b.dofs[0] as usize)))
        {
            let copy = rest.push(block.cost, block.dim, block.dofs);
            copy.jacobian.copy_from_slice(block.jacobian);
            copy.aref.copy_from_slice(block.aref);
            copy.r.copy_from_slice(block.r);
            copy.d.copy_from_slice(block.d);
            copy.shape.copy_from_slice(block.shape);
        }
        let less = solve(&rest, options(Switch::On));
        for dof in (0..problem.nv()).filter(|&dof| !island.contains(&tree.tree_of(dof))) {
            assert_eq!(all.qacc()[dof], less.qacc()[dof]);
        }
    }
}

#[test]
fn lanes_with_different_islands_equal_scalars() {
    let settings = SolverOptions::new().resolve::<f64>();
    for problem in scenes(30) {
        let mut packed: Problem<Lanes<f64, 4>> = Problem::new(problem.tree().clone());
        let mut alone: Vec<Problem<f64>> = (0..4)
            .map(|_| Problem::new(problem.tree().clone()))
            .collect();
        for (lane, alone) in alone.iter_mut().enumerate() {
            for (to, &from) in packed.mass.values.iter_mut().zip(&problem.mass.values) {
                to.set_lane(lane, from);
            }
            for (to, &from) in packed.qacc_smooth.iter_mut().zip(&problem.qacc_smooth) {
                to.set_lane(lane, from + lane as f64);
            }
            alone.mass = problem.mass.clone();
            alone.factor_mass();
            alone.qacc_smooth = problem
                .qacc_smooth
                .iter()
                .map(|a| a + lane as f64)
                .collect();
        }
        packed.factor_mass();
        for (k, block) in problem.blocks().enumerate() {
            let slot = packed.push(block.cost, block.dim, block.dofs);
            for (lane, alone) in alone
                .iter_mut()
                .enumerate()
                .filter(|(lane, _)| (k + lane) % 3 > 0)
            {
                let copy = alone.push(block.cost, block.dim, block.dofs);
                for (slot, copy, from) in [
                    (&mut *slot.jacobian, copy.jacobian, block.jacobian),
                    (&mut *slot.aref, copy.aref, block.aref),
                    (&mut *slot.r, copy.r, block.r),
                    (&mut *slot.d, copy.d, block.d),
                    (&mut *slot.shape, copy.shape, block.shape),
                ] {
                    copy.copy_from_slice(from);
                    slot.iter_mut()
                        .zip(from)
                        .for_each(|(slot, &from)| slot.set_lane(lane, from));
                }
            }
        }
        let mut together = Solver::new(packed.tree());
        let stats = *together.solve(&packed, &settings, None).unwrap();
        for (lane, problem) in alone.iter().enumerate() {
            let mut single = Solver::new(problem.tree());
            assert_eq!(
                stats.lane(lane),
                single.solve(problem, &settings, None).unwrap().lane(0)
            );
            let qacc: Vec<f64> = together.qacc().iter().map(|a| a.lane(lane)).collect();
            assert_eq!(qacc, single.qacc());
        }
    }
}

#[test]
fn a_scene_without_acting_constraints_is_unconstrained() {
    let mut problem = scenes(1).next().unwrap();
    problem.clear_constraints();
    problem.push(Cost::OneSided, 1, &[0]);
    let solver = solve(&problem, options(Switch::Auto));
    assert_eq!(solver.stats().status(0), Status::Unconstrained);
    assert_eq!(solver.qacc(), problem.qacc_smooth);
}
