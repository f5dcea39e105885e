//! Signals during a call that does not hold the interpreter.

use crate::busy::PORTION;
use pyo3::prelude::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, ThreadId};
use std::time::Instant;

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
