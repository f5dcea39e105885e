//! Fixed tendons: a weighted sum of joint positions. The weights are the tendon's Jacobian.

use crate::model::{Model, Params};
use crate::workspace::Positions;
use clench_math::{Real, kernel};

/// The dofs of a fixed tendon with their weights.
#[inline(always)]
pub fn terms<'a, T: Real>(
    model: &'a Model,
    params: &'a Params<T>,
    tendon: usize,
) -> impl Iterator<Item = (usize, T)> + Clone + 'a {
    let tendon = &model.tendons[tendon];
    let coefs = &params.wrap_coef[tendon.coefs.clone()];
    let dofs = tendon.joints.iter().map(|&j| model.joints[j].dof);
    dofs.zip(coefs.iter().copied())
}

/// `ten_length` at `qpos`.
#[kernel]
pub fn tendon_lengths<T: Real>(
    model: &Model,
    params: &Params<T>,
    qpos: &[T],
    pos: &mut Positions<T>,
) {
    for (tendon, length) in model.tendons.iter().zip(&mut pos.ten_length) {
        let coefs = &params.wrap_coef[tendon.coefs.clone()];
        *length = T::ZERO;
        for (&j, &coef) in tendon.joints.iter().zip(coefs) {
            *length += coef * qpos[model.joints[j].qpos];
        }
    }
}

/// Rate of change of each tendon's length (ntendon).
#[kernel]
pub fn tendon_velocities<T: Real>(
    model: &Model,
    params: &Params<T>,
    qvel: &[T],
    ten_velocity: &mut [T],
) {
    for (t, velocity) in ten_velocity.iter_mut().enumerate() {
        *velocity = T::ZERO;
        for (dof, coef) in terms(model, params, t) {
            *velocity += coef * qvel[dof];
        }
    }
}

/// Adds the joint forces of tendon `tendon` pulling with `force` to `qfrc`.
#[inline(always)]
pub fn add_tendon_force<T: Real>(
    model: &Model,
    params: &Params<T>,
    tendon: usize,
    force: T,
    qfrc: &mut [T],
) {
    for (dof, coef) in terms(model, params, tendon) {
        qfrc[dof] += coef * force;
    }
}
