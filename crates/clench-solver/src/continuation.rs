//! Very stiff elliptic cones are approached through softer ones.
//!
//! Along a stiff cone's surface the cost is a narrow curved valley: a Newton step leaves it, the next one spends itself on
//! coming back, and hundreds are needed. The minimiser of a softer problem lies in a wider valley and close to where the
//! stiffer one's begins. So where the stiffness of some cone, relative to its inertia A = J M⁻¹ Jᵀ, is beyond what contacts
//! of MuJoCo's impedances have (R = A (1 − d)/d with d ≤ 0.9999), R starts at least as large as a part of A, and falls in
//! stages to its own value. Only the last stage, the problem itself, can end a solve.

use crate::jacobian::BlockIndex;
use crate::{Cost, Problem};
use clench_math::{Mask, Real, kernel};

/// A D above which a cone is very stiff.
const STIFF: f64 = 2e4;
/// A D of the first stage, and by how much it grows from one to the next.
const FIRST: f64 = 10.0;
const STAGE: f64 = 10.0;
/// A stage is over when an improvement falls below this part of the cost.
const SETTLED: f64 = 1e-9;

/// How much softer the cones are at present.
#[derive(Clone, Debug)]
pub(crate) struct Continuation<T: Real> {
    /// An estimate of A for each elliptic block, at the index of its entry in the active set.
    inverse_inertia: Vec<T>,
    /// The part of A that is added to R; zero in lanes that solve the problem itself.
    level: T,
    /// Largest A D.
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
    /// Solves the problem itself.
    #[inline(always)]
    pub(crate) fn reset(&mut self) {
        self.level = T::ZERO;
    }

    /// Starts with the first stage in those lanes of `mask` that have a very stiff cone; returns them.
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
            // Σ j² / M_ii is what A would be without coupling between dofs.
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

    /// The lanes that do not solve the problem itself yet.
    #[inline(always)]
    pub(crate) fn active(&self) -> T::Mask {
        self.level.gt(T::ZERO)
    }

    /// Moves to the next stage where this one is over; returns those lanes.
    #[inline(always)]
    pub(crate) fn advance(&mut self, improvement: T, cost: T) -> T::Mask {
        let over = self.active() & !improvement.gt(T::new(SETTLED) * cost);
        let next = self.level * T::new(1.0 / STAGE);
        let last = (next * self.stiffest).lt(T::ONE);
        self.level = T::select(over, T::select(last, T::ZERO, next), self.level);
        over
    }

    /// What is added to R of block `b`.
    #[inline(always)]
    pub(crate) fn of(&self, b: &BlockIndex) -> T {
        if b.cost == Cost::Elliptic && self.active().any() {
            self.level * self.inverse_inertia[b.active_start]
        } else {
            T::ZERO
        }
    }
}
