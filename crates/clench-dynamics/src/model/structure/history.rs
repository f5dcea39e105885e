//! Where buffers of past values lie.

use std::ops::Range;

/// A buffer of past values in the `history` of a state; see [`history`](crate::history).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct History {
    /// Its first number.
    pub start: usize,
    /// How many samples it keeps, at least one.
    pub samples: usize,
    /// How many numbers a sample has, at least one.
    pub width: usize,
    /// How it is read between samples.
    pub interpolation: Interpolation,
}

impl History {
    /// How many numbers it takes.
    pub fn size(&self) -> usize {
        1 + self.samples * (1 + self.width)
    }

    /// Where the times of its samples are, oldest first.
    #[inline(always)]
    pub fn times(&self) -> Range<usize> {
        self.start + 1..self.start + 1 + self.samples
    }

    /// Where their values are.
    #[inline(always)]
    pub fn values(&self) -> Range<usize> {
        let first = self.start + 1 + self.samples;
        first..first + self.samples * self.width
    }
}

/// How a buffer is read between two samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The earlier sample holds.
    #[default]
    Hold,
    /// By a straight line.
    Linear,
    /// By a cubic through both, with slopes from their neighbours (Catmull and Rom), zero at the ends.
    Cubic,
}
