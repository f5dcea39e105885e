//! Coulomb's law: friction is limited by the normal force of the solution.
//!
//! A Coulomb block limits friction by a fixed normal force λ, which makes the problem convex (Tresca's friction). Its
//! solution has normal forces f(λ), and Coulomb's law requires the fixed point λ = f(λ) (Haslinger, *Approximation of
//! the Signorini problem with friction, obeying the Coulomb law*, 1983). λ starts at the normal forces of the starting
//! acceleration. When an inner solve has converged, λ moves to f(λ), mixed with the last change (Anderson, *Iterative
//! procedures for nonlinear integral equations*, 1965):
//!
//! ```text
//! r = f − λ,   Δr = r − r₋,   γ = r·Δr / |Δr|²,   λ ← max(f − γ (f − f₋), 0)
//! ```
//!
//! A fixed point exists, because f is continuous and bounded: at a large λ all contacts stick. It may not be unique
//! where friction jams; the iteration from the start selects one.

use crate::block_index::BlockIndex;
use crate::costs::Cost;
use crate::problem::Problem;
use clench_math::{Mask, Real, kernel};

/// The limits of γ. A very negative γ extrapolates too far from two iterates that are close. From 1 on, the last two
/// changes point away from a repelling fixed point; the lower limit then replaces γ, and λ soon reaches an attracting
/// one.
pub(crate) const MIXING: (f64, f64) = (-10.0, 1.0);

/// The numbers of predictions and of updates after which λ is no longer predicted. Newton's method on pieces can cycle,
/// and where friction jams it can move away from the solution.
pub(crate) const MAX_PREDICTIONS: f64 = 20.0;
pub(crate) const MAX_ROUNDS: f64 = 3.0;
/// The number of predictions after which every third one moves λ only half of the way, which leaves most cycles.
pub(crate) const MAX_FULL: f64 = 8.0;
pub(crate) const CYCLE: f64 = 3.0;

/// The normal forces λ of Coulomb blocks, each at the index of its first entry in the active set.
#[derive(Clone, Debug, Default)]
pub(crate) struct NormalForces<T> {
    /// λ.
    lambda: Vec<T>,
    /// f and r of the last update, and f − f₋.
    force: Vec<T>,
    residual: Vec<T>,
    change: Vec<T>,
    /// The number of updates, and of predictions.
    rounds: T,
    predictions: T,
    /// True if the problem has Coulomb blocks.
    exist: bool,
}

impl<T: Real> NormalForces<T> {
    /// Prepares for a problem and sets λ to the normal forces at the residual `y`.
    #[kernel]
    pub fn start(&mut self, problem: &Problem<T>, y: &[T]) {
        self.exist = blocks(problem).next().is_some();
        self.rounds = T::ZERO;
        self.predictions = T::ZERO;
        for v in [
            &mut self.lambda,
            &mut self.force,
            &mut self.residual,
            &mut self.change,
        ] {
            v.clear();
            v.resize(if self.exist { problem.nactive } else { 0 }, T::ZERO);
        }
        for b in blocks(problem) {
            self.lambda[b.active_start] = -(problem.d[b.row] * y[b.row].min(T::ZERO));
        }
    }

    /// Returns the lanes in which a Newton step first predicts λ.
    #[inline(always)]
    pub(crate) fn predicts(&self) -> T::Mask {
        self.rounds.lt(T::new(MAX_ROUNDS)) & self.predictions.lt(T::new(MAX_PREDICTIONS))
    }

    /// Returns true if the problem has Coulomb blocks.
    #[inline(always)]
    pub(crate) fn exist(&self) -> bool {
        self.exist
    }

    /// Sets λ to the normal forces of `force` in the lanes of `mask`; returns γ and the lanes in which λ changes.
    #[kernel]
    pub fn replace(&mut self, problem: &Problem<T>, force: &[T], mask: T::Mask) -> (T, T::Mask) {
        let (mut overlap, mut square) = (T::ZERO, T::ZERO);
        let mut moves = T::Mask::splat(false);
        for b in blocks(problem) {
            let (k, force) = (b.active_start, force[b.row]);
            let residual = force - self.lambda[k];
            let moved = !residual.eq(T::ZERO);
            moves |= moved;
            // An unchanged λ keeps the sign of a zero. Friction takes over that sign whenever it is evaluated, which other
            // lanes may cause.
            let lambda = T::select(moved, force, self.lambda[k]);
            let growth = residual - self.residual[k];
            overlap += residual * growth;
            square += growth * growth;
            for (to, from) in [
                (&mut self.change[k], force - self.force[k]),
                (&mut self.force[k], force),
                (&mut self.residual[k], residual),
                (&mut self.lambda[k], lambda),
            ] {
                *to = T::select(mask, from, *to);
            }
        }
        let gamma = (overlap / square).max(T::new(MIXING.0));
        let gamma = T::select(gamma.lt(T::new(MIXING.1)), gamma, T::new(MIXING.0));
        let mixes = self.rounds.gt(T::ZERO) & square.gt(T::ZERO);
        self.rounds += T::select(mask, T::ONE, T::ZERO);
        (T::select(mixes, gamma, T::ZERO), moves & mask)
    }

    /// Moves λ by −γ (f − f₋) in the lanes of `mask`.
    #[kernel]
    pub fn mix(&mut self, problem: &Problem<T>, gamma: T, mask: T::Mask) {
        for b in blocks(problem) {
            let lambda = &mut self.lambda[b.active_start];
            let mixed = *lambda - gamma * self.change[b.active_start];
            *lambda = T::select(mask, mixed.max(T::ZERO), *lambda);
        }
    }

    /// Adds `delta`, one number for each of `blocks`, to λ in the lanes of `mask`; `lowest` replaces a sum below zero.
    #[kernel]
    pub fn move_by(&mut self, blocks: &[BlockIndex], [delta, lowest]: [&[T]; 2], mask: T::Mask) {
        self.predictions += T::select(mask, T::ONE, T::ZERO);
        let count = self.predictions - T::new(MAX_FULL);
        let phase = count - T::new(CYCLE) * (count / T::new(CYCLE)).floor();
        let damped = count.gt(T::ZERO) & phase.eq(T::ZERO);
        let share = T::select(damped, T::new(0.5), T::ONE);
        for ((b, &delta), &lowest) in blocks.iter().zip(delta).zip(lowest) {
            let lambda = &mut self.lambda[b.active_start];
            let moved = *lambda + delta;
            let target = T::select(moved.lt(T::ZERO), lowest, moved);
            let moved = *lambda + share * (target - *lambda);
            *lambda = T::select(mask, moved, *lambda);
        }
    }

    /// Returns `x` in the lanes in which some λ is positive, else zero.
    #[inline(always)]
    pub(crate) fn if_pressed(&self, x: T) -> T {
        let largest = (self.lambda.iter()).fold(T::ZERO, |largest, &lambda| largest.max(lambda));
        T::select(largest.gt(T::ZERO), x, T::ZERO)
    }

    /// Computes the largest |f − λ|.
    #[kernel]
    pub fn residual(&self, problem: &Problem<T>, force: &[T]) -> T {
        let differences = blocks(problem).map(|b| (force[b.row] - self.of(b)).abs());
        differences.fold(T::ZERO, |largest, difference| largest.max(difference))
    }

    /// Returns λ of block `b`; zero for other costs.
    #[inline(always)]
    pub(crate) fn of(&self, b: &BlockIndex) -> T {
        match b.cost {
            Cost::Coulomb => self.lambda[b.active_start],
            Cost::Quadratic | Cost::OneSided | Cost::Huber | Cost::Pyramid | Cost::Elliptic => {
                T::ZERO
            }
        }
    }
}

fn blocks<T: Real>(problem: &Problem<T>) -> impl Iterator<Item = &BlockIndex> {
    let blocks = problem.jacobian.blocks.iter();
    blocks.filter(|b| b.cost == Cost::Coulomb)
}
