//! Threads that share the work of one problem.
//!
//! Who does which part is decided while they run, and changes no result: each number is computed by one of them, from numbers that are complete,
//! by the same operations in the same order as by one thread alone.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder, Yield};
use std::hint::spin_loop;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{available_parallelism, yield_now};

/// Some threads, or the caller's alone. Clones share them.
#[derive(Clone, Debug, Default)]
pub struct Threads {
    pool: Option<Arc<ThreadPool>>,
    /// The process that they are of.
    process: u32,
    /// How many of them the machine has processors for.
    at_once: usize,
}

impl Threads {
    /// So many threads; up to one is the caller's, and starts none.
    ///
    /// # Errors
    /// Threads that the system does not start.
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

    /// Whether they are of another process, from which this one forked: a fork does not copy threads, and who called them would wait for
    /// ever.
    pub fn are_lost(&self) -> bool {
        self.pool.is_some() && self.process != std::process::id()
    }

    /// How many there are.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.pool
            .as_ref()
            .map_or(1, |pool| pool.current_num_threads())
    }

    /// Does `work` on one of the threads, where what it forks begins at once.
    pub fn enter<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    /// As [`enter`](Self::enter), for work that forks many times, each time for less than a millisecond: the other threads do not fall asleep until it
    /// is done, as far as there are processors for them. Waking a thread took 60 µs where it was measured.
    pub fn enter_awake<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        let Some(pool) = &self.pool else {
            return work();
        };
        let done = AtomicBool::new(false);
        let finish = || {
            // It is set after a panic too.
            let _set = SetOnDrop(&done);
            work()
        };
        let wait = || repeat(1..self.at_once, &|| stay_awake(&done));
        pool.join(finish, wait).0
    }

    /// Does both, at once if another thread is free.
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

    /// Calls `work` once for each thread, all at once as far as threads are free: it has to end whoever else takes part.
    pub(crate) fn on_each(&self, work: impl Fn() + Sync) {
        match &self.pool {
            Some(pool) => pool.install(|| repeat(0..self.count(), &work)),
            None => work(),
        }
    }
}

/// Halves the items until they are single, so that whoever is free takes half of what is left. (Unlike rayon's own loops it cuts as
/// far as it can: items are few and large.)
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

/// Does what the other threads have forked until they are done.
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

/// A pause between two looks at what another thread has to do first, after so many looks in vain.
pub(crate) fn pause(looks: usize) {
    /// Looking without a pause would keep taking the cache line from the thread that writes it.
    const SPINS: usize = 16;
    /// After so many looks, some hundred microseconds, the operating system may run other threads here.
    const MAX_SPINNING_LOOKS: usize = 1000;
    match looks < MAX_SPINNING_LOOKS {
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
