//! One thread at a time: a second one is told so instead of waiting, and long calls notice Ctrl-C.

use crate::error::busy;
use pyo3::prelude::*;
use std::sync::{Mutex, MutexGuard, TryLockError};
use std::time::{Duration, Instant};

/// As many steps are taken at once at first: environments of a batch are grouped anew as often.
const FIRST_PORTION: usize = 8;
/// Portions grow until they take this long; after each, signals are looked at.
const PORTION: Duration = Duration::from_millis(20);

/// What `shared` holds, for the time of a call.
///
/// # Errors
/// `clench.BusyError` while a call of another thread has it.
pub(crate) fn lock<'a, T>(shared: &'a Mutex<T>, what: &str) -> PyResult<MutexGuard<'a, T>> {
    match shared.try_lock() {
        Ok(guard) => Ok(guard),
        // States are plain numbers, checked before each step; scratch is overwritten by it.
        Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
        Err(TryLockError::WouldBlock) => Err(busy(what)),
    }
}

/// Takes `steps` steps in portions without holding the interpreter, and looks at signals in between.
///
/// # Errors
/// What a portion returns, and `KeyboardInterrupt`: the steps before it are done.
pub(crate) fn in_portions(
    py: Python<'_>,
    steps: usize,
    mut portion: impl FnMut(usize) -> PyResult<()> + Send,
) -> PyResult<()> {
    let (mut left, mut most) = (steps, FIRST_PORTION);
    while left > 0 {
        let start = Instant::now();
        let now = left.min(most);
        py.detach(|| portion(now))?;
        py.check_signals()?;
        left -= now;
        if start.elapsed() < PORTION {
            most = most.saturating_mul(2);
        }
    }
    Ok(())
}
