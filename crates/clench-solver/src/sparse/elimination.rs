//! The assignment of supernodes to threads: any number of threads share one elimination.
//!
//! Threads claim supernodes in the order of elimination and wait for those that they need, all of which were claimed
//! earlier. The earliest unfinished one waits for no other, so there is no deadlock with any number of threads. A
//! supernode is written only by the thread that claimed it, and read by the others once it is done.

use super::pattern::{SparsePattern, Supernode};
use crate::threads::pause;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread::panicking;

/// The memory of a supernode that is being factored: its blocks of the matrix (finally of L) and of U, its parts of D
/// and 1 / D.
pub(super) struct Open<'a, T> {
    index: usize,
    pub values: &'a mut [T],
    pub upper: &'a mut [T],
    pub diagonal: &'a mut [T],
    pub inverse: &'a mut [T],
}

/// The blocks of L and U of a finished supernode.
#[derive(Debug)]
pub(super) struct Done<'a, T> {
    pub lower: &'a [T],
    pub upper: &'a [T],
}

/// The memory of the unclaimed supernodes: `values` and `upper` from the next block on, `diagonal` and `inverse` up to
/// its last dof.
struct Unclaimed<'a, T> {
    next: usize,
    values: &'a mut [T],
    upper: &'a mut [T],
    diagonal: &'a mut [T],
    inverse: &'a mut [T],
}

/// A factorization shared by threads.
pub(super) struct Elimination<'a, T> {
    unclaimed: Mutex<Unclaimed<'a, T>>,
    done: Vec<OnceLock<Done<'a, T>>>,
    /// True once a thread has panicked; the supernodes that it claimed are never finished.
    abandoned: AtomicBool,
}

/// The memory in which an elimination records finished supernodes; empty between eliminations.
#[derive(Debug)]
pub(super) struct Spare<T: 'static>(Vec<OnceLock<Done<'static, T>>>);

impl<'a, T> Elimination<'a, T> {
    /// Passes an elimination to `work`, whose threads [`claim`](Self::claim) the supernodes. `memory` holds the blocks
    /// of the matrix, and memory for those of U, for the diagonal and for its inverse.
    pub(super) fn run(
        pattern: &SparsePattern,
        memory: [&'a mut [T]; 4],
        spare: &mut Spare<T>,
        work: impl FnOnce(&Self),
    ) where
        T: 'static,
    {
        let [values, upper, diagonal, inverse] = memory;
        let mut done = emptied(std::mem::take(&mut spare.0));
        done.resize_with(pattern.supernodes().len(), OnceLock::new);
        let elimination = Elimination {
            unclaimed: Mutex::new(Unclaimed {
                next: 0,
                values,
                upper,
                diagonal,
                inverse,
            }),
            done,
            abandoned: AtomicBool::new(false),
        };
        work(&elimination);
        spare.0 = emptied(elimination.done);
    }

    /// Claims the next supernode for the calling thread.
    pub(super) fn claim<'p>(
        &self,
        pattern: &'p SparsePattern,
    ) -> Option<(&'p Supernode, Open<'a, T>)> {
        let mut unclaimed = self
            .unclaimed
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let s = pattern.supernodes().get(unclaimed.next)?;
        let open = Open {
            index: unclaimed.next,
            values: unclaimed.values.split_off_mut(..s.block().len())?,
            upper: unclaimed.upper.split_off_mut(..s.block().len())?,
            diagonal: unclaimed.diagonal.split_off_mut(s.first..)?,
            inverse: unclaimed.inverse.split_off_mut(s.first..)?,
        };
        unclaimed.next += 1;
        Some((s, open))
    }

    /// Lets the other threads read a claimed supernode.
    pub(super) fn close(&self, open: Open<'a, T>) {
        let Open {
            index,
            values,
            upper,
            ..
        } = open;
        // Only this thread has claimed it, so it is not set yet.
        let _ = self.done[index].set(Done {
            lower: values,
            upper,
        });
    }

    /// Waits for a supernode to be finished. Returns `None` if it never will be.
    #[inline(always)]
    pub(super) fn wait(&self, index: usize) -> Option<&Done<'a, T>> {
        match self.done[index].get() {
            Some(done) => Some(done),
            None => self.wait_long(index),
        }
    }

    #[cold]
    fn wait_long(&self, index: usize) -> Option<&Done<'a, T>> {
        let mut polls = 0;
        while !self.abandoned.load(Ordering::Relaxed) {
            if let Some(done) = self.done[index].get() {
                return Some(done);
            }
            pause(polls);
            polls += 1;
        }
        None
    }
}

/// A guard: if the thread panics while it exists, the other threads stop waiting.
pub(super) struct Watch<'e>(&'e AtomicBool);

impl<T> Elimination<'_, T> {
    /// Returns a guard for a thread that claims supernodes.
    pub(super) fn watch(&self) -> Watch<'_> {
        Watch(&self.abandoned)
    }
}

impl Drop for Watch<'_> {
    fn drop(&mut self) {
        if panicking() {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}

impl<T> Default for Spare<T> {
    fn default() -> Self {
        Spare(Vec::new())
    }
}

/// A clone starts with empty memory.
impl<T> Clone for Spare<T> {
    fn clone(&self) -> Self {
        Spare::default()
    }
}

/// Empties a vector and reuses its memory for elements that differ only in their lifetime. No element remains and none
/// is created.
fn emptied<'b, T>(mut done: Vec<OnceLock<Done<'_, T>>>) -> Vec<OnceLock<Done<'b, T>>> {
    done.clear();
    done.into_iter().map(|_| OnceLock::new()).collect()
}
