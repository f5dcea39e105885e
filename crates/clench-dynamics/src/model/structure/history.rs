//! The layout of buffers of past values.

use std::ops::Range;

/// A buffer of past values in the `history` of a state; see [`history`](crate::history).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct History {
    /// The index of its first number.
    pub start: usize,
    /// The number of samples, at least one.
    pub samples: usize,
    /// The number of numbers per sample, at least one.
    pub width: usize,
    /// The interpolation between samples.
    pub interpolation: Interpolation,
}

impl History {
    /// Returns its number of numbers.
    pub fn size(&self) -> usize {
        1 + self.samples * (1 + self.width)
    }

    /// Returns the range of the times of its samples, oldest first.
    #[inline(always)]
    pub fn times(&self) -> Range<usize> {
        self.start + 1..self.start + 1 + self.samples
    }

    /// Returns the range of their values.
    #[inline(always)]
    pub fn values(&self) -> Range<usize> {
        let first = self.start + 1 + self.samples;
        first..first + self.samples * self.width
    }
}

/// The interpolation of a buffer between two samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The earlier sample holds.
    #[default]
    Hold,
    /// Linear interpolation.
    Linear,
    /// Cubic interpolation with slopes from the neighbours (Catmull and Rom), zero at the ends.
    Cubic,
}
