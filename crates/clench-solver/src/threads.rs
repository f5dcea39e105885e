//! Threads that share the work of one problem.
//!
//! The assignment of work to threads is decided at run time and does not affect results: each number is computed by one
//! thread, from complete inputs, by the same operations in the same order as on a single thread.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder, Yield};
use std::hint::spin_loop;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{available_parallelism, yield_now};

/// A pool of threads, or the calling thread only. Clones share the pool.
#[derive(Clone, Debug, Default)]
pub struct Threads {
    pool: Option<Arc<ThreadPool>>,
    /// The process that started them.
    process: u32,
    /// The number of them for which the machine has processors.
    at_once: usize,
}

impl Threads {
    /// Creates `count` threads. With 0 or 1 the calling thread is used and none is started.
    ///
    /// # Errors
    /// Returns an error if the system does not start the threads.
    pub fn new(count: usize) -> Result<Threads, ThreadPoolBuildError> {
        if count <= 1 {
            return Ok(Threads::default());
        }
        let pool = ThreadPoolBuilder::new()
            .num_threads(count)
            .thread_name(|k| format!("clench-{k}"))
            .build()?;
        Ok(Threads {
            pool: Some(Arc::new(pool)),
            process: std::process::id(),
            at_once: available_parallelism().map_or(1, |processors| count.min(processors.get())),
        })
    }

    /// Returns true if the threads belong to a process from which this one forked. A fork does not copy threads, so a
    /// call to them would wait for ever.
    pub fn are_lost(&self) -> bool {
        self.pool.is_some() && self.process != std::process::id()
    }

    /// Returns the number of threads.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.pool
            .as_ref()
            .map_or(1, |pool| pool.current_num_threads())
    }

    /// Runs `work` on one of the threads, where forked work starts immediately.
    pub fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    /// Works like [`run`](Self::run), for work that forks many times, each time for less than a millisecond. The
    /// other threads stay awake until it is done, as far as there are processors for them. Waking a thread was measured
    /// to take 60 µs.
    pub fn run_awake<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        let Some(pool) = &self.pool else {
            return work();
        };
        let done = AtomicBool::new(false);
        let finish = || {
            // It is also set after a panic.
            let _set = SetOnDrop(&done);
            work()
        };
        let wait = || repeat(1..self.at_once, &|| stay_awake(&done));
        pool.join(finish, wait).0
    }

    /// Runs both closures, in parallel if another thread is free.
    pub(crate) fn join(&self, one: impl FnOnce() + Send, other: impl FnOnce() + Send) {
        match &self.pool {
            Some(pool) => {
                pool.join(one, other);
            }
            None => {
                one();
                other();
            }
        }
    }

    /// Calls `work` for each item, on any of the threads.
    pub fn for_each<I: Send>(&self, items: &mut [I], work: impl Fn(&mut I) + Sync) {
        match &self.pool {
            Some(pool) if items.len() > 1 => pool.install(|| fork(items, &work)),
            _ => items.iter_mut().for_each(work),
        }
    }

    /// Calls `work` once for each thread, in parallel as far as threads are free. It must finish regardless of which
    /// other threads take part.
    pub(crate) fn on_each(&self, work: impl Fn() + Sync) {
        match &self.pool {
            Some(pool) => pool.install(|| repeat(0..self.count(), &work)),
            None => work(),
        }
    }
}

/// Splits the items in halves down to single ones, so that a free thread takes half of the remaining work. (Rayon's own
/// loops do not split as far; here items are few and large.)
fn fork<I: Send>(items: &mut [I], work: &(impl Fn(&mut I) + Sync)) {
    match items {
        [] => {}
        [item] => work(item),
        _ => {
            let (one, other) = items.split_at_mut(items.len() / 2);
            rayon::join(|| fork(one, work), || fork(other, work));
        }
    }
}

/// Runs the work that other threads have forked until they are done.
fn stay_awake(done: &AtomicBool) {
    let mut idle = 0;
    while !done.load(Ordering::Acquire) {
        match rayon::yield_now() {
            Some(Yield::Executed) => idle = 0,
            _ => idle += 1,
        }
        pause(idle);
    }
}

/// Pauses between two polls of another thread's progress, after `polls` polls without success.
pub(crate) fn pause(polls: usize) {
    /// Polling without a pause would keep taking the cache line from the thread that writes it.
    const SPINS: usize = 16;
    /// After this many polls, some hundred microseconds, the operating system may run other threads here.
    const MAX_SPINNING_POLLS: usize = 1000;
    match polls < MAX_SPINNING_POLLS {
        true => (0..SPINS).for_each(|_| spin_loop()),
        false => yield_now(),
    }
}

/// Sets a flag when it is dropped.
struct SetOnDrop<'a>(&'a AtomicBool);

impl Drop for SetOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

/// Calls `work` once for each number of the range.
fn repeat(range: Range<usize>, work: &(impl Fn() + Sync)) {
    if range.len() <= 1 {
        return range.for_each(|_| work());
    }
    let middle = range.start + range.len() / 2;
    let (one, other) = (range.start..middle, middle..range.end);
    rayon::join(|| repeat(one, work), || repeat(other, work));
}
