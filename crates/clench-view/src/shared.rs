//! What the connections to browsers share with the server.

use crate::Page;
use crate::command::Command;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::atomic::{AtomicBool, AtomicUsize};
use std::sync::mpsc::SyncSender;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tungstenite::{Bytes, Utf8Bytes};

/// What all connections share.
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

/// What is newest, each with its number.
#[derive(Clone)]
pub(crate) struct News {
    pub number: u64,
    pub frame: Bytes,
    pub said: u64,
    pub message: Utf8Bytes,
}

impl Shared {
    pub(crate) fn news(&self) -> MutexGuard<'_, News> {
        self.news.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is newest, once there is a frame after this one or a while has passed.
    pub(crate) fn newer_than(&self, seen: u64) -> News {
        let old = |news: &mut News| news.number <= seen && !self.closing.load(Relaxed);
        let waited = (self.changed).wait_timeout_while(self.news(), HEARTBEAT, old);
        let (news, _) = waited.unwrap_or_else(PoisonError::into_inner);
        news.clone()
    }
}

/// A browser that asks for a frame gets the old one again when no new one has come for so long.
pub(super) const HEARTBEAT: Duration = Duration::from_millis(100);
