//! Frictional contact by Coulomb's law: a one-sided normal, and friction within a disc of fixed radius.
//!
//! Scale the tangential rows so that the disc becomes circular (see [`slip`](super::slip)). With K = D_j / μ_j², the
//! same for all j, and λ the fixed normal force:
//!
//! ```text
//! s = ½ D₀ min(y₀, 0)² + h(T),   h = ½ K T² where K T < λ, else λ T − λ² / (2 K)
//! force₀ = −D₀ min(y₀, 0),       force_j = −μ_j min(K T, λ) u_j
//! sticks  K T < λ    W = diag(D_j)
//! slides  else       W = (λ / T) F (I − u uᵀ) F,  F = diag(μ_j)
//! ```
//!
//! So h is the Huber cost of T, and Σ (force_j / μ_j)² ≤ λ²: a disc, for torsional and rolling friction an ellipsoid.
//! Friction does not change the normal force. The solver seeks the λ that equals force₀
//! ([`normal_forces`](crate::normal_forces)). Along a ray `h'' = K |U'|²` or `(λ / T) (|U'|² − (u·U')²)`.
//! Pieces: the normal 1 or 0; friction 1 if it slides, else 0.

use super::block_cost::{BlockCost, Form, MAX_DIM, RankOne, Rows, Slope, Totals, Weight};
use super::huber::RowMove;
use super::one_sided::{active, add_edge_slope, edge_divergence};
use super::slip::{Slip, SlipPath};
use clench_math::{Mask, Real};

pub(crate) struct Coulomb;

/// The disc of a block.
struct Disc<T: Real> {
    /// K.
    k: T,
    /// λ.
    radius: T,
    /// λ / K, the slip at which friction reaches its limit.
    limit: T,
}

impl<T: Real> Disc<T> {
    #[inline(always)]
    fn new(rows: Rows<T>) -> Self {
        // A lane without the contact may have zero coefficients; 1 keeps it finite.
        let mu = T::select(rows.d[1].gt(T::ZERO), rows.shape[1], T::ONE);
        Disc {
            k: rows.d[1] / (mu * mu),
            radius: rows.lambda,
            limit: rows.lambda * rows.r[1] * mu * mu,
        }
    }

    /// Returns the lanes in which friction is at its limit.
    #[inline(always)]
    fn slides(&self, slip: &Slip<T>) -> T::Mask {
        !slip.t.lt(self.limit) & self.k.gt(T::ZERO)
    }
}

impl<T: Real> BlockCost<T> for Coulomb {
    #[inline(always)]
    fn active_len(_: usize) -> usize {
        2
    }

    #[inline(always)]
    fn evaluate(
        rows: Rows<T>,
        y: &[T],
        force: &mut [T],
        active_set: &mut [T],
        totals: &mut Totals<T>,
    ) {
        let half = T::new(0.5);
        let (disc, slip) = (Disc::new(rows), Slip::new(rows.shape, |j| y[j]));
        let slides = disc.slides(&slip);
        let m = y[0].min(T::ZERO);
        force[0] = -(rows.d[0] * m);
        for j in 1..rows.d.len() {
            let limit = -(disc.radius * slip.u[j] * rows.shape[j]);
            force[j] = T::select(slides, limit, -(rows.d[j] * y[j]));
        }
        let sticking = half * disc.k * slip.t * slip.t;
        let sliding = disc.radius * (slip.t - half * disc.limit);
        totals.cost += half * rows.d[0] * m * m + T::select(slides, sliding, sticking);
        totals.curved |= slides & disc.radius.gt(T::ZERO);
        totals.mark(&mut active_set[0], active(rows.d[0], y[0]));
        totals.mark(&mut active_set[1], T::select(slides, T::ONE, T::ZERO));
    }

    #[inline(always)]
    fn hessian(rows: Rows<T>, y: &[T], active_set: &[T], weight: &mut Weight<T>) -> Form {
        let dim = rows.d.len();
        let slides = active_set[1].gt(T::ZERO);
        let disc = Disc::new(rows);
        weight[0][0] = rows.d[0] * active_set[0];
        let curved = slides & disc.radius.gt(T::ZERO);
        if !curved.any() {
            let mut any = active_set[0].gt(T::ZERO);
            for j in 1..dim {
                weight[j][j] = T::select(slides, T::ZERO, rows.d[j]);
                any |= weight[j][j].gt(T::ZERO);
            }
            return Form::diagonal_if(any.any());
        }
        let slip = Slip::new(rows.shape, |j| y[j]);
        let curvature = disc.radius * slip.inverse;
        for i in 1..dim {
            weight[0][i] = T::ZERO;
            weight[i][0] = T::ZERO;
            for j in i..dim {
                let (unit, stick) = match i == j {
                    true => (T::ONE, rows.d[i]),
                    false => (T::ZERO, T::ZERO),
                };
                let across = unit - slip.u[i] * slip.u[j];
                let surface = curvature * rows.shape[i] * rows.shape[j] * across;
                weight[i][j] = T::select(slides, surface, stick);
                weight[j][i] = weight[i][j];
            }
        }
        Form::Full
    }

    #[inline(always)]
    fn changes(rows: Rows<T>, old: &[T], new: &[T], mut emit: impl FnMut(RankOne<T>)) {
        // Friction that slides without being curved has no radius, and no Hessian.
        for row in 0..rows.d.len() {
            let change = match row {
                0 => new[0] - old[0],
                _ => old[1] - new[1],
            };
            emit(RankOne {
                sigma: rows.d[row] * change,
                row,
                side: None,
            });
        }
    }

    #[inline(always)]
    fn slope(rows: Rows<T>, y: &[T], dy: &[T], alpha: T, slope: &mut Slope<T>) {
        add_edge_slope(rows.d[0], y[0], dy[0], alpha, slope);
        let Path {
            disc,
            after,
            slip,
            huber,
            ..
        } = Path::new(rows, y, dy, alpha);
        // The slope is K c u·U' with c = min(T, λ / K).
        let end = after.t.min(disc.limit);
        slope.growth += disc.k * (huber.change * slip.along + end * slip.turn);
        let u = slip.along + slip.turn;
        let across = (slip.squares - u * u).max(T::ZERO);
        let sliding = disc.radius * after.inverse * across;
        let slides = disc.slides(&after);
        slope.second += T::select(slides, sliding, disc.k * slip.squares);
    }

    #[inline(always)]
    fn divergence(rows: Rows<T>, y: &[T], dy: &[T], alpha: T) -> T {
        let path = Path::new(rows, y, dy, alpha);
        let start = path.before.t.min(path.disc.limit);
        let huber = path.huber.change * path.huber.beyond;
        let friction = path.disc.k * (huber + start * path.slip.bend);
        edge_divergence(rows.d[0], y[0], alpha * dy[0]) + friction
    }
}

impl Coulomb {
    /// Returns μ_j u_j of the friction rows: sliding friction is −λ times this.
    #[inline(always)]
    pub(crate) fn slip_direction<T: Real>(rows: Rows<T>, y: &[T]) -> [T; MAX_DIM] {
        let mut direction = Slip::new(rows.shape, |j| y[j]).u;
        for j in 1..rows.d.len() {
            direction[j] *= rows.shape[j];
        }
        direction
    }
}

/// A block moving from y to y + α dy.
struct Path<T: Real> {
    disc: Disc<T>,
    before: Slip<T>,
    after: Slip<T>,
    slip: SlipPath<T>,
    /// The change of the Huber cost of T.
    huber: RowMove<T>,
}

impl<T: Real> Path<T> {
    #[inline(always)]
    fn new(rows: Rows<T>, y: &[T], dy: &[T], alpha: T) -> Self {
        let disc = Disc::new(rows);
        let before = Slip::new(rows.shape, |j| y[j]);
        let after = Slip::new(rows.shape, |j| y[j] + alpha * dy[j]);
        let slip = SlipPath::new(rows.shape, dy, alpha, [&before, &after]);
        let step = alpha * slip.along + slip.bend;
        Path {
            huber: RowMove::new(disc.limit, before.t, step),
            disc,
            before,
            after,
            slip,
        }
    }
}
