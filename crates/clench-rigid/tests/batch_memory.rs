//! Steps of a batch allocate nothing once warm, and an environment takes the memory that the batch says.

mod batches;

use batches::*;
use clench_math::Instructions;
use clench_rigid::Batch;
use clench_solver::RigidOptions;
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicIsize, AtomicUsize, Ordering::SeqCst};
use std::sync::{Mutex, MutexGuard};
use std::time::Duration;

/// Counts the allocations of all threads, and the bytes that they hold.
struct Counting;

static COUNT: AtomicUsize = AtomicUsize::new(0);
static BYTES: AtomicIsize = AtomicIsize::new(0);

// SAFETY: every call goes on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, SeqCst);
        BYTES.fetch_add(layout.size() as isize, SeqCst);
        // SAFETY: the caller keeps the contract of `alloc`.
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

/// One test at a time, so that it counts its own.
fn alone() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// The bytes that are held, once threads that were told to end have given back theirs.
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

/// Steps several times through the same motion, with faults and resets on the way, and counts the allocations of the best
/// time: which thread gets which group varies, and each thread's buffers must have grown first.
fn allocations_of_a_replay(threads: usize, steps: usize) -> usize {
    let envs: Vec<usize> = (0..40).collect();
    let options = with(Instructions::widest(), threads, RigidOptions::new());
    let mut batch = batch::<f64>(&model(&walker()), &envs, options);
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
    assert_eq!(allocations_of_a_replay(1, 600), 0);
}

#[test]
fn threads_allocate_nothing_but_the_pools_queue() {
    let _turn = alone();
    // The queue that wakes the pool takes a new block every 63 calls and gives the old one back.
    let count = allocations_of_a_replay(3, 600);
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
    // Scratch of threads grows with what they meet, whichever groups they get: a trifle beside many environments.
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
    let before = bytes();
    (0..10).for_each(|_| round());
    // What threads leave to be freed later is less than a tenth of any of these batches.
    let leaked = bytes() - before;
    assert!(leaked < 20_000, "{leaked} bytes");
}
