//! State that the connections to browsers share with the server.

use crate::Page;
use crate::command::Command;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::atomic::{AtomicBool, AtomicUsize};
use std::sync::mpsc::SyncSender;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tungstenite::{Bytes, Utf8Bytes};

/// The shared state of all connections.
pub(crate) struct Shared {
    pub page: Page,
    pub scene: Utf8Bytes,
    pub token: String,
    pub anywhere: bool,
    pub latest: Mutex<Latest>,
    pub changed: Condvar,
    pub commands: SyncSender<Command>,
    pub clients: AtomicUsize,
    pub closing: AtomicBool,
}

/// The latest frame and message, each with its sequence number.
#[derive(Clone)]
pub(crate) struct Latest {
    pub number: u64,
    pub frame: Bytes,
    pub message_count: u64,
    pub message: Utf8Bytes,
}

impl Shared {
    pub(crate) fn latest(&self) -> MutexGuard<'_, Latest> {
        self.latest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a frame after this one, up to [`HEARTBEAT`], and returns the latest.
    pub(crate) fn newer_than(&self, seen: u64) -> Latest {
        let old = |latest: &mut Latest| latest.number <= seen && !self.closing.load(Relaxed);
        let waited = (self.changed).wait_timeout_while(self.latest(), HEARTBEAT, old);
        let (latest, _) = waited.unwrap_or_else(PoisonError::into_inner);
        latest.clone()
    }
}

/// The time after which a browser receives the old frame again if there is no new one.
pub(super) const HEARTBEAT: Duration = Duration::from_millis(100);
