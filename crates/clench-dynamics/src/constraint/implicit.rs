//! Rows whose spring-damper is evaluated at the end of the step, in the metric of the integrator `discrete`. `softness`
//! derives the formulas.

use super::row::Row;
use super::softness::{above_least, implicit_ratio};
use crate::dynamics::metric::Metric;
use clench_math::Real;
use clench_solver::{Cost, Tree};

/// The inverse inertia (1/kg, 1/(kg m²)) below which a row counts as immovable (MuJoCo's `mjMINVAL`).
const MIN_INVERSE_INERTIA: f64 = 1e-15;

/// The inputs to the computation of such rows.
pub(super) struct ImplicitRows<'a, T: Real> {
    pub tree: &'a Tree,
    pub metric: &'a Metric<T>,
    /// h, s.
    pub timestep: T,
    /// The ratio of friction to normal impedance.
    pub impratio: T,
}

impl<T: Real> ImplicitRows<'_, T> {
    /// Returns the reference acceleration of a row at `velocity`.
    #[inline(always)]
    pub(super) fn reference(&self, row: &Row<T>, velocity: T) -> T {
        let rate = row.damping + self.timestep * row.stiffness;
        (row.aref - rate * velocity) / self.beta(row)
    }

    /// Returns the change of that acceleration per change of the row's position, with the sign reversed.
    #[inline(always)]
    pub(super) fn slope(&self, row: &Row<T>) -> T {
        row.stiffness / self.beta(row)
    }

    /// Computes 1 + h b + h² k d.
    #[inline(always)]
    fn beta(&self, row: &Row<T>) -> T {
        let h = self.timestep;
        T::ONE + h * row.damping + h * h * row.stiffness
    }

    /// Updates R of the rows of a block with impedance `d`. An R that was `estimated` at the initial configuration is
    /// multiplied by the metric's share of the inverse inertia.
    #[inline(always)]
    pub(super) fn regularize(
        &self,
        cost: Cost,
        rows: &[Row<T>],
        (jacobian, dofs): (&[T], &[u32]),
        (d, estimated): (T, bool),
        r: &mut [T],
    ) {
        let factor_of = |row: &Row<T>, first: &[T], other: &[T], factor: T| {
            let implicit = implicit_ratio(d, self.beta(row));
            match estimated {
                true => implicit * self.inverse_inertia_ratio(first, other, factor, dofs),
                false => implicit,
            }
        };
        let n = dofs.len();
        // The factor of R of a cone's first row, and the scale of the R that the minimum applies to.
        let (factor, unit) = match cost {
            Cost::Quadratic | Cost::OneSided | Cost::Huber => {
                for (i, row) in rows.iter().enumerate() {
                    let factor = factor_of(row, &jacobian[i * n..(i + 1) * n], &[], T::ZERO);
                    r[i] = above_least(r[i] * factor);
                }
                return;
            }
            Cost::Pyramid => {
                let (normal, tangent) = (&jacobian[..n], &jacobian[n..2 * n]);
                let mu = rows[1].shape;
                let unit = T::ONE / (T::new(2.0) * (mu * mu / self.impratio));
                (factor_of(&rows[0], normal, tangent, mu), unit)
            }
            Cost::Elliptic | Cost::Coulomb => {
                (factor_of(&rows[0], &jacobian[..n], &[], T::ZERO), T::ONE)
            }
        };
        let first = r[0] * unit;
        let larger = above_least(first * factor) / first;
        for r in &mut r[..rows.len()] {
            *r *= larger;
        }
    }

    /// Computes Σ Jᵢ² / M̂ᵢᵢ over Σ Jᵢ² / Mᵢᵢ of J = row + factor · other; 1 if J is zero up to rounding.
    #[inline(always)]
    fn inverse_inertia_ratio(&self, row: &[T], other: &[T], factor: T, dofs: &[u32]) -> T {
        let (mut before, mut after) = (T::ZERO, T::ZERO);
        for (i, (&dof, &arm)) in dofs.iter().zip(row).enumerate() {
            let dof = dof as usize;
            let arm = match other.get(i) {
                Some(&other) => arm + factor * other,
                None => arm,
            };
            let inertia = self.metric.mass.values[self.tree.row_start(dof + 1) - 1];
            before += arm * arm / inertia;
            after += arm * arm / (inertia + self.metric.added[dof]);
        }
        let moves = before.gt(T::new(MIN_INVERSE_INERTIA));
        T::select(moves, after / T::select(moves, before, T::ONE), T::ONE)
    }
}
