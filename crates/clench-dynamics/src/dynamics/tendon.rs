//! Tendons: the length of each and its gradient J = ∂length/∂q, a sparse row over dofs.
//!
//! Springs, dampers, limits, dry friction, equalities and actuators of tendons use only these.

use crate::dynamics::tendon_path::spatial_tendon;
use crate::model::{Model, Params, Wrap};
use crate::stages::Positions;
use clench_math::{Real, kernel};

/// Returns the dofs that change a tendon's length, with ∂length/∂q along each.
#[inline(always)]
pub fn gradient<'a, T: Real>(
    model: &'a Model,
    pos: &'a Positions<T>,
    tendon: usize,
) -> impl Iterator<Item = (usize, T)> + Clone + 'a {
    model.tendon_dofs.row(&pos.ten_jacobian, tendon)
}

/// Computes `ten_length` and `ten_jacobian` at `qpos`, after the kinematics.
#[kernel]
pub fn tendons<T: Real>(model: &Model, params: &Params<T>, qpos: &[T], pos: &mut Positions<T>) {
    for (t, tendon) in model.tendons.iter().enumerate() {
        if tendon.is_spatial() {
            spatial_tendon(model, params, pos, t);
        } else {
            fixed_tendon(model, params, qpos, pos, t);
        }
    }
}

/// Computes a sum of joint positions, whose gradient is the coefficients.
#[inline(always)]
fn fixed_tendon<T: Real>(
    model: &Model,
    params: &Params<T>,
    qpos: &[T],
    pos: &mut Positions<T>,
    t: usize,
) {
    let tendon = &model.tendons[t];
    let dofs = model.tendon_dofs.dofs(t);
    let row = &mut pos.ten_jacobian[model.tendon_dofs.range(t)];
    let mut length = T::ZERO;
    for (wrap, &coef) in tendon
        .path
        .iter()
        .zip(&params.wrap_coef[tendon.coefs.clone()])
    {
        let &Wrap::Joint(j) = wrap else { continue };
        let joint = &model.joints[j];
        length += coef * qpos[joint.qpos];
        if let Ok(column) = dofs.binary_search(&(joint.dof as u32)) {
            row[column] = coef;
        }
    }
    pos.ten_length[t] = length;
}

/// Computes the rate of change of each tendon's length (ntendon).
#[kernel]
pub(crate) fn tendon_velocities<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    qvel: &[T],
    ten_velocity: &mut [T],
) {
    for (t, velocity) in ten_velocity.iter_mut().enumerate() {
        *velocity = T::ZERO;
        for (dof, arm) in gradient(model, pos, t) {
            *velocity += arm * qvel[dof];
        }
    }
}

/// Adds the dof forces of tendon `tendon` with the tension `force` to `qfrc`.
#[inline(always)]
pub(crate) fn add_tendon_force<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    tendon: usize,
    force: T,
    qfrc: &mut [T],
) {
    for (dof, arm) in gradient(model, pos, tendon) {
        qfrc[dof] += arm * force;
    }
}
