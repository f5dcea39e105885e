//! Muscles: activation dynamics, and force = −F₀ (FL(L) FV(V) activation + FP(L)), as in MuJoCo's manual (modeling
//! chapter, "Muscles").
//!
//! Lengths are scaled so that the operating range of the actuator becomes `range`: L is the muscle's length in units of
//! its resting length L₀, V its velocity in units of the shortening velocity at zero force. FL is a bump of four
//! parabolas from `lmin` over 1 to `lmax`; FV rises by a parabola from −1, and by another to `fvmax`; FP is a parabola
//! beyond 1 that continues linearly.

use super::actuator::ActuatorContext;
use clench_math::{Real, kernel};

/// The minimum of divisors (MuJoCo's `mjMINVAL`).
const MIN_DIVISOR: f64 = 1e-15;

#[inline(always)]
fn divisor<T: Real>(x: T) -> T {
    x.max(T::new(MIN_DIVISOR))
}

/// Computes the rate of an activation under a control, both clamped to [0, 1] for the time constants.
///
/// `prm` holds the time constants of activation and deactivation (Millard et al. 2013), and the width of the transition
/// between them (MuJoCo's quintic step).
#[kernel]
pub(crate) fn activation_rate<T: Real>(ctrl: T, act: T, prm: &[T; 10]) -> T {
    let [activation, deactivation, width, ..] = *prm;
    let slowing = T::new(0.5) + T::new(1.5) * act.clamp(T::ZERO, T::ONE);
    let (rise, fall) = (activation * slowing, deactivation / slowing);
    let missing = ctrl.clamp(T::ZERO, T::ONE) - act;
    let sudden = T::select(missing.gt(T::ZERO), rise, fall);
    let smooth = fall + (rise - fall) * smooth_step(missing / divisor(width) + T::new(0.5));
    let timeconst = T::select(width.lt(T::new(MIN_DIVISOR)), sudden, smooth);
    missing / divisor(timeconst)
}

/// Returns 0 up to 0, 1 from 1 on, 6x⁵ − 15x⁴ + 10x³ between.
#[inline(always)]
fn smooth_step<T: Real>(x: T) -> T {
    let x = x.clamp(T::ZERO, T::ONE);
    let inner = T::new(3.0) * x * (T::new(2.0) * x - T::new(5.0)) + T::new(10.0);
    x * x * x * inner
}

/// A muscle at a length: its parameters, resting length and strength.
pub struct Muscle<T> {
    /// F₀.
    peak_force: T,
    /// The resting length L₀, m.
    resting: T,
    /// L.
    length: T,
    lmin: T,
    lmax: T,
    vmax: T,
    fpmax: T,
    fvmax: T,
}

impl<T: Real> Muscle<T> {
    /// Creates the muscle of an actuator at its length, with the parameters `prm` of its gain or bias.
    #[kernel]
    pub(super) fn new(at: ActuatorContext<T>, prm: &[T; 10]) -> Self {
        let [low, high, force, scale, lmin, lmax, vmax, fpmax, fvmax, _] = *prm;
        let [shortest, longest] = at.params.actuator_lengthrange[at.u];
        let resting = (longest - shortest) / divisor(high - low);
        let derived = scale / divisor(at.params.actuator_acc0[at.u]);
        Muscle {
            peak_force: T::select(force.lt(T::ZERO), derived, force),
            resting,
            length: low + (at.length - shortest) / divisor(resting),
            lmin,
            lmax,
            vmax,
            fpmax,
            fvmax,
        }
    }

    /// Returns the factor of the activation: −F₀ FL FV.
    #[inline(always)]
    pub fn gain(&self, velocity: T) -> T {
        -self.peak_force * self.active_by_length() * self.by_velocity(velocity).0
    }

    /// Returns ∂gain/∂velocity.
    #[inline(always)]
    pub(crate) fn gain_slope(&self, velocity: T) -> T {
        let slope = self.by_velocity(velocity).1 / divisor(self.resting * self.vmax);
        -self.peak_force * self.active_by_length() * slope
    }

    /// Returns the passive force, −F₀ FP.
    #[inline(always)]
    pub fn bias(&self) -> T {
        let half = T::new(0.5);
        let bend = half * (T::ONE + self.lmax);
        let width = divisor(bend - T::ONE);
        let bent = (self.length - T::ONE) / width;
        let straight = half + (self.length - bend) / width;
        let force = T::select(self.length.le(bend), half * bent * bent, straight);
        let slack = self.length.le(T::ONE);
        T::select(slack, T::ZERO, -self.peak_force * self.fpmax * force)
    }

    /// Returns ∂gain/∂length.
    #[inline(always)]
    pub(crate) fn gain_length_slope(&self, velocity: T) -> T {
        let slope = self.active_by_length_slope() / divisor(self.resting);
        -self.peak_force * slope * self.by_velocity(velocity).0
    }

    /// Returns ∂bias/∂length.
    #[inline(always)]
    pub(crate) fn bias_slope(&self) -> T {
        let bend = T::new(0.5) * (T::ONE + self.lmax);
        let width = divisor(bend - T::ONE);
        let bent = (self.length - T::ONE) / (width * width);
        let slope = T::select(self.length.le(bend), bent, T::ONE / width);
        let force = -self.peak_force * self.fpmax * slope / divisor(self.resting);
        T::select(self.length.le(T::ONE), T::ZERO, force)
    }

    /// Returns the derivative of FL by L.
    #[kernel]
    fn active_by_length_slope(&self) -> T {
        let (half, l) = (T::new(0.5), self.length);
        let (left, right) = (half * (self.lmin + T::ONE), half * (T::ONE + self.lmax));
        let per = |x: T, width: T| x / (divisor(width) * divisor(width));
        let rising = per(l - self.lmin, left - self.lmin);
        let before = per(T::ONE - l, T::ONE - left);
        let after = -per(l - T::ONE, right - T::ONE);
        let falling = -per(self.lmax - l, self.lmax - right);
        let top = T::select(l.le(T::ONE), before, after);
        let slope = T::select(l.gt(right), falling, top);
        let slope = T::select(l.le(left), rising, slope);
        T::select(l.lt(self.lmin) | l.gt(self.lmax), T::ZERO, slope)
    }

    /// Returns FL.
    #[kernel]
    fn active_by_length(&self) -> T {
        let (half, l) = (T::new(0.5), self.length);
        let (left, right) = (half * (self.lmin + T::ONE), half * (T::ONE + self.lmax));
        let rising = (l - self.lmin) / divisor(left - self.lmin);
        let before = (T::ONE - l) / divisor(T::ONE - left);
        let after = (l - T::ONE) / divisor(right - T::ONE);
        let falling = (self.lmax - l) / divisor(self.lmax - right);
        let top = T::select(l.le(T::ONE), before, after);
        let foot = T::select(l.le(left), rising, falling);
        let force = T::select(
            l.le(left) | l.gt(right),
            half * foot * foot,
            T::ONE - half * top * top,
        );
        T::select(l.lt(self.lmin) | l.gt(self.lmax), T::ZERO, force)
    }

    /// Returns FV and its derivative by V.
    #[kernel]
    fn by_velocity(&self, velocity: T) -> (T, T) {
        let v = velocity / divisor(self.resting * self.vmax);
        let (two, above) = (T::new(2.0), self.fvmax - T::ONE);
        let (from_still, to_end) = (v + T::ONE, above - v);
        let shortens = v.le(T::ZERO);
        let rises = v.le(above);
        let lengthening = T::select(
            rises,
            self.fvmax - to_end * to_end / divisor(above),
            self.fvmax,
        );
        let force = T::select(shortens, from_still * from_still, lengthening);
        let slope = T::select(rises, two * to_end / divisor(above), T::ZERO);
        let slope = T::select(shortens, two * from_still, slope);
        let idle = v.le(-T::ONE);
        (
            T::select(idle, T::ZERO, force),
            T::select(idle, T::ZERO, slope),
        )
    }
}
