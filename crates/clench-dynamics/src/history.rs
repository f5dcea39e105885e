//! Buffers of past values, which implement delays (MuJoCo manual, modeling chapter, "Delays").
//!
//! A buffer is a range of the `history` of a state: one number for its owner, the times of its samples, oldest first,
//! and their values, sample after sample. Times are relative to the present, so they are zero or negative and keep
//! their precision however long a simulation runs. Once a step every buffer drops its oldest sample and adds one taken
//! at the start of the step.
//!
//! A buffer with a period takes samples less often: when its period has passed since the last due time. The owner's
//! number stores that due time. It counts from the start of the simulation and is a sum of periods, as in MuJoCo, so
//! that rounding has the same effect as there.

use crate::model::{History, Interpolation};
use clench_math::{Mask, Real, Scalar};

/// Times that differ by at most this, s, are equal (MuJoCo's `mjMINVAL`).
const SAME_TIME: f64 = 1e-15;
/// The same, in units of the precision of the times.
const SAME_TIME_ROUNDING: f64 = 8.0;

impl History {
    /// Initializes the times of a buffer that is sampled every `step` seconds.
    pub fn begin<T: Real>(&self, step: f64, numbers: &mut [T]) {
        let n = self.samples;
        for (k, time) in numbers[self.times()].iter_mut().enumerate() {
            *time = T::new(-step * (n - k) as f64);
        }
    }

    /// Initializes the times of a buffer that is sampled every `period` seconds and was last due at `phase`. Each
    /// sample was taken at the first step at or after its due time; a shorter period than a step counts as a step,
    /// which takes one sample at most.
    pub fn begin_periodic<T: Real>(&self, step: f64, [period, phase]: [f64; 2], numbers: &mut [T]) {
        let n = self.samples;
        numbers[self.start] = T::new(phase);
        let spacing = period.max(step);
        let last = if phase > -period { phase } else { -spacing };
        for (k, time) in numbers[self.times()].iter_mut().enumerate() {
            let due = last - (n - 1 - k) as f64 * spacing;
            *time = T::new((due / step).ceil() * step);
        }
    }

    /// Returns the lanes in which a sample is due at a time; all of them if the period is zero.
    #[inline(always)]
    pub fn is_due<T: Real>(&self, numbers: &[T], period: T, now: T) -> T::Mask {
        !period.gt(T::ZERO) | (numbers[self.start] + period).le(now)
    }

    /// Adds a sample of the present where it is due, and advances time by `step` seconds.
    #[inline(always)]
    pub(crate) fn push_periodic<T: Real>(
        &self,
        numbers: &mut [T],
        sample: &[T],
        (period, now): (T, T),
        step: T,
    ) {
        let due = self.is_due(numbers, period, now);
        numbers[self.start] += T::select(due, period, T::ZERO);
        if due.all() {
            self.push(numbers, sample, step);
            return;
        }
        let values = &mut numbers[self.values()];
        for k in 0..values.len() {
            let next = k + self.width;
            let shifted = match values.get(next) {
                Some(&value) => value,
                None => sample[next - values.len()],
            };
            values[k] = T::select(due, shifted, values[k]);
        }
        let times = &mut numbers[self.times()];
        for k in 0..times.len() {
            let shifted = times.get(k + 1).copied().unwrap_or(T::ZERO);
            times[k] = T::select(due, shifted, times[k]) - step;
        }
    }

    /// Adds a sample of the present, and advances time by `step` seconds.
    #[inline(always)]
    pub fn push<T: Real>(&self, numbers: &mut [T], sample: &[T], step: T) {
        let values = &mut numbers[self.values()];
        values.copy_within(self.width.., 0);
        let last = values.len() - self.width;
        values[last..].copy_from_slice(sample);
        let times = &mut numbers[self.times()];
        times.copy_within(1.., 0);
        times[self.samples - 1] = T::ZERO;
        for time in times {
            *time -= step;
        }
    }

    /// Reads the buffer at a time relative to the present. Outside the samples it returns the oldest or the newest.
    #[inline(always)]
    pub fn read<T: Real>(&self, numbers: &[T], at: T, out: &mut [T]) {
        let (times, values) = (&numbers[self.times()], &numbers[self.values()]);
        let rounding = T::new(SAME_TIME_ROUNDING) * T::splat(T::Scalar::EPSILON) * at.abs();
        let same = rounding.max(T::new(SAME_TIME));
        let value = |k: usize, part: usize| values[k * self.width + part];
        for (part, out) in out.iter_mut().enumerate() {
            *out = value(0, part);
        }
        for k in 1..self.samples {
            let reached = times[k].le(at + same);
            let between = !reached & (times[k - 1] + same).lt(at);
            for (part, out) in out.iter_mut().enumerate() {
                let inside = match self.interpolation {
                    Interpolation::Hold => value(k - 1, part),
                    Interpolation::Linear => line(times, k, at, |k| value(k, part)),
                    Interpolation::Cubic => cubic(times, k, at, |k| value(k, part)),
                };
                *out = T::select(reached, value(k, part), T::select(between, inside, *out));
            }
        }
    }
}

/// Returns the time between two samples, and the fraction of it that has passed. Samples with equal times count as one
/// second apart.
#[inline(always)]
fn share<T: Real>(times: &[T], k: usize, at: T) -> (T, T) {
    let span = times[k] - times[k - 1];
    let span = T::select(span.gt(T::ZERO), span, T::ONE);
    (span, (at - times[k - 1]) / span)
}

#[inline(always)]
fn line<T: Real>(times: &[T], k: usize, at: T, value: impl Fn(usize) -> T) -> T {
    let (_, share) = share(times, k, at);
    value(k - 1) + share * (value(k) - value(k - 1))
}

#[inline(always)]
fn cubic<T: Real>(times: &[T], k: usize, at: T, value: impl Fn(usize) -> T) -> T {
    let (span, x) = share(times, k, at);
    let slope = |before: usize, after: usize| {
        let time = times[after] - times[before];
        (value(after) - value(before)) / T::select(time.gt(T::ZERO), time, T::ONE)
    };
    let left = if k > 1 { slope(k - 2, k) } else { T::ZERO };
    let right = if k + 1 < times.len() {
        slope(k - 1, k + 1)
    } else {
        T::ZERO
    };
    let (two, three) = (T::new(2.0), T::new(3.0));
    let (squared, cubed) = (x * x, x * x * x);
    let rise = three * squared - two * cubed;
    value(k - 1) * (T::ONE - rise)
        + span * left * (cubed - two * squared + x)
        + value(k) * rise
        + span * right * (cubed - squared)
}
