//! Derivatives of positions in the tangent space: one number a dof, with rotations about the axes of the child.

use clench_dynamics::Model;
use clench_dynamics::model::{Joint, JointKind};
use clench_math::{Dual, Quat, Real};

/// Adds to the derivative of `qpos` in one slot: motion along a dof at a rate.
pub(crate) fn move_along<L: Real<Scalar = f64>, const K: usize>(
    model: &Model,
    dof: usize,
    (slot, rate): (usize, f64),
    qpos: &mut [Dual<L, K>],
) {
    let joint = &model.joints[model.joints.partition_point(|joint| joint.dof <= dof) - 1];
    move_joint(joint, dof - joint.dof, (slot, rate), qpos);
}

/// Does the same along the k-th dof of a joint.
pub(crate) fn move_joint<L: Real<Scalar = f64>, const K: usize>(
    joint: &Joint,
    k: usize,
    (slot, rate): (usize, f64),
    qpos: &mut [Dual<L, K>],
) {
    let q = joint.qpos;
    let (q, axis) = match joint.kind {
        JointKind::Ball => (q, k),
        JointKind::Free if k >= 3 => (q + 3, k - 3),
        JointKind::Free | JointKind::Slide | JointKind::Hinge => {
            add(&mut qpos[q + k], slot, rate);
            return;
        }
    };
    turn_along(&mut qpos[q..q + 4], axis, (slot, rate));
}

/// Adds to the derivative of an orientation in one slot: rotation about an axis of the child at a rate, rad.
pub(crate) fn turn_along<L: Real<Scalar = f64>, const K: usize>(
    orientation: &mut [Dual<L, K>],
    axis: usize,
    (slot, rate): (usize, f64),
) {
    // d/dε q exp(ε e / 2) = ½ q e.
    let mut half = [0.0; 4];
    half[1 + axis] = 0.5 * rate;
    let rates = quaternion(orientation) * Quat::from_f64(half);
    for (x, rate) in orientation.iter_mut().zip(rates.to_array()) {
        add(x, slot, rate);
    }
}

/// Passes the derivatives of each dof of the positions to `write`.
pub(crate) fn each_motion<L: Real<Scalar = f64>, const K: usize>(
    model: &Model,
    qpos: &[Dual<L, K>],
    mut write: impl FnMut(&[f64]),
) {
    for joint in &model.joints {
        let (translation, rotation) = match joint.kind {
            JointKind::Slide | JointKind::Hinge => (1, false),
            JointKind::Ball => (0, true),
            JointKind::Free => (3, true),
        };
        let (moved, turned) = qpos[joint.qpos..].split_at(translation);
        for x in moved {
            write(L::as_scalars(&x.tangent));
        }
        if rotation {
            for motion in turn(&turned[..4]) {
                write(L::as_scalars(&motion.tangent));
            }
        }
    }
}

/// Returns numbers whose derivatives are those of the rotation of an orientation about each axis of the child, rad.
pub(crate) fn turn<L: Real<Scalar = f64>, const K: usize>(
    orientation: &[Dual<L, K>],
) -> [Dual<L, K>; 3] {
    // 2 Im(q⁻¹ dq), linear in dq.
    let inverse = quaternion(orientation).conjugate();
    [1, 2, 3].map(|axis| {
        let mut motion = Dual::ZERO;
        for (part, &x) in orientation.iter().enumerate() {
            let mut unit = [0.0; 4];
            unit[part] = 2.0;
            let slope = (inverse * Quat::from_f64(unit)).to_array()[axis];
            motion += x.scale(slope);
        }
        motion
    })
}

/// Returns the values of a quaternion.
fn quaternion<L: Real<Scalar = f64>, const K: usize>(q: &[Dual<L, K>]) -> Quat<f64> {
    Quat::new(q[0].value, q[1].value, q[2].value, q[3].value)
}

/// Adds to the derivative in one slot.
pub(crate) fn add<L: Real<Scalar = f64>, const K: usize>(
    x: &mut Dual<L, K>,
    slot: usize,
    rate: f64,
) {
    x.set_derivative(slot, x.derivative(slot) + rate);
}
