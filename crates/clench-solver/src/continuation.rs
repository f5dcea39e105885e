//! Continuation: very stiff elliptic cones are approached through softer ones.
//!
//! Along a stiff cone's surface the cost is a narrow curved valley: a Newton step leaves it, the next one only returns
//! to it, and hundreds are needed. The minimiser of a softer problem lies in a wider valley, close to the start of the
//! stiffer one. So if the stiffness of some cone, relative to its inertia A = J M⁻¹ Jᵀ, exceeds that of contacts with
//! MuJoCo's impedances (R = A (1 − d)/d with d ≤ 0.9999), R starts at no less than a fraction of A and decreases in
//! stages to its own value. Only the last stage, the original problem, can end a solve.

use crate::block_index::BlockIndex;
use crate::costs::Cost;
use crate::problem::Problem;
use clench_math::{Mask, Real, kernel};

/// The value of A D above which a cone is very stiff.
pub(crate) const STIFF: f64 = 2e4;
/// A D of the first stage, and its growth factor from one stage to the next.
pub(crate) const FIRST: f64 = 10.0;
pub(crate) const STAGE: f64 = 10.0;
/// A stage ends when an improvement falls below this fraction of the cost.
pub(crate) const STAGE_TOLERANCE: f64 = 1e-9;

/// The current softening of the cones.
#[derive(Clone, Debug)]
pub(crate) struct Continuation<T: Real> {
    /// An estimate of A for each elliptic block, at the index of its entry in the active set.
    inverse_inertia: Vec<T>,
    /// The fraction of A that is added to R; zero in lanes that solve the original problem.
    level: T,
    /// The largest A D.
    stiffest: T,
}

impl<T: Real> Default for Continuation<T> {
    fn default() -> Self {
        Continuation {
            inverse_inertia: Vec::new(),
            level: T::ZERO,
            stiffest: T::ZERO,
        }
    }
}

impl<T: Real> Continuation<T> {
    /// Switches to the original problem.
    #[inline(always)]
    pub(crate) fn reset(&mut self) {
        self.level = T::ZERO;
    }

    /// Starts the first stage in the lanes of `mask` that have a very stiff cone; returns these lanes.
    #[kernel]
    pub fn start(&mut self, problem: &Problem<T>, mask: T::Mask) -> T::Mask {
        self.stiffest = T::ZERO;
        self.inverse_inertia.resize(problem.nactive, T::ZERO);
        for b in problem
            .jacobian
            .blocks
            .iter()
            .filter(|b| b.cost == Cost::Elliptic)
        {
            // Σ j² / M_ii is the value of A without coupling between dofs.
            let mut sum = T::ZERO;
            for (&dof, &j) in problem
                .jacobian
                .dofs(b)
                .iter()
                .zip(problem.jacobian.values(b))
            {
                sum += j * j / problem.mass.values[problem.tree().row_start(dof as usize + 1) - 1];
            }
            self.inverse_inertia[b.active_start] = sum;
            self.stiffest = self.stiffest.max(sum * problem.d[b.row]);
        }
        let stiff = mask & self.stiffest.gt(T::new(STIFF));
        self.level = T::select(stiff, T::new(1.0 / FIRST), T::ZERO);
        stiff
    }

    /// Returns the lanes that do not solve the original problem yet.
    #[inline(always)]
    pub(crate) fn active(&self) -> T::Mask {
        self.level.gt(T::ZERO)
    }

    /// Moves to the next stage in the lanes whose stage has ended; returns these lanes.
    #[inline(always)]
    pub(crate) fn advance(&mut self, improvement: T, cost: T) -> T::Mask {
        let over = self.active() & !improvement.gt(T::new(STAGE_TOLERANCE) * cost);
        let next = self.level * T::new(1.0 / STAGE);
        let last = (next * self.stiffest).lt(T::ONE);
        self.level = T::select(over, T::select(last, T::ZERO, next), self.level);
        over
    }

    /// Returns the value added to R of block `b`.
    #[inline(always)]
    pub(crate) fn of(&self, b: &BlockIndex) -> T {
        if b.cost == Cost::Elliptic && self.active().any() {
            self.level * self.inverse_inertia[b.active_start]
        } else {
            T::ZERO
        }
    }
}
