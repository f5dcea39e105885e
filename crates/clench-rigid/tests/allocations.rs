//! A step allocates nothing once its buffers have grown.

// This program uses only some of the shared modules.
#[allow(dead_code)]
#[path = "suite/common/mod.rs"]
mod common;
#[allow(dead_code)]
#[path = "suite/scenes/mod.rs"]
mod scenes;

use clench_rigid::Sim;
use clench_rigid::model::Integrator;
use clench_rigid::options::{ContactModel, FrictionCone, RigidOptions};
use clench_solver::ConstraintSolver;
use scenes::{add, everything, free, humanoid, model, plane, shake, sphere, world};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// Counts the allocations of each thread.
struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call is forwarded unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = COUNT.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller upholds the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let _ = COUNT.try_with(|count| count.set(count.get() + 1));
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Steps twice through the same trajectory and counts the allocations of the second.
fn allocations_of_a_replay(sim: &mut Sim, steps: usize) -> (usize, usize) {
    let start = sim.state.clone();
    let mut contacts = 0;
    let mut counted = 0;
    for _ in 0..2 {
        sim.state.copy_from(&start);
        let before = COUNT.with(Cell::get);
        for step in 0..steps {
            for (i, ctrl) in sim.state.ctrl.iter_mut().enumerate() {
                *ctrl = (0.05 * step as f64 + 1.3 * i as f64).sin();
            }
            sim.step().expect("the motion stays finite");
            contacts += sim.contacts().len();
        }
        counted = COUNT.with(Cell::get) - before;
    }
    (counted, contacts)
}

#[test]
fn a_replayed_humanoid_allocates_nothing() {
    let model = model(&humanoid());
    for solver in [ConstraintSolver::Newton, ConstraintSolver::Cg] {
        for (cone, law) in [
            (FrictionCone::Pyramidal, ContactModel::Convex),
            (FrictionCone::Elliptic, ContactModel::Convex),
            (FrictionCone::Elliptic, ContactModel::Coulomb),
        ] {
            let options = RigidOptions::new()
                .constraint_solver(solver)
                .friction_cone(cone)
                .contact_model(law)
                .tolerance(1e-8)
                .noslip_iterations(3);
            let mut sim = Sim::with_options(model.clone(), options).expect("valid");
            let (allocations, contacts) = allocations_of_a_replay(&mut sim, 1000);
            assert!(contacts > 2000, "it lies on the floor: {contacts}");
            assert_eq!(allocations, 0, "{solver:?}, {cone:?}, {law:?}");
        }
    }
}

#[test]
fn every_kind_of_constraint_and_integrator_allocates_nothing() {
    for integrator in [
        Integrator::Euler,
        Integrator::ImplicitFast,
        Integrator::Implicit,
        Integrator::Rk4,
        Integrator::Discrete,
    ] {
        let mut builder = everything();
        builder.physics.integrator = integrator;
        let mut sim = Sim::new(model(&builder)).expect("valid");
        shake(&mut sim, 2);
        let (allocations, _) = allocations_of_a_replay(&mut sim, 100);
        assert_eq!(allocations, 0, "{integrator:?}");
    }
}

#[test]
fn a_swept_scene_allocates_nothing() {
    let mut builder = world();
    builder.options = builder.options.tolerance(1e-8);
    builder.bodies[0].geoms.push(plane());
    for i in 0..130 {
        let pos = [0.3 * f64::from(i % 12), 0.3 * f64::from(i / 12), 0.12];
        add(&mut builder, 0, "", pos, free(), vec![sphere(0.1)]);
    }
    let mut sim = Sim::new(model(&builder)).expect("valid");
    let (allocations, contacts) = allocations_of_a_replay(&mut sim, 50);
    assert!(contacts > 1000, "they reach the floor: {contacts}");
    assert_eq!(allocations, 0);
}
