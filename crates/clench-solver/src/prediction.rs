//! Predicts the normal forces that a Newton step of Coulomb's law leads to.
//!
//! With λ fixed, a Newton step −H⁻¹ g ignores that sliding friction follows the normal force. The semi-smooth Newton
//! method for the fixed point includes it. In the linear model of a step d, with B the directions of sliding friction,
//! b_c = J_tᵀ (μ_j u_j) of each sliding contact, and D the weights of the normals that press:
//!
//! ```text
//! d = −H⁻¹ (g + B δ),   λ + δ = f(a + d) = f − D J_n d
//! (I − D J_n H⁻¹ B) δ = f − λ + D J_n H⁻¹ g
//! ```
//!
//! The system has one unknown a sliding contact. Elimination solves it for few contacts ([`SlidingSystem`]), the
//! generalized conjugate residual method for many (Eisenstat, Elman & Schultz 1983). δ of the other contacts follows
//! from d. If the limits λ + δ change no piece, the gradient with them is g + B δ, and d is also Newton's step for the
//! convex problem with these limits. The line search decreases its cost along d wherever d descends; otherwise that
//! Newton step is computed.
//!
//! A contact jams if its normal force grows faster than the limit of its friction: then its pivot is not positive. Its
//! λ becomes f, which moves it away from the solution that repels. Any other λ + δ below zero means that a contact
//! opens.

use crate::block_index::BlockIndex;
use crate::costs::{Cost, Coulomb};
use crate::hessian::Hessian;
use crate::iterate::{Iterate, add_scaled, dot};
use crate::problem::Problem;
use crate::sliding::SlidingSystem;
use clench_math::{Mask, Real, kernel};

/// The maximum number of sliding contacts whose system is solved by elimination. In heaps of hundreds it takes longer,
/// and solves need as many iterations.
pub const MAX_ELIMINATED: usize = 16;

/// The step d is taken if the cosine of its angle to the negative gradient exceeds this. With five times as much,
/// solves take more iterations.
pub(crate) const MIN_COSINE: f64 = 0.01;

/// The maximum number of directions, and the residual, relative to the right-hand side, at which the method stops. The
/// next Newton step corrects the remaining error.
const MAX_DIRECTIONS: usize = 6;
const RESIDUAL: f64 = 1e-2;

/// The memory of predictions.
#[derive(Clone, Debug, Default)]
pub(crate) struct Prediction<T> {
    /// The Coulomb blocks.
    blocks: Vec<BlockIndex>,
    /// The entries μ_j u_j of B for each row; for each block D, and 1 where it slides, else 0.
    friction: Vec<T>,
    weights: Vec<T>,
    slides: Vec<T>,
    /// The λ of each block if λ + δ is below zero: zero after elimination, else f, since the contact may jam.
    lowest: Vec<T>,
    /// Elimination: the system, the blocks of its unknowns, and D of those that slide.
    system: SlidingSystem<T>,
    unknowns: Vec<usize>,
    pressing: Vec<T>,
    /// δ of each block; the residual, one number an unknown of elimination or a block; pairs of a direction and its
    /// image, one number a block.
    delta: Vec<T>,
    residual: Vec<T>,
    directions: Vec<T>,
    /// H⁻¹ B times each direction, and −d; one number a dof.
    responses: Vec<T>,
    step: Vec<T>,
    /// Forces of rows, and a vector over dofs.
    rows: Vec<T>,
    dofs: Vec<T>,
}

impl<T: Real> Prediction<T> {
    /// Moves λ to the prediction in the lanes of `mask` in which a contact slides, and evaluates the iterate; `hessian`
    /// is factored there. Returns the lanes in which d is the next step. If all contacts stick, their limits have no
    /// effect.
    #[kernel]
    pub fn run(
        &mut self,
        problem: &Problem<T>,
        hessian: &mut Hessian<T>,
        iterate: &mut Iterate<T>,
        mask: T::Mask,
    ) -> T::Mask {
        let mask = self.prepare(problem, iterate, mask);
        if !mask.any() {
            return mask;
        }
        self.delta.clear();
        self.delta.resize(self.blocks.len(), T::ZERO);
        self.step.clear();
        self.step.extend_from_slice(&iterate.gradient);
        self.lowest.clear();
        (self.lowest).extend(self.blocks.iter().map(|b| iterate.force[b.row]));
        let sliding = (self.slides.iter()).fold(T::ZERO, |sum, &slides| sum + slides);
        let many = mask & sliding.gt(T::new(MAX_ELIMINATED as f64));
        if many.any() {
            self.solve_by_residuals(problem, hessian, iterate, many);
        }
        let mut jammed = T::Mask::splat(false);
        if (mask & !many).any() {
            jammed = self.solve_by_elimination(problem, hessian, iterate, mask & !many);
        }
        for (k, b) in self.blocks.iter().enumerate() {
            if self.slides[k].eq(T::ZERO).any() {
                let predicted = self.predicted(problem, iterate, k, b, mask);
                self.delta[k] += (T::ONE - self.slides[k]) * predicted;
            }
        }
        (iterate.normal_forces).move_by(&self.blocks, [&self.delta, &self.lowest], mask);
        iterate.evaluate(problem);
        let norm = iterate.differentiate(problem);
        let descent = dot(&self.step, &iterate.gradient);
        let length = dot(&self.step, &self.step).sqrt();
        mask & !jammed & descent.gt(T::new(MIN_COSINE) * length * norm)
    }

    /// Computes δ of the sliding contacts and −d by elimination, in the lanes of `mask`. Returns the lanes in which a
    /// contact jams, which d ignores.
    #[inline(always)]
    fn solve_by_elimination(
        &mut self,
        problem: &Problem<T>,
        hessian: &mut Hessian<T>,
        iterate: &Iterate<T>,
        mask: T::Mask,
    ) -> T::Mask {
        self.system.clear();
        self.unknowns.clear();
        self.residual.clear();
        self.pressing.clear();
        let rows = &problem.jacobian;
        for (k, b) in self.blocks.iter().enumerate() {
            let slides = T::select(mask, self.slides[k], T::ZERO);
            if slides.gt(T::ZERO).any() {
                self.unknowns.push(k);
                let missing = iterate.force[b.row] - iterate.normal_forces.of(b);
                self.residual.push(slides * missing);
                self.delta[k] = T::select(mask, slides * missing, self.delta[k]);
                self.pressing.push(slides * self.weights[k]);
                let friction = &self.friction[b.rows()];
                (self.system).push(hessian, rows.dofs(b), rows.values(b), friction);
            }
        }
        self.dofs.clear();
        self.dofs.extend_from_slice(&iterate.gradient);
        (self.system).solve(hessian, &self.pressing, &mut self.residual, &mut self.dofs);
        let mut jammed = T::Mask::splat(false);
        for (i, (&k, &delta)) in self.unknowns.iter().zip(&self.residual).enumerate() {
            // The δ of a contact that jams stays f − λ.
            let jams = self.system.jams(i);
            jammed |= jams & mask;
            self.delta[k] = T::select(mask & !jams, delta, self.delta[k]);
        }
        for lowest in &mut self.lowest {
            *lowest = T::select(mask, T::ZERO, *lowest);
        }
        for (step, &x) in self.step.iter_mut().zip(&self.dofs) {
            *step = T::select(mask, x, *step);
        }
        jammed
    }

    /// Computes the same by generalized conjugate residuals.
    #[inline(always)]
    fn solve_by_residuals(
        &mut self,
        problem: &Problem<T>,
        hessian: &mut Hessian<T>,
        iterate: &Iterate<T>,
        mask: T::Mask,
    ) {
        let count = self.blocks.len();
        self.dofs.clear();
        self.dofs.extend_from_slice(&iterate.gradient);
        self.solve(hessian);
        self.step.copy_from_slice(&self.dofs);
        self.residual.clear();
        for (k, b) in self.blocks.iter().enumerate() {
            let predicted = self.predicted(problem, iterate, k, b, mask);
            self.residual.push(self.slides[k] * predicted);
        }
        self.directions.clear();
        self.responses.clear();
        let small = T::new(RESIDUAL * RESIDUAL) * dot(&self.residual, &self.residual);
        let mut open = mask;
        for i in 0..MAX_DIRECTIONS {
            open &= dot(&self.residual, &self.residual).gt(small);
            if !open.any() {
                break;
            }
            self.push_direction(problem, hessian);
            self.orthogonalize(i, count);
            let (direction, image) = self.directions[2 * i * count..].split_at(count);
            let square = dot(image, image);
            open &= square.gt(T::ZERO);
            let alpha = dot(&self.residual, image) / square;
            let alpha = T::select(open, alpha, T::ZERO);
            for k in 0..count {
                self.delta[k] += alpha * direction[k];
                self.residual[k] -= alpha * image[k];
            }
            add_scaled(
                &mut self.step,
                alpha,
                &self.responses[i * self.dofs.len()..],
            );
        }
    }

    /// Computes δ = f − λ − D J_n d of the `k`-th block; zero outside the lanes of `mask`.
    #[inline(always)]
    fn predicted(
        &self,
        problem: &Problem<T>,
        iterate: &Iterate<T>,
        k: usize,
        b: &BlockIndex,
        mask: T::Mask,
    ) -> T {
        let growth = self.weights[k] * normal_product(problem, b, &self.step);
        let missing = iterate.force[b.row] - iterate.normal_forces.of(b);
        T::select(mask, missing + growth, T::ZERO)
    }

    /// Returns −d of the last prediction.
    #[inline(always)]
    pub(crate) fn step(&self) -> &[T] {
        &self.step
    }

    /// Computes `dofs ← H⁻¹ dofs`. Not inlined in its two callers: it is long.
    #[inline(never)]
    fn solve(&mut self, hessian: &mut Hessian<T>) {
        hessian.solve(&mut self.dofs);
    }

    /// Lists the blocks with B and D; both are zero outside the lanes of `mask`. Returns the lanes in which one slides
    /// under a load; without any, nothing more is prepared.
    #[inline(always)]
    fn prepare(&mut self, problem: &Problem<T>, iterate: &Iterate<T>, mask: T::Mask) -> T::Mask {
        let mut sliding = T::Mask::splat(false);
        self.blocks.clear();
        self.weights.clear();
        self.slides.clear();
        let blocks = problem.jacobian.blocks.iter();
        for b in blocks.filter(|b| b.cost == Cost::Coulomb) {
            let presses = iterate.active_set[b.active_start].gt(T::ZERO);
            let loaded = presses | iterate.normal_forces.of(b).gt(T::ZERO);
            let slides = mask & loaded & iterate.active_set[b.active_start + 1].gt(T::ZERO);
            sliding |= slides;
            self.blocks.push(*b);
            self.slides.push(T::select(slides, T::ONE, T::ZERO));
            self.weights
                .push(T::select(mask & presses, problem.d[b.row], T::ZERO));
        }
        if !sliding.any() {
            return sliding;
        }
        self.friction.resize(problem.nrow(), T::ZERO);
        self.rows.resize(problem.nrow(), T::ZERO);
        for (b, &slides) in self.blocks.iter().zip(&self.slides) {
            self.friction[b.rows()].fill(T::ZERO);
            if slides.gt(T::ZERO).any() {
                let rows = problem.rows(b);
                let direction = Coulomb::slip_direction(rows, &iterate.residual[b.rows()]);
                for j in 1..b.dim {
                    self.friction[b.row + j] = slides * direction[j];
                }
            }
        }
        sliding
    }

    /// Appends the residual as a direction, and its image under I − D J_n H⁻¹ B.
    #[inline(always)]
    fn push_direction(&mut self, problem: &Problem<T>, hessian: &mut Hessian<T>) {
        for (k, b) in self.blocks.iter().enumerate() {
            for row in b.rows() {
                self.rows[row] = self.friction[row] * self.residual[k];
            }
        }
        self.dofs.fill(T::ZERO);
        (problem.jacobian).add_transposed_of(&self.blocks, &self.rows, &mut self.dofs);
        self.solve(hessian);
        self.responses.extend_from_slice(&self.dofs);
        self.directions.extend_from_slice(&self.residual);
        for (k, b) in self.blocks.iter().enumerate() {
            let product = self.weights[k] * normal_product(problem, b, &self.dofs);
            self.directions
                .push(self.residual[k] - self.slides[k] * product);
        }
    }

    /// Makes the image of direction `i` orthogonal to those before it.
    #[inline(always)]
    fn orthogonalize(&mut self, i: usize, count: usize) {
        let nv = self.dofs.len();
        let (before, new) = self.directions.split_at_mut(2 * i * count);
        let (responses, response) = self.responses.split_at_mut(i * nv);
        for (j, pair) in before.chunks_exact(2 * count).enumerate() {
            let other_image = &pair[count..];
            let square = dot(other_image, other_image);
            let overlap = dot(&new[count..], other_image);
            let beta = T::select(square.gt(T::ZERO), overlap / square, T::ZERO);
            add_scaled(new, -beta, pair);
            add_scaled(response, -beta, &responses[j * nv..]);
        }
    }
}

/// Computes J_n x of a block.
#[inline(always)]
pub(crate) fn normal_product<T: Real>(problem: &Problem<T>, b: &BlockIndex, x: &[T]) -> T {
    let mut sum = T::ZERO;
    let dofs = problem.jacobian.dofs(b).iter();
    for (&dof, &j) in dofs.zip(problem.jacobian.values(b)) {
        sum += j * x[dof as usize];
    }
    sum
}
