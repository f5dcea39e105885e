//! A step that several threads share allocates nothing once its buffers have grown, on any of them. One test, so that nobody else
//! allocates meanwhile.

// Of what the suite shares this program uses some.
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

// SAFETY: every call goes on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
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
    // The queue in which a step is handed to the threads grows by a block for each 63 of them.
    assert!(counted <= 1, "{counted} allocations in {steps} steps");
}
