//! Ctrl-C and the request to end: a run stops after the step it is in, and what it has recorded is kept.

use anyhow::Result;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::{register, register_conditional_shutdown, register_usize};
use std::ffi::c_int;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};

/// What a shell adds to the number of a signal to tell that it ended a program.
const ENDED_BY_SIGNAL: u8 = 128;

/// A signal that asks a run to stop.
#[derive(Clone, Copy)]
pub(crate) struct Signal {
    /// Its name.
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
    /// The exit code of a run that it stopped.
    pub(crate) fn exit_code(self) -> u8 {
        ENDED_BY_SIGNAL + self.number as u8
    }
}

/// The signals that came since this was made.
pub(crate) struct Interrupt(Arc<AtomicUsize>);

impl Interrupt {
    /// Notes signals from now on, where they would have ended the program. A second one ends it at once.
    ///
    /// # Errors
    /// A system that does not let signals be noted.
    pub(crate) fn listen() -> Result<Self> {
        let (came, last) = (
            Arc::new(AtomicBool::new(false)),
            Arc::new(AtomicUsize::new(0)),
        );
        for signal in SIGNALS {
            // In this order: the first signal finds `came` unset, and sets it.
            let code = c_int::from(signal.exit_code());
            register_conditional_shutdown(signal.number, code, Arc::clone(&came))?;
            register(signal.number, Arc::clone(&came))?;
            register_usize(signal.number, Arc::clone(&last), signal.number as usize)?;
        }
        Ok(Interrupt(last))
    }

    /// The last signal, if one came.
    pub(crate) fn signal(&self) -> Option<Signal> {
        let number = self.0.load(Relaxed) as c_int;
        SIGNALS.into_iter().find(|signal| signal.number == number)
    }
}
