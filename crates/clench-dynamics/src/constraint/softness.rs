//! The softness of a constraint: converts solref and solimp into stiffness, damping, impedance and R. Reference
//! accelerations: `row.rs` computes the spring's part of aref, `assembly.rs` adds the damper's.
//!
//! A constraint with violation r and rate v has the reference acceleration of a damped spring; its impedance d ∈ (0, 1)
//! sets how closely it follows it:
//!
//! ```text
//! aref = −b v − k d r            R = A₀ (1 − d) / d        D = 1 / R
//! solref = (timeconst, dampratio) > 0:   b = 2 / (dmax timeconst)    k = 1 / (dmax timeconst dampratio)²
//! solref = (−stiffness, −damping) ≤ 0:   b = damping / dmax          k = stiffness / dmax²
//! solimp = (dmin, dmax, width, midpoint, power):   d = dmin + y(|r| / width) (dmax − dmin)
//! ```
//!
//! y rises from 0 at 0 to 1 at 1, y = x^p / mid^(p−1) up to the midpoint and point-symmetric in shape above. A₀ is the
//! inverse inertia of the constraint in the initial configuration, so a mass of any size on one such constraint follows
//! a = d (−b v − k d r) + (1 − d) a_unc: at dmax, a spring-damper with the time constant of solref. The rules and
//! limits are those of MuJoCo 4.0 (Computation, "Constraint model"), with one addition: no time constant is shorter
//! than `constraint_timeconst`.
//!
//! The integrator `discrete` evaluates the spring-damper at the end of the step, at the violation r + h v⁺ and the rate
//! v⁺ = v + h a, and solves for a:
//!
//! ```text
//! aref = (−b v − k d (r + h v)) / β        R = A (1 − d) / (d β)        β = 1 + h b + h² k d
//! ```
//!
//! R is at least that of the maximum impedance. A is A₀ times Σ Jᵢ² / M̂ᵢᵢ over Σ Jᵢ² / Mᵢᵢ, the metric M̂'s share of
//! the inverse inertia. All rows of a cone share the R of their normal, or of the first edge of a pyramid.

use clench_math::{Mask, Real, Scalar, array};

/// The minimum of R and of the width of the impedance's rise (MuJoCo's `mjMINVAL`).
const MIN_VALUE: f64 = 1e-15;
/// The same in roundings: `MIN_VALUE` is 4.5 roundings of double precision at 1.
const MIN_ROUNDINGS: f64 = 4.5;
/// The limits of the impedance (MuJoCo's `mjMINIMP`, `mjMAXIMP`).
const IMPEDANCE_RANGE: [f64; 2] = [0.0001, 0.9999];
/// These limits, by their names in the GPU kernels.
pub const SOFTNESS_CONSTANTS: &[(&str, f64)] = &[
    ("MIN_IMPEDANCE", IMPEDANCE_RANGE[0]),
    ("MAX_IMPEDANCE", IMPEDANCE_RANGE[1]),
];
/// MuJoCo's default reference dynamics: time constant 0.02 s, damping ratio 1. They replace a solref of mixed signs.
pub const DEFAULT_SOLREF: [f64; 2] = [0.02, 1.0];
/// MuJoCo's default impedance.
pub const DEFAULT_SOLIMP: [f64; 5] = [0.9, 0.95, 0.001, 0.5, 2.0];

/// The spring-damper of a constraint.
#[derive(Clone, Copy, Debug)]
pub struct Softness<T> {
    /// d, in (0, 1).
    pub impedance: T,
    /// k d, 1/s².
    pub stiffness: T,
    /// b, 1/s.
    pub damping: T,
}

impl<T: Real> Softness<T> {
    /// Creates the softness of a constraint at violation `r`; no time constant is below `min_timeconst` (s).
    #[inline(always)]
    pub fn new(solref: [T; 2], solimp: [T; 5], r: T, min_timeconst: T) -> Self {
        let mixed = is_mixed(solref);
        let solref = array(
            #[inline(always)]
            |i| T::select(mixed, T::new(DEFAULT_SOLREF[i]), solref[i]),
        );
        let impedance = impedance(solimp, r);
        let (k, damping) = spring_damper(solref, solimp[1], min_timeconst);
        Softness {
            impedance,
            stiffness: k * impedance,
            damping,
        }
    }

    /// Returns k d and b of friction dimensions with their own solref; those of `self` if it is zero or mixed.
    #[inline(always)]
    pub(crate) fn friction_spring(
        &self,
        solref: [T; 2],
        solimp: [T; 5],
        min_timeconst: T,
    ) -> (T, T) {
        let specified = !(solref[0].eq(T::ZERO) & solref[1].eq(T::ZERO)) & !is_mixed(solref);
        if !specified.any() {
            return (self.stiffness, self.damping);
        }
        let (k, damping) = spring_damper(solref, solimp[1], min_timeconst);
        (
            T::select(specified, k * self.impedance, self.stiffness),
            T::select(specified, damping, self.damping),
        )
    }

    /// Returns the softness for a step of length `timestep` that evaluates the spring at its end. A spring of time
    /// constant and damping ratio `solref` that the step cannot resolve becomes the stiffest that it can, with the same
    /// damping ratio.
    ///
    /// A step of length h resolves κ = h² k d up to 1: a body that falls on such a spring rests on it after a step,
    /// without penetration or rebound (`tests/suite/discrete.rs`).
    #[inline(always)]
    #[must_use]
    pub fn resolved(self, solref: [T; 2], timestep: T) -> Self {
        let standard = solref[0].gt(T::ZERO) | is_mixed(solref);
        let kappa = timestep * timestep * self.stiffness;
        let stiff = standard & kappa.gt(T::ONE);
        if !stiff.any() {
            return self;
        }
        let per_square = T::ONE / (timestep * timestep);
        let slower = (T::ONE / T::select(stiff, kappa, T::ONE)).sqrt();
        Softness {
            stiffness: T::select(stiff, per_square, self.stiffness),
            damping: self.damping * slower,
            ..self
        }
    }

    /// Returns R of a row with the inverse inertia `a0`.
    #[inline(always)]
    pub fn regularization(&self, a0: T) -> T {
        inverse_weight(self.impedance, a0)
    }
}

/// Returns R of a row with impedance `d` and inverse inertia `a`.
#[inline(always)]
pub(crate) fn inverse_weight<T: Real>(d: T, a: T) -> T {
    above_least((T::ONE - d) * a / d)
}

/// Returns the factor of R of a row with impedance `d` whose spring-damper is evaluated at the end of a step: 1 / β as
/// for the reference acceleration, but R is at least that of the maximum impedance.
#[inline(always)]
pub(crate) fn implicit_ratio<T: Real>(d: T, beta: T) -> T {
    let max_impedance = T::new(IMPEDANCE_RANGE[1]);
    (T::ONE / beta).max(d * (T::ONE - max_impedance) / (max_impedance * (T::ONE - d)))
}

/// Returns R, clamped to its minimum.
#[inline(always)]
pub(crate) fn above_least<T: Real>(r: T) -> T {
    r.max(T::new(MIN_VALUE))
}

/// Returns the minimum of R of a row whose current inverse inertia is about `a`, in a working precision below double.
/// (Double precision uses `MIN_VALUE`, as MuJoCo does.)
///
/// A₀ can be zero while `a` is not, if a centre of mass lies on a joint's axis. The stiffness a / R of such a row, in
/// units of the inertia that it moves, must stay finite in the working precision.
#[inline(always)]
pub(crate) fn least_regularization<T: Real>(a: T) -> T {
    a * T::splat(T::Scalar::EPSILON) * T::new(MIN_ROUNDINGS)
}

#[inline(always)]
fn is_mixed<T: Real>(solref: [T; 2]) -> T::Mask {
    let (a, b) = (solref[0].gt(T::ZERO), solref[1].gt(T::ZERO));
    (a & !b) | (!a & b)
}

/// Returns (k, b) of a solref whose signs agree.
#[inline(always)]
fn spring_damper<T: Real>(solref: [T; 2], dmax: T, min_timeconst: T) -> (T, T) {
    let least = T::new(MIN_VALUE);
    let dmax = clamp_impedance(dmax);
    let [first, second] = solref;
    let standard = first.gt(T::ZERO);
    let timeconst = first.max(min_timeconst);
    let squares = dmax * dmax * timeconst * timeconst * second * second;
    let k = T::ONE / squares.max(least);
    let b = T::new(2.0) / (dmax * timeconst).max(least);
    if standard.all() {
        return (k, b);
    }
    let (direct_k, direct_b) = (-first / (dmax * dmax), -second / dmax);
    (
        T::select(standard, k, direct_k),
        T::select(standard, b, direct_b),
    )
}

#[inline(always)]
fn clamp_impedance<T: Real>(d: T) -> T {
    d.clamp(T::new(IMPEDANCE_RANGE[0]), T::new(IMPEDANCE_RANGE[1]))
}

/// Computes the impedance at violation `r`.
#[inline(always)]
pub fn impedance<T: Real>(solimp: [T; 5], r: T) -> T {
    let [dmin, dmax, width, midpoint, power] = solimp;
    let (dmin, dmax) = (clamp_impedance(dmin), clamp_impedance(dmax));
    let flat = dmin.eq(dmax) | width.le(T::new(MIN_VALUE));
    let x = r.abs() / T::select(flat, T::ONE, width);
    let end = T::select(x.ge(T::ONE), dmax, dmin);
    let end = T::select(flat, T::new(0.5) * (dmin + dmax), end);
    let at_end = flat | x.ge(T::ONE) | x.le(T::ZERO);
    if at_end.all() {
        return end;
    }
    let x = T::select(at_end, T::new(0.5), x);
    let y = spline(x, clamp_impedance(midpoint), power.max(T::ONE));
    T::select(at_end, end, dmin + y * (dmax - dmin))
}

/// Computes y(x) for 0 < x < 1.
#[inline(always)]
fn spline<T: Real>(x: T, midpoint: T, power: T) -> T {
    let below = x.le(midpoint);
    let base = T::select(below, x, T::ONE - x);
    let edge = T::select(below, midpoint, T::ONE - midpoint);
    let y = pow(base, power) * (T::ONE / pow(edge, power - T::ONE));
    let y = T::select(below, y, T::ONE - y);
    T::select(power.eq(T::ONE), x, y)
}

/// Computes base^exponent, exact for the usual exponents 1 and 2.
#[inline(always)]
fn pow<T: Real>(base: T, exponent: T) -> T {
    let first = exponent.eq(T::ONE);
    let usual = first | exponent.eq(T::new(2.0));
    let power = T::select(first, base, base * base);
    if usual.all() {
        return power;
    }
    T::select(usual, power, base.powf(exponent))
}
