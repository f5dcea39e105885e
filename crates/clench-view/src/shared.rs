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
    pub news: Mutex<News>,
    pub changed: Condvar,
    pub commands: SyncSender<Command>,
    pub clients: AtomicUsize,
    pub closing: AtomicBool,
}

/// The latest frame and message, each with its sequence number.
#[derive(Clone)]
pub(crate) struct News {
    pub number: u64,
    pub frame: Bytes,
    pub message_count: u64,
    pub message: Utf8Bytes,
}

impl Shared {
    pub(crate) fn news(&self) -> MutexGuard<'_, News> {
        self.news.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a frame after this one, up to [`HEARTBEAT`], and returns the latest.
    pub(crate) fn newer_than(&self, seen: u64) -> News {
        let old = |news: &mut News| news.number <= seen && !self.closing.load(Relaxed);
        let waited = (self.changed).wait_timeout_while(self.news(), HEARTBEAT, old);
        let (news, _) = waited.unwrap_or_else(PoisonError::into_inner);
        news.clone()
    }
}

/// The time after which a browser receives the old frame again if there is no new one.
pub(super) const HEARTBEAT: Duration = Duration::from_millis(100);
