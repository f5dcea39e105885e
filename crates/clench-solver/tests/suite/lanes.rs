//! Problems solved in lanes give, to the bit, the results of separate solves.

use crate::common::*;
use clench_math::{Lanes, Real, Scalar};
use clench_solver::{
    Block, ConstraintSolver, Cost, Problem, Solver, SolverOptions, Status, Switch, Tree,
};

const N: usize = 4;

/// The fraction of blocks that are absent in a lane.
const ABSENT: f64 = 0.3;

/// Returns N problems of one structure, packed and separate. Each block is absent from a lane with probability
/// `absent`.
fn pack<S: Scalar>(
    rng: &mut Rng,
    shape: &Shape,
    absent: f64,
) -> (Problem<Lanes<S, N>>, Vec<Problem<S>>) {
    let seed = rng.bits();
    // The template fixes the structure; the numbers of each lane are drawn separately.
    let template = random_problem(&mut Rng(seed), shape);
    let mut packed: Problem<Lanes<S, N>> = Problem::new(template.tree().clone());
    let mut alone: Vec<Problem<S>> = (0..N)
        .map(|_| Problem::new(template.tree().clone()))
        .collect();
    let number = |x: f64| S::new(x);
    for (lane, alone) in alone.iter_mut().enumerate() {
        let other = random_problem(
            &mut Rng(rng.bits()),
            &Shape {
                blocks: 0,
                ..shape.clone()
            },
        );
        for (k, &m) in other.mass.values.iter().enumerate() {
            packed.mass.values[k].set_lane(lane, number(m));
            alone.mass.values[k] = number(m);
        }
        for (k, &a) in other.qacc_smooth.iter().enumerate() {
            packed.qacc_smooth[k].set_lane(lane, number(a));
            alone.qacc_smooth[k] = number(a);
        }
        assert!(alone.factor_mass());
    }
    packed.factor_mass();
    for block in template.blocks() {
        let slot = packed.push(block.cost, block.dim, block.dofs);
        for (lane, alone) in alone.iter_mut().enumerate() {
            if rng.unit() < absent {
                // Inactive: D is zero, and the other values are leftovers, which need only be finite.
                slot.r
                    .iter_mut()
                    .for_each(|r| r.set_lane(lane, number(3.0)));
                slot.aref
                    .iter_mut()
                    .for_each(|r| r.set_lane(lane, number(-7.0)));
                slot.jacobian
                    .iter_mut()
                    .for_each(|j| j.set_lane(lane, number(0.5)));
                continue;
            }
            let copy = alone.push(block.cost, block.dim, block.dofs);
            let stretch = rng.scale(0.2, 5.0);
            let fill = |to: &mut [Lanes<S, N>], copy: &mut [S], from: &[f64], factor: f64| {
                for ((to, copy), &x) in to.iter_mut().zip(copy).zip(from) {
                    *copy = number(x * factor);
                    to.set_lane(lane, *copy);
                }
            };
            fill(slot.jacobian, copy.jacobian, block.jacobian, 1.0 / stretch);
            fill(slot.aref, copy.aref, block.aref, rng.range(-1.0, 1.0));
            fill(slot.r, copy.r, block.r, 1.0 / stretch);
            fill(slot.d, copy.d, block.d, stretch);
            fill(slot.shape, copy.shape, block.shape, 1.0);
        }
    }
    (packed, alone)
}

fn same<S: Scalar>(packed: &[Lanes<S, N>], lane: usize, alone: &[S], what: &str) {
    let packed: Vec<f64> = packed.iter().map(|x| x.lane(lane).to_f64()).collect();
    let alone: Vec<f64> = alone.iter().map(|x| x.to_f64()).collect();
    assert_eq!(packed, alone, "{what}");
}

/// Compares humanoids and forests, without islands.
fn compare<S: Scalar>(options: SolverOptions, costs: &[Cost], rounds: usize) {
    let options = options.islands(Switch::Off);
    compare_on::<S>(options, costs, rounds, ABSENT, |rng, round| {
        let forest = random_forest(rng, 17);
        Shape::new(if round % 2 == 0 { humanoid() } else { forest }, 12)
    });
}

/// Solves problems of many shapes in lanes and separately. Returns the number of rounds in which lanes had different
/// numbers of islands.
fn compare_on<S: Scalar>(
    options: SolverOptions,
    costs: &[Cost],
    rounds: usize,
    absent: f64,
    mut shape: impl FnMut(&mut Rng, usize) -> Shape,
) -> usize {
    let mut rng = Rng(11);
    let settings = options.resolve::<S>();
    // One solver for all problems, so that leftovers of one would show in the next.
    let mut together = Solver::new(&Tree::dense(0));
    let mut different = 0;
    for round in 0..rounds {
        let mut shape = shape(&mut rng, round);
        shape.costs = costs.to_vec();
        shape.stiffness = if round % 5 == 4 {
            (1e3, 1e9)
        } else {
            (1.0, 300.0)
        };
        let (packed, alone) = pack::<S>(&mut rng, &shape, absent);
        let warm: Vec<Lanes<S, N>> = (0..packed.nv())
            .map(|_| Lanes::from_fn(|_| S::new(rng.range(-10.0, 10.0))))
            .collect();
        let stats = *together.solve(&packed, &settings, Some(&warm)).unwrap();
        for (lane, problem) in alone.iter().enumerate() {
            let warm: Vec<S> = warm.iter().map(|w| w.lane(lane)).collect();
            let mut single = Solver::new(problem.tree());
            let expected = single
                .solve(problem, &settings, Some(&warm))
                .unwrap()
                .lane(0);
            let name = format!("round {round} lane {lane} {expected:?}");
            assert_eq!(stats.lane(lane), expected, "{name}");
            compare_results(&packed, &together, lane, problem, &single, &name);
        }
        let islands = |lane| stats.lane(lane).islands;
        different += usize::from((1..N).any(|lane| islands(lane) != islands(0)));
    }
    different
}

fn compare_results<S: Scalar>(
    packed: &Problem<Lanes<S, N>>,
    together: &Solver<Lanes<S, N>>,
    lane: usize,
    alone: &Problem<S>,
    single: &Solver<S>,
    name: &str,
) {
    same(together.qacc(), lane, single.qacc(), name);
    let (qfrc, expected) = (together.qfrc_constraint(), single.qfrc_constraint());
    same(qfrc, lane, expected, name);
    compare_forces(packed, together, lane, alone, single, name);
}

/// Compares the forces of each block, skipping those absent from the lane.
fn compare_forces<S: Scalar>(
    packed: &Problem<Lanes<S, N>>,
    together: &Solver<Lanes<S, N>>,
    lane: usize,
    alone: &Problem<S>,
    single: &Solver<S>,
    name: &str,
) {
    let mut next = 0;
    let exists = |b: &Block<Lanes<S, N>>| b.d[0].lane(lane) > S::ZERO;
    for (k, block) in packed.blocks().enumerate() {
        let force = &together.force()[block.rows()];
        if !exists(&block) {
            assert!(force.iter().all(|f| f.lane(lane) == S::ZERO), "{name}");
            continue;
        }
        same(force, lane, &single.force()[alone.block(next).rows()], name);
        same(
            together.edge_forces(packed, k),
            lane,
            single.edge_forces(alone, next),
            name,
        );
        next += 1;
    }
}

fn options() -> SolverOptions {
    SolverOptions::new()
}

#[test]
fn newton_in_lanes_equals_scalars_on_all_costs() {
    compare::<f64>(options(), &ALL_COSTS, 40);
}

#[test]
fn newton_in_lanes_equals_scalars_on_pyramids_to_the_working_precision() {
    compare::<f64>(
        options().tolerance(0.0),
        &[Cost::Pyramid, Cost::OneSided],
        40,
    );
}

#[test]
fn newton_in_lanes_equals_scalars_on_cones_to_the_working_precision() {
    compare::<f64>(options().tolerance(0.0), &[Cost::Elliptic], 40);
}

#[test]
fn coulombs_law_in_lanes_equals_scalars() {
    let costs = [Cost::Coulomb, Cost::OneSided];
    compare::<f64>(options(), &costs, 40);
    compare::<f64>(options().tolerance(0.0), &costs, 20);
    compare::<f32>(options(), &costs, 40);
    compare::<f64>(options().noslip_iterations(10), &costs, 20);
    compare_islands::<f64>(options(), &costs, 20);
    let cg = options().constraint_solver(ConstraintSolver::Cg);
    compare::<f64>(cg.iterations(100), &costs, 20);
}

#[test]
fn dense_newton_in_lanes_equals_scalars() {
    compare::<f64>(options().sparse_solve(Switch::Off), &ALL_COSTS, 10);
}

#[test]
fn sparse_newton_in_lanes_equals_scalars() {
    compare::<f64>(options().sparse_solve(Switch::On), &ALL_COSTS, 10);
}

#[test]
fn newton_cut_short_in_lanes_equals_scalars() {
    compare::<f64>(options().iterations(2).ls_iterations(2), &ALL_COSTS, 40);
}

#[test]
fn conjugate_gradients_in_lanes_equal_scalars() {
    compare::<f64>(
        options()
            .constraint_solver(ConstraintSolver::Cg)
            .iterations(100),
        &ALL_COSTS,
        20,
    );
    // To the working precision: stalled lanes restart while the others continue.
    let options = options()
        .constraint_solver(ConstraintSolver::Cg)
        .tolerance(0.0);
    compare::<f64>(options, &ALL_COSTS, 20);
    compare::<f32>(options, &ALL_COSTS, 20);
}

#[test]
fn noslip_in_lanes_equals_scalars() {
    compare::<f64>(options().noslip_iterations(10), &ALL_COSTS, 20);
    compare::<f64>(
        options().noslip_iterations(100).noslip_tolerance(1e-3),
        &[Cost::Elliptic],
        20,
    );
}

#[test]
fn single_precision_in_lanes_equals_scalars() {
    compare::<f32>(options(), &ALL_COSTS, 40);
    compare::<f32>(options().tolerance(0.0), &ALL_COSTS, 20);
}

#[test]
fn a_failing_lane_disturbs_no_other() {
    let mut rng = Rng(5);
    let settings = options().resolve::<f64>();
    let (mut packed, alone) = pack::<f64>(&mut rng, &Shape::new(humanoid(), 10), ABSENT);
    packed.qacc_smooth[3].set_lane(2, f64::NAN);
    let mut together = Solver::new(packed.tree());
    let stats = *together.solve(&packed, &settings, None).unwrap();
    assert_eq!(stats.lane(2).status, Status::NonFinite);
    for lane in [0, 1, 3] {
        let mut single = Solver::new(alone[lane].tree());
        let expected = single.solve(&alone[lane], &settings, None).unwrap().lane(0);
        assert_eq!(stats.lane(lane), expected);
        same(together.qacc(), lane, single.qacc(), "qacc");
    }
}

/// Returns an arm of six dofs and a free body.
fn arm_and_body(rng: &mut Rng, _: usize) -> Shape {
    let parents = (0..12)
        .map(|i: usize| (!i.is_multiple_of(6)).then(|| i - 1))
        .collect();
    let mut shape = Shape::new(parents, 1 + rng.below(8));
    shape.cross = 0.3;
    shape
}

/// Returns many small trees: few couplings at first, then islands of several trees, large ones at the end.
fn many_trees(_: &mut Rng, round: usize) -> Shape {
    let parents = (0..36)
        .map(|i: usize| (!i.is_multiple_of(3)).then(|| i - 1))
        .collect();
    let mut shape = Shape::new(parents, 1 + 2 * (round % 20));
    shape.cross = 0.4;
    shape
}

/// Returns trees whose dofs alternate.
fn tangled_trees(rng: &mut Rng, _: usize) -> Shape {
    let parents = (0..18).map(|i: usize| i.checked_sub(3)).collect();
    Shape::new(parents, 1 + rng.below(6))
}

/// Compares all shapes with islands. Lanes have different islands in many rounds, and the same large ones if few blocks
/// are absent.
fn compare_islands<S: Scalar>(options: SolverOptions, costs: &[Cost], rounds: usize) {
    assert!(options.islands.is_none());
    for (islands, absent) in [(Switch::Auto, ABSENT), (Switch::On, 0.02)] {
        let options = options.islands(islands);
        let two = compare_on::<S>(options, costs, rounds, absent, arm_and_body);
        let many = compare_on::<S>(options, costs, rounds, absent, many_trees);
        let tangled = compare_on::<S>(options, costs, rounds / 2, absent, tangled_trees);
        let different = [two, many, tangled];
        let enough = |&d: &usize| 5 * d >= rounds || absent < ABSENT;
        assert!(different.iter().all(enough), "{different:?} of {rounds}");
    }
}

#[test]
fn newton_solves_the_islands_of_each_lane_as_alone() {
    compare_islands::<f64>(options(), &ALL_COSTS, 40);
    compare_islands::<f64>(options().tolerance(0.0), &[Cost::Elliptic], 20);
    compare_islands::<f64>(options().tolerance(0.0), &[Cost::Pyramid], 20);
    compare_islands::<f64>(options().sparse_solve(Switch::Off), &ALL_COSTS, 20);
    compare_islands::<f64>(options().iterations(2).ls_iterations(2), &ALL_COSTS, 20);
}

#[test]
fn conjugate_gradients_solve_the_islands_of_each_lane_as_alone() {
    let options = options().constraint_solver(ConstraintSolver::Cg);
    compare_islands::<f64>(options, &ALL_COSTS, 20);
    compare_islands::<f32>(options, &ALL_COSTS, 20);
}

#[test]
fn noslip_solves_the_islands_of_each_lane_as_alone() {
    compare_islands::<f64>(options().noslip_iterations(10), &ALL_COSTS, 20);
    compare_islands::<f64>(
        options().noslip_iterations(50).noslip_tolerance(1e-3),
        &[Cost::Elliptic, Cost::Huber, Cost::OneSided],
        20,
    );
    compare_islands::<f32>(options().noslip_iterations(10), &[Cost::Pyramid], 20);
}

#[test]
fn single_precision_solves_the_islands_of_each_lane_as_alone() {
    compare_islands::<f32>(options(), &ALL_COSTS, 40);
    compare_islands::<f32>(options().tolerance(0.0), &ALL_COSTS, 20);
}

#[test]
fn a_lane_that_fails_disturbs_no_island_of_the_others() {
    let mut rng = Rng(23);
    let settings = options().resolve::<f64>();
    let mut together = Solver::new(&Tree::dense(0));
    let mut failed = 0;
    for round in 0..120 {
        let shape = match round % 3 {
            0 => arm_and_body(&mut rng, round),
            1 => many_trees(&mut rng, round),
            _ => tangled_trees(&mut rng, round),
        };
        let (mut packed, alone) = pack::<f64>(&mut rng, &shape, ABSENT);
        let bad = rng.below(N);
        let number = [f64::NAN, f64::INFINITY, 1e300][rng.below(3)];
        match rng.below(4) {
            0 => packed.qacc_smooth[rng.below(12)].set_lane(bad, number),
            1 => packed.mass.values[rng.below(12)].set_lane(bad, number),
            2 => packed
                .mass
                .values
                .iter_mut()
                .for_each(|m| m.set_lane(bad, 0.0)),
            _ => {
                let block = packed.block(rng.below(packed.nblock()));
                let (cost, dim, dofs) = (block.cost, block.dim, block.dofs.to_vec());
                let block = packed.push(cost, dim, &dofs);
                block.d[0].set_lane(bad, 1.0);
                block.r[0].set_lane(bad, 1.0);
                block.jacobian[0].set_lane(bad, number);
                block.aref[0].set_lane(bad, -number);
            }
        }
        packed.factor_mass();
        let stats = *together.solve(&packed, &settings, None).unwrap();
        failed += u32::from(stats.status(bad) == Status::NonFinite);
        for lane in (0..N).filter(|&lane| lane != bad) {
            let mut single = Solver::new(alone[lane].tree());
            let expected = single.solve(&alone[lane], &settings, None).unwrap().lane(0);
            let name = format!("round {round} lane {lane}");
            assert_eq!(stats.lane(lane), expected, "{name}");
            compare_results(&packed, &together, lane, &alone[lane], &single, &name);
        }
    }
    assert!(failed > 40, "{failed} lanes failed");
}
