//! Frictional contact with the exact cone, as MuJoCo defines it.
//!
//! Scale y so that the cone becomes circular, with μ the regularized coefficient (row 0 of `shape`):
//!
//! ```text
//! N = μ y₀,   U_j = μ_j y_j,   T = |U|,   u = U / T,   K = D₀ / (μ² (1 + μ²))
//! top     N ≥ μT          s = 0                      the contact separates
//! bottom  μN + T ≤ 0      s = ½ Σ D y²               friction sticks
//! middle                  s = ½ K (N − μT)²          friction slips, the force is on the cone's surface
//! ```
//!
//! Since D_j = D₀ (μ_j/μ)² (the regularization that makes the three zones continuous), Σ D y² = (D₀/μ²)(N² + T²), and
//! (1 + μ²)(N² + T²) = (N − μT)² + (μN + T)². So with p = min(N − μT, 0) and q = min(μN + T, 0), all zones are
//!
//! ```text
//! s = ½ K (p² + q²)
//! force₀ = −K μ (p + μ q),      force_j = K μ_j u_j (μ p − q)
//! ```
//!
//! In the middle, with c = −p μ / T = μ² − μN/T ≥ 0, w = (1, −μ u) = ∇(N − μT), F = diag(μ, μ_j), and I over U alone,
//! `W = K F [ w wᵀ + c (I − u uᵀ) ] F`; along a ray `s'' = K [ (N' − μ u·U')² + c (|U'|² − (u·U')²) ]`.
//! In the bottom zone W = diag(D).
//! The piece is 0, 1, 2 for top, middle, bottom.

use super::block_cost::{BlockCost, Form, RankOne, Rows, Slope, Totals, Weight};
use super::slip::{Slip, SlipPath};
use clench_math::{Mask, Real};

pub(crate) struct Elliptic;

/// A block at one y, in the scaled coordinates.
struct Zone<T: Real> {
    k: T,
    mu: T,
    /// N − μT and μN + T if negative, else 0.
    p: T,
    q: T,
    /// T and u.
    slip: Slip<T>,
    /// μ² − μ N/T in the middle zone.
    c: T,
    /// The middle and the bottom zone; false in lanes without the contact.
    middle: T::Mask,
    bottom: T::Mask,
}

impl<T: Real> Zone<T> {
    #[inline(always)]
    fn new(rows: Rows<T>, y: impl Fn(usize) -> T) -> Self {
        let exists = rows.d[0].gt(T::ZERO);
        // A lane without the contact may have zero coefficients; 1 keeps it finite.
        let mu = T::select(exists, rows.shape[0], T::ONE);
        let k = rows.d[0] / (mu * mu * (T::ONE + mu * mu) * stiffening(rows));
        let n = mu * y(0);
        let slip = Slip::new(rows.shape, y);
        let (t, inverse) = (slip.t, slip.inverse);
        let (a, b) = (n - mu * t, mu * n + t);
        let top = a.ge(T::ZERO);
        let bottom = !top & b.le(T::ZERO) & exists;
        let middle = !top & !bottom & exists;
        Zone {
            k,
            mu,
            p: a.min(T::ZERO),
            q: T::select(bottom, b, T::ZERO),
            slip,
            c: T::select(middle, mu * mu - mu * n * inverse, T::ZERO),
            middle,
            bottom,
        }
    }

    #[inline(always)]
    fn cost(&self) -> T {
        T::new(0.5) * self.k * (self.p * self.p + self.q * self.q)
    }
}

/// Returns the factor by which the block would be stiffer without continuation.
#[inline(always)]
fn stiffening<T: Real>(rows: Rows<T>) -> T {
    T::ONE + rows.d[0] * rows.softer
}

impl<T: Real> BlockCost<T> for Elliptic {
    #[inline(always)]
    fn active_len(_: usize) -> usize {
        1
    }

    #[inline(always)]
    fn evaluate(
        rows: Rows<T>,
        y: &[T],
        force: &mut [T],
        active_set: &mut [T],
        totals: &mut Totals<T>,
    ) {
        let zone = Zone::new(rows, |j| y[j]);
        let normal = -(zone.k * zone.mu * (zone.p + zone.mu * zone.q));
        // In the middle zone friction is exactly on the cone, so it follows from the normal force.
        let slip = zone.k * (zone.mu * zone.p - zone.q);
        force[0] = normal;
        for j in 1..rows.d.len() {
            force[j] = slip * zone.slip.u[j] * rows.shape[j];
            if T::IS_DUAL {
                // Without slip there is no direction u, but friction has derivatives.
                force[j] = T::select(zone.bottom, -(rows.d[j] * y[j]), force[j]);
            }
        }
        totals.cost += zone.cost();
        totals.curved |= zone.middle;
        let now = T::select(
            zone.bottom,
            T::new(2.0),
            T::select(zone.middle, T::ONE, T::ZERO),
        );
        totals.mark(&mut active_set[0], now);
    }

    #[inline(always)]
    fn hessian(rows: Rows<T>, y: &[T], _: &[T], weight: &mut Weight<T>) -> Form {
        let dim = rows.d.len();
        let zone = Zone::new(rows, |j| y[j]);
        if !zone.middle.any() {
            for i in 0..dim {
                weight[i][i] = T::select(zone.bottom, rows.d[i] / stiffening(rows), T::ZERO);
            }
            return if zone.bottom.any() {
                Form::Diagonal
            } else {
                Form::Zero
            };
        }
        let Zone {
            k,
            mu,
            slip: Slip { ref u, .. },
            c,
            middle,
            bottom,
            ..
        } = zone;
        let scale = |j: usize| if j == 0 { mu } else { rows.shape[j] };
        let w = |j: usize| if j == 0 { T::ONE } else { -(mu * u[j]) };
        for i in 0..dim {
            for j in i..dim {
                let mut curvature = w(i) * w(j);
                if i > 0 {
                    let unit = if i == j { T::ONE } else { T::ZERO };
                    curvature += c * (unit - u[i] * u[j]);
                }
                let surface = k * scale(i) * scale(j) * curvature;
                let stick = if i == j {
                    T::select(bottom, rows.d[i] / stiffening(rows), T::ZERO)
                } else {
                    T::ZERO
                };
                weight[i][j] = T::select(middle, surface, stick);
                weight[j][i] = weight[i][j];
            }
        }
        Form::Full
    }

    #[inline(always)]
    fn changes(rows: Rows<T>, old: &[T], new: &[T], mut emit: impl FnMut(RankOne<T>)) {
        // Between top (0) and bottom (2) all rows become active or inactive.
        let change = T::new(0.5) * (new[0] - old[0]);
        for row in 0..rows.d.len() {
            emit(RankOne {
                sigma: rows.d[row] * change,
                row,
                side: None,
            });
        }
    }

    #[inline(always)]
    fn slope(rows: Rows<T>, y: &[T], dy: &[T], alpha: T, slope: &mut Slope<T>) {
        let Path {
            before,
            after,
            dp,
            dq,
            dn,
            slip:
                SlipPath {
                    along,
                    turn,
                    squares,
                    ..
                },
            ..
        } = Path::new(rows, y, dy, alpha);
        let (k, mu) = (after.k, after.mu);
        let slip = |zone: &Zone<T>| zone.q - mu * zone.p;
        let normal = (dp + mu * dq) * dn;
        slope.growth += k * (normal + (dq - mu * dp) * (along + turn) + slip(&before) * turn);
        let end = along + turn;
        let da = dn - mu * end;
        let surface = k * (da * da + after.c * (squares - end * end));
        let stick = k * (T::ONE + mu * mu) * (dn * dn + squares);
        slope.second += T::select(
            after.middle,
            surface,
            T::select(after.bottom, stick, T::ZERO),
        );
    }

    #[inline(always)]
    fn divergence(rows: Rows<T>, y: &[T], dy: &[T], alpha: T) -> T {
        let Path {
            before,
            dp,
            dq,
            dn,
            slip: SlipPath { along, bend, .. },
            in_p,
            in_q,
            ..
        } = Path::new(rows, y, dy, alpha);
        let mu = before.mu;
        // The distances of p and q from their tangents at the start.
        let p = T::select(in_p, -(mu * bend), dp - alpha * (dn - mu * along));
        let q = T::select(in_q, bend, dq - alpha * (mu * dn + along));
        before.k * (T::new(0.5) * (dp * dp + dq * dq) + before.p * p + before.q * q)
    }
}

/// A block moving from y to y + α dy, with T and u at both ends.
struct Path<T: Real> {
    before: Zone<T>,
    after: Zone<T>,
    /// p₁ − p₀, q₁ − q₀.
    dp: T,
    dq: T,
    /// N'.
    dn: T,
    slip: SlipPath<T>,
    /// The lanes in which p, and in which q, is negative at both ends.
    in_p: T::Mask,
    in_q: T::Mask,
}

impl<T: Real> Path<T> {
    /// Computes the differences in a form that avoids cancellation for small steps.
    #[inline(always)]
    fn new(rows: Rows<T>, y: &[T], dy: &[T], alpha: T) -> Self {
        let before = Zone::new(rows, |j| y[j]);
        let after = Zone::new(rows, |j| y[j] + alpha * dy[j]);
        let dn = before.mu * dy[0];
        let slip = SlipPath::new(rows.shape, dy, alpha, [&before.slip, &after.slip]);
        let dt = alpha * slip.along + slip.bend;
        let in_p = before.p.lt(T::ZERO) & after.p.lt(T::ZERO);
        let in_q = before.bottom & after.bottom;
        Path {
            dp: T::select(in_p, alpha * dn - before.mu * dt, after.p - before.p),
            dq: T::select(in_q, before.mu * alpha * dn + dt, after.q - before.q),
            before,
            after,
            dn,
            slip,
            in_p,
            in_q,
        }
    }
}
