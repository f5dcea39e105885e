//! Allocations and memory of batches: a warm step allocates nothing, and an environment takes the reported memory.

// This program uses only some of the shared modules.
#[allow(dead_code)]
#[path = "suite/batches/mod.rs"]
mod batches;
#[allow(dead_code)]
#[path = "suite/common/mod.rs"]
mod common;
#[allow(dead_code)]
#[path = "suite/scenes/mod.rs"]
mod scenes;

use batches::*;
use clench_math::Instructions;
use clench_rigid::batch::Controls;
use clench_rigid::builder::ModelBuilder;
use clench_rigid::options::RigidOptions;
use clench_rigid::{Batch, BatchOptions, Output, SimError};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicIsize, AtomicUsize, Ordering::SeqCst};
use std::sync::{Mutex, MutexGuard};
use std::time::Duration;

/// Counts the allocations and allocated bytes of all threads, and refuses allocations above a limit.
struct Counting;

static LIMIT: AtomicUsize = AtomicUsize::new(usize::MAX);
static COUNT: AtomicUsize = AtomicUsize::new(0);
static BYTES: AtomicIsize = AtomicIsize::new(0);

// SAFETY: every call is forwarded unchanged to the system's allocator, or fails.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if layout.size() > LIMIT.load(SeqCst) {
            return std::ptr::null_mut();
        }
        COUNT.fetch_add(1, SeqCst);
        BYTES.fetch_add(layout.size() as isize, SeqCst);
        // SAFETY: the caller upholds the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        BYTES.fetch_sub(layout.size() as isize, SeqCst);
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.fetch_add(1, SeqCst);
        BYTES.fetch_add(size as isize - layout.size() as isize, SeqCst);
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Runs one test at a time, because the counters are global.
fn alone() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Returns the allocated bytes, once terminated threads have released theirs.
fn bytes() -> isize {
    let mut before = isize::MIN;
    loop {
        let now = BYTES.load(SeqCst);
        if now == before {
            return now;
        }
        before = now;
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// Runs a task in which no allocation may exceed `limit` bytes.
fn limited<R>(limit: usize, task: impl FnOnce() -> R) -> R {
    LIMIT.store(limit, SeqCst);
    let result = task();
    LIMIT.store(usize::MAX, SeqCst);
    result
}

/// Repeats one motion with faults and resets, and returns the fewest allocations of a repetition. The assignment of
/// groups to threads varies, and the buffers of each thread must have grown first.
fn allocations_of_a_replay(builder: &ModelBuilder, options: BatchOptions, steps: usize) -> usize {
    let envs: Vec<usize> = (0..40).collect();
    let threads = options.threads.unwrap_or(1);
    let mut batch = batch::<f64>(&model(builder), &envs, options);
    batch
        .record(&["cfrc_ext", "contact_force", "xpos", "energy"])
        .expect("known");
    batch
        .randomize("gravity", &[1, 2], &[0.0, 0.0, -9.0, 0.0, 0.0, -10.0])
        .expect("valid");
    let start = batch.save().expect("valid");
    let mut fewest = usize::MAX;
    for _ in 0..2 * threads {
        batch.restore(&start).expect("its own");
        let before = COUNT.load(SeqCst);
        for step in 0..steps {
            drive(&mut batch, &envs, step);
            let env = step % envs.len();
            if step % 7 == 3 {
                batch.state.qpos.row_mut(env)[2] = f64::NAN;
            }
            let failed = batch.step().expect("valid").failed;
            assert_eq!(failed, usize::from(step % 7 == 3));
            batch.reset(env).expect("it exists");
        }
        batch.step_n(20).expect("valid");
        fewest = fewest.min(COUNT.load(SeqCst) - before);
    }
    fewest
}

#[test]
fn a_replay_allocates_nothing() {
    let _turn = alone();
    let options = with(Instructions::widest(), 1, RigidOptions::new());
    assert_eq!(allocations_of_a_replay(&walker(), options, 600), 0);
    assert_eq!(allocations_of_a_replay(&arm_and_box(), options, 600), 0);
    // Grouping depends on the previous step, so a grouped replay would begin with other neighbours.
    let ungrouped = BatchOptions {
        grouping: false,
        ..options
    };
    assert_eq!(allocations_of_a_replay(&many_islands(), ungrouped, 200), 0);
}

#[test]
fn threads_allocate_nothing_but_the_pools_queue() {
    let _turn = alone();
    // The queue that wakes the pool allocates a block every 63 calls and frees the old one.
    let options = with(Instructions::widest(), 3, RigidOptions::new());
    let count = allocations_of_a_replay(&walker(), options, 600);
    assert!(count <= 600 / 63 + 3, "{count}");
}

#[test]
fn an_environment_takes_the_bytes_that_the_batch_says() {
    let _turn = alone();
    let model = model(&walker());
    let held = |count: usize, threads: usize| {
        let before = bytes();
        let options = with(Instructions::widest(), threads, RigidOptions::new());
        let mut batch = Batch::<f32>::with_options(model.clone(), count, options).expect("valid");
        batch.record(&["xpos", "cfrc_ext"]).expect("known");
        let masses = batch.param("body_mass", 0).expect("known");
        batch.randomize("body_mass", &[0], &masses).expect("valid");
        batch.step_n(3).expect("valid");
        (bytes() - before, batch.bytes_per_env())
    };
    // The scratch memory of a thread depends on its groups, and is small compared with many environments.
    for (threads, count, share) in [(1, 3_000, 0.001), (3, 20_000, 0.01)] {
        let ((few, each), (many, _)) = (held(1000, threads), held(count, threads));
        let expected = ((count - 1000) * each) as f64;
        let off = ((many - few) as f64 - expected).abs();
        assert!(
            off < share * expected,
            "{each} bytes an environment, off by {off} in all"
        );
    }
}

#[test]
fn tables_are_refused_if_memory_does_not_hold_all_of_them() {
    let _turn = alone();
    let model = model(&walker());
    let make = |count: usize| {
        let options = with(Instructions::widest(), 1, RigidOptions::new());
        Batch::<f64>::with_options(model.clone(), count, options)
    };
    let each = make(1).expect("few").bytes_per_env();
    let refused = |count: usize, bytes: usize| SimError::OutOfMemory { count, bytes };
    let count = 5000;
    // A batch.
    let error = limited(count * each - 1, || make(count).err());
    assert_eq!(error, Some(refused(count, each)));
    let most = u32::MAX as usize;
    let error = limited(1 << 40, || make(most).err());
    assert_eq!(error, Some(refused(most, each)));
    let mut batch = limited(count * each, || make(count)).expect("just enough");
    // The recorded outputs of a batch and of a rollout.
    let names = ["xpos", "qpos", "xpos", "cinert"];
    let widths = ["xpos", "qpos", "cinert"].map(|name| {
        let output = Output::find(name).expect("known");
        output.width(&model)
    });
    let bytes = 8 * widths.iter().sum::<usize>();
    let error = limited(count * bytes - 1, || batch.record(&names).err());
    assert_eq!(error, Some(refused(count, bytes)));
    assert!(batch.output("xpos").is_none(), "as before");
    limited(count * bytes, || batch.record(&names)).expect("just enough");
    let mut few = make(50).expect("few");
    let mut rollout = |limit: usize| {
        let result = limited(limit, || few.rollout(10, Controls::Held, &names));
        result.map(|recording| recording.steps())
    };
    assert_eq!(rollout(50 * 10 * bytes - 1), Err(refused(50, 10 * bytes)));
    assert_eq!(rollout(50 * 10 * bytes), Ok(10));
}

#[test]
fn environments_come_and_go_without_leaks() {
    let _turn = alone();
    let model = model(&loose_parts());
    let round = || {
        let options = with(Instructions::widest(), 2, RigidOptions::new());
        let mut batch = batch::<f64>(&model, &[0, 1, 2, 3, 4, 5, 6, 7, 8], options);
        batch.step_n(50).expect("valid");
        let saved = batch.save().expect("valid");
        batch.restore(&saved).expect("its own");
        batch.sim(3).expect("it exists");
    };
    round();
    // Memory that threads free later varies, usually by less than a tenth of any of these batches. Leaks do not vary.
    let growth = |_| {
        let before = bytes();
        (0..10).for_each(|_| round());
        bytes() - before
    };
    let leaked = (0..3).map(growth).min().expect("three");
    assert!(leaked < 20_000, "{leaked} bytes");
}
