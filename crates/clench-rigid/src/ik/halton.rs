//! Start postures of restarts: points of Halton's sequence (Halton 1960) over the ranges of the joints. They cover the
//! ranges more evenly than random points and are the same in every run.

use super::Ik;
use clench_dynamics::model::{JointKind, Model, Params};
use clench_math::Real;
use std::f64::consts::PI;

/// The bases of the sequence, one per dof. Further dofs reuse them with another offset.
const PRIMES: [u64; 24] = [
    2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89,
];

/// Returns `index` with its digits mirrored at the radix point, between 0 and 1.
fn radical_inverse(mut index: u64, base: u64) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0);
    while index > 0 {
        digit /= base as f64;
        value += digit * (index % base) as f64;
        index /= base;
    }
    value
}

/// Sets the slides and hinges of the search to start posture `index`: within their ranges, or within half a turn of
/// `qpos` for a hinge without a range.
#[inline(always)]
pub(super) fn sample_posture<T: Real>(
    model: &Model,
    params: &Params<T>,
    ik: &Ik,
    index: usize,
    qpos: &mut [T],
) {
    for (k, &dof) in ik.dofs.iter().enumerate() {
        let j = model.dofs[dof as usize].joint;
        let joint = &model.joints[j];
        let (round, base) = (k / PRIMES.len(), PRIMES[k % PRIMES.len()]);
        let share = T::new(radical_inverse((index + round) as u64, base));
        let q = &mut qpos[joint.qpos];
        *q = match joint.kind {
            JointKind::Slide | JointKind::Hinge if joint.limited => {
                let [low, high] = params.jnt_range[j];
                low + (high - low) * share
            }
            JointKind::Hinge => *q + T::new(2.0 * PI) * share - T::new(PI),
            JointKind::Free | JointKind::Ball | JointKind::Slide => *q,
        };
    }
}
