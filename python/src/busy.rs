//! Exclusive access: a second thread gets an error instead of waiting, and long calls handle Ctrl-C.

use crate::error::busy;
use pyo3::prelude::*;
use std::sync::{Mutex, MutexGuard, TryLockError};
use std::time::{Duration, Instant};

/// The number of steps of the first portion. A batch regroups its environments once per portion.
const FIRST_PORTION: usize = 8;
/// The duration up to which portions grow; signals are checked after each portion.
pub(crate) const PORTION: Duration = Duration::from_millis(20);

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
