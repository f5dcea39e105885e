//! A step that several threads share allocates nothing on any thread once its buffers have grown. The program has one
//! test, so that no other allocates meanwhile.

// This program uses only some of the shared modules.
#[allow(dead_code)]
#[path = "suite/common/mod.rs"]
mod common;
#[allow(dead_code)]
#[path = "suite/scenes/mod.rs"]
mod scenes;

use clench_rigid::Sim;
use common::model;
use scenes::heap_of_boxes;
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Counts the allocations of all threads.
struct Counting;

static COUNT: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is forwarded unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller upholds the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_replayed_heap_allocates_nothing_on_any_thread() {
    let mut sim = Sim::<f64>::new(model(&heap_of_boxes())).expect("valid");
    sim.set_threads(2).expect("threads start");
    let (start, steps) = (sim.state.clone(), 60);
    let mut counted = 0;
    for _ in 0..2 {
        sim.state.copy_from(&start);
        let before = COUNT.load(Ordering::Relaxed);
        for _ in 0..steps {
            sim.step().expect("the motion stays finite");
        }
        counted = COUNT.load(Ordering::Relaxed) - before;
    }
    assert!(sim.contacts().len() > 300);
    // The queue that hands steps to the threads grows by a block every 63 steps.
    assert!(counted <= 1, "{counted} allocations in {steps} steps");
}
