//! A solver allocates nothing when it solves the same problems a second time.

// This program uses only part of the suite's shared code.
#[allow(dead_code)]
#[path = "suite/common/mod.rs"]
mod common;

use clench_solver::{ConstraintSolver, Solver, SolverOptions};
use common::*;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call is forwarded to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, ptr: *mut u8, layout: Layout) {
        unsafe { System.dealloc(ptr, layout) }
    }
    unsafe fn realloc(&self, ptr: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        unsafe { System.realloc(ptr, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_second_pass_allocates_nothing() {
    let mut rng = Rng(6);
    let forest: Vec<Option<usize>> = (0..24)
        .map(|i: usize| {
            if i.is_multiple_of(4) {
                None
            } else {
                Some(i - 1)
            }
        })
        .collect();
    for parents in [humanoid(), forest] {
        let problems: Vec<_> = (0..20)
            .map(|k| random_problem(&mut rng, &Shape::new(parents.clone(), k % 12)))
            .collect();
        for algorithm in [ConstraintSolver::Newton, ConstraintSolver::Cg] {
            let options = SolverOptions::new()
                .constraint_solver(algorithm)
                .noslip_iterations(5);
            let settings = options.resolve::<f64>();
            let mut solver = Solver::new(problems[0].tree());
            let warm = vec![0.0; problems[0].nv()];
            let mut pass = || {
                for problem in &problems {
                    solver.solve(problem, &settings, Some(&warm)).unwrap();
                }
            };
            pass();
            let before = COUNT.with(Cell::get);
            pass();
            assert_eq!(COUNT.with(Cell::get), before);
        }
    }
}
