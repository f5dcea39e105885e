//! Who factors which supernode: any number of threads share one elimination.
//!
//! Threads claim supernodes in the order of elimination and wait for those that they need, all of which were claimed earlier. The earliest that is
//! not done needs nobody, so there is no deadlock, however few threads take part. A supernode is written by the one thread that has
//! claimed it, and read by the others once it is done.

use super::pattern::{SparsePattern, Supernode};
use crate::threads::pause;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread::panicking;

/// Memory of a supernode that is being factored: its blocks of the matrix (in the end of L) and of U, its pieces of D and 1 / D.
pub(super) struct Open<'a, T> {
    index: usize,
    pub values: &'a mut [T],
    pub upper: &'a mut [T],
    pub diagonal: &'a mut [T],
    pub inverse: &'a mut [T],
}

/// The blocks of L and U of a supernode that is done.
#[derive(Debug)]
pub(super) struct Done<'a, T> {
    pub lower: &'a [T],
    pub upper: &'a [T],
}

/// The memory of supernodes that nobody has claimed: `values` and `upper` from the next block on, `diagonal` and `inverse` up to its last dof.
struct Unclaimed<'a, T> {
    next: usize,
    values: &'a mut [T],
    upper: &'a mut [T],
    diagonal: &'a mut [T],
    inverse: &'a mut [T],
}

/// A factorization that threads share.
pub(super) struct Elimination<'a, T> {
    unclaimed: Mutex<Unclaimed<'a, T>>,
    done: Vec<OnceLock<Done<'a, T>>>,
    /// A thread has panicked: what it had claimed is never done.
    abandoned: AtomicBool,
}

/// The memory in which an elimination notes what is done, empty between eliminations.
#[derive(Debug)]
pub(super) struct Spare<T: 'static>(Vec<OnceLock<Done<'static, T>>>);

impl<'a, T> Elimination<'a, T> {
    /// Hands an elimination to `work`, whose threads [`claim`](Self::claim) what there is. `memory` holds the blocks of the matrix, room for
    /// those of U, for the diagonal and for its inverse.
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

    /// The next supernode, for this thread alone.
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

    /// Lets others read a supernode that was claimed.
    pub(super) fn close(&self, open: Open<'a, T>) {
        let Open {
            index,
            values,
            upper,
            ..
        } = open;
        // Nobody else has claimed it, so nobody else has set it.
        let _ = self.done[index].set(Done {
            lower: values,
            upper,
        });
    }

    /// A supernode, once the thread that claimed it is done. None if it never will be.
    #[inline(always)]
    pub(super) fn wait(&self, index: usize) -> Option<&Done<'a, T>> {
        match self.done[index].get() {
            Some(done) => Some(done),
            None => self.wait_long(index),
        }
    }

    #[cold]
    fn wait_long(&self, index: usize) -> Option<&Done<'a, T>> {
        let mut looks = 0;
        while !self.abandoned.load(Ordering::Relaxed) {
            if let Some(done) = self.done[index].get() {
                return Some(done);
            }
            pause(looks);
            looks += 1;
        }
        None
    }
}

/// While it lives, a panic of this thread tells the others not to wait.
pub(super) struct Watch<'e>(&'e AtomicBool);

impl<T> Elimination<'_, T> {
    /// Watches over a thread that claims supernodes.
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

/// A copy has memory of its own.
impl<T> Clone for Spare<T> {
    fn clone(&self) -> Self {
        Spare::default()
    }
}

/// The memory of a vector for elements that differ in nothing but how long they live: no element is left, and none is made.
fn emptied<'b, T>(mut done: Vec<OnceLock<Done<'_, T>>>) -> Vec<OnceLock<Done<'b, T>>> {
    done.clear();
    done.into_iter().map(|_| OnceLock::new()).collect()
}
