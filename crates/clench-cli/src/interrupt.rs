//! SIGINT and SIGTERM: a run stops after the current step, and its record is kept.

use anyhow::Result;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::{register, register_conditional_shutdown, register_usize};
use std::ffi::c_int;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

/// The offset that a shell adds to the number of the signal that ended a program.
const ENDED_BY_SIGNAL: u8 = 128;

/// A signal that requests a run to stop.
#[derive(Clone, Copy)]
pub(crate) struct Signal {
    /// The name.
    pub name: &'static str,
    number: c_int,
}

const SIGNALS: [Signal; 2] = [
    Signal {
        name: "SIGINT",
        number: SIGINT,
    },
    Signal {
        name: "SIGTERM",
        number: SIGTERM,
    },
];

impl Signal {
    /// Returns the exit code of a run that the signal stopped.
    pub(crate) fn exit_code(self) -> u8 {
        ENDED_BY_SIGNAL + self.number as u8
    }
}

/// The signals received since this was created.
pub(crate) struct Interrupt(Arc<AtomicUsize>);

impl Interrupt {
    /// Registers signals from now on instead of terminating the program. A second signal terminates it immediately.
    ///
    /// # Errors
    /// Returns an error if the system does not allow signal handlers.
    pub(crate) fn listen() -> Result<Self> {
        let (came, last) = (
            Arc::new(AtomicBool::new(false)),
            Arc::new(AtomicUsize::new(0)),
        );
        for signal in SIGNALS {
            // The order matters: the first signal finds `came` unset, and sets it.
            let code = c_int::from(signal.exit_code());
            register_conditional_shutdown(signal.number, code, Arc::clone(&came))?;
            register(signal.number, Arc::clone(&came))?;
            register_usize(signal.number, Arc::clone(&last), signal.number as usize)?;
        }
        Ok(Interrupt(last))
    }

    /// Returns the last signal, if there is one.
    pub(crate) fn signal(&self) -> Option<Signal> {
        let number = self.0.load(Relaxed) as c_int;
        SIGNALS.into_iter().find(|signal| signal.number == number)
    }
}
