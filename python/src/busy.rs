//! Exclusive access: a second thread gets an error instead of waiting, and long calls handle Ctrl-C.

use crate::error::busy;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, TryLockError};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

/// The number of steps of the first portion. A batch regroups its environments once per portion.
const FIRST_PORTION: usize = 8;
/// The duration up to which portions grow; signals are checked after each portion.
const PORTION: Duration = Duration::from_millis(20);

/// Locks `shared` for the duration of a call.
///
/// # Errors
/// Returns `clench.BusyError` if a call of another thread holds the lock.
pub(crate) fn lock<'a, T>(shared: &'a Mutex<T>, what: &str) -> PyResult<MutexGuard<'a, T>> {
    match shared.try_lock() {
        Ok(guard) => Ok(guard),
        // States are plain numbers, checked before each step; scratch is overwritten by it.
        Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
        Err(TryLockError::WouldBlock) => Err(busy(what)),
    }
}

/// Takes `steps` steps in portions without holding the interpreter, and checks signals in between.
///
/// # Errors
/// Returns the error of a portion, or `KeyboardInterrupt`; the steps before it are done.
pub(crate) fn in_portions(
    py: Python<'_>,
    steps: usize,
    mut portion: impl FnMut(usize) -> PyResult<()> + Send,
) -> PyResult<()> {
    let (mut left, mut max) = (steps, FIRST_PORTION);
    while left > 0 {
        let start = Instant::now();
        let now = left.min(max);
        py.detach(|| portion(now))?;
        py.check_signals()?;
        left -= now;
        if start.elapsed() < PORTION {
            max = max.saturating_mul(2);
        }
    }
    Ok(())
}

/// The signals during a call that does not hold the interpreter, which may run on several threads.
pub(crate) struct Signals {
    /// The thread of the call, which checks them.
    thread: ThreadId,
    checked: Mutex<Instant>,
    raised: Mutex<Option<PyErr>>,
    stopped: AtomicBool,
}

impl Signals {
    pub(crate) fn new() -> Self {
        Signals {
            thread: thread::current().id(),
            checked: Mutex::new(Instant::now()),
            raised: Mutex::new(None),
            stopped: AtomicBool::new(false),
        }
    }

    /// Returns true while no signal has raised an error. The thread of the call checks them now and then.
    pub(crate) fn none(&self) -> bool {
        if thread::current().id() == self.thread
            && let Ok(mut checked) = self.checked.lock()
            && checked.elapsed() >= PORTION
        {
            if let Err(error) = Python::attach(|py| py.check_signals()) {
                self.stopped.store(true, Ordering::Relaxed);
                if let Ok(mut raised) = self.raised.lock() {
                    *raised = Some(error);
                }
            }
            *checked = Instant::now();
        }
        !self.stopped.load(Ordering::Relaxed)
    }

    /// Returns the error of a signal.
    pub(crate) fn raise(self) -> PyResult<()> {
        match self.raised.into_inner() {
            Ok(Some(error)) => Err(error),
            Ok(None) | Err(_) => Ok(()),
        }
    }
}
