//! Gyroscopic forces of a free body without jointed children, integrated implicitly.
//!
//! Explicit integration of these forces adds energy to a spinning body. With w the angular velocity, s the centre of
//! mass relative to the joint and I the inertia about it (including welded bodies), the bias force and its change with
//! a change δw are
//! ```text
//! f = m w×(w×s)                      t = w×Iw
//! δf = m (δw×(w×s) + w×(δw×s))       δt = δw×Iw + w×Iδw
//! ```
//!
//! The force acts along the joint's translations, the moment t + s×f about its rotations. (M − h D + h ∂bias/∂v) a = τ
//! is then a separate 6 × 6 system. It need not be symmetric, so it includes the fluid's non-symmetric part of D.

use crate::dynamics::ellipsoid::{FluidForces, ellipsoid_rates};
use crate::dynamics::fluid::{fluid_acts, symmetric_and_skew};
use crate::model::{JointKind, Model, Params};
use crate::stages::{Positions, Velocities};
use clench_math::{Force, Real, Vec3, kernel};
use clench_solver::TreeMatrix;

/// Returns true if `j` is the free joint of a body that, with welded bodies, forms a tree.
#[inline(always)]
pub fn is_free_tree(model: &Model, j: usize) -> bool {
    let joint = &model.joints[j];
    let (tree, after) = (&model.tree, joint.dof + 6);
    joint.kind == JointKind::Free
        && (after >= model.nv || tree.tree_of(after) != tree.tree_of(joint.dof))
}

/// Computes the joint's part of the acceleration (nv) due to `force` along its dofs, with M − h D in `matrix`. `fluid`
/// selects whether the fluid's non-symmetric part of D is included.
#[kernel]
pub fn solve_gyroscopic<T: Real>(
    model: &Model,
    params: &Params<T>,
    j: usize,
    qvel: &[T],
    (pos, vel): (&Positions<T>, &Velocities<T>),
    fluid: FluidForces,
    (matrix, force): (&TreeMatrix<T>, [T; 6]),
) -> [T; 6] {
    let dof = model.joints[j].dof;
    let mut rows = [[T::ZERO; 7]; 6];
    for (r, row) in rows.iter_mut().enumerate() {
        for (c, entry) in row[..6].iter_mut().enumerate() {
            *entry = matrix.row(&model.tree, dof + r.max(c))[r.min(c)];
        }
        row[6] = force[r];
    }
    add_bias_derivative(model, params, j, qvel, pos, &mut rows);
    if fluid == FluidForces::All {
        subtract_skew_drag(model, params, j, (pos, vel), &mut rows);
    }
    solve6(rows)
}

/// Computes the joint's part of h ∂bias/∂v, minus the non-symmetric part of h D if selected, times `x` (nv).
#[inline(always)]
pub fn gyroscopic_product<T: Real>(
    model: &Model,
    params: &Params<T>,
    j: usize,
    qvel: &[T],
    (pos, vel): (&Positions<T>, &Velocities<T>),
    fluid: FluidForces,
    x: &[T],
) -> [T; 6] {
    let dof = model.joints[j].dof;
    let mut rows = [[T::ZERO; 7]; 6];
    add_bias_derivative(model, params, j, qvel, pos, &mut rows);
    if fluid == FluidForces::All {
        subtract_skew_drag(model, params, j, (pos, vel), &mut rows);
    }
    let mut product = [T::ZERO; 6];
    for (row, sum) in rows.iter().zip(&mut product) {
        for (&entry, &x) in row[..6].iter().zip(&x[dof..]) {
            *sum += entry * x;
        }
    }
    product
}

/// Adds h ∂bias/∂v.
#[inline(always)]
fn add_bias_derivative<T: Real>(
    model: &Model,
    params: &Params<T>,
    j: usize,
    qvel: &[T],
    pos: &Positions<T>,
    rows: &mut [[T; 7]; 6],
) {
    let joint = &model.joints[j];
    let b = joint.body;
    let (h, axes) = (params.timestep, &pos.xmat[b]);
    let inertia = &pos.crb[b];
    let s = pos.subtree_com[b] - pos.xpos[b];
    let w = *axes * Vec3::from_slice(&qvel[joint.dof + 3..]);
    for k in 0..3 {
        let dw = axes.column(k);
        let df = (dw.cross(w.cross(s)) + w.cross(dw.cross(s))) * inertia.mass;
        let dt = dw.cross(inertia.rotate(w)) + w.cross(inertia.rotate(dw));
        let moment = axes.transpose_mul(dt + s.cross(df));
        for r in 0..3 {
            rows[r][3 + k] += h * df[r];
            rows[3 + r][3 + k] += h * moment[r];
        }
    }
}

/// Subtracts h times the skew part of D, which stems from ellipsoids in a fluid.
#[inline(always)]
fn subtract_skew_drag<T: Real>(
    model: &Model,
    params: &Params<T>,
    j: usize,
    (pos, vel): (&Positions<T>, &Velocities<T>),
    rows: &mut [[T; 7]; 6],
) {
    if !fluid_acts(model, params) {
        return;
    }
    let joint = &model.joints[j];
    let axes = &pos.cdof[joint.dof..joint.dof + 6];
    let welded = |b: &usize| model.bodies[*b].weld == joint.body;
    for b in (joint.body..model.nbody()).filter(welded) {
        if !model.bodies[b].fluid_ellipsoids {
            continue;
        }
        let rates = ellipsoid_rates(model, params, (pos, vel), b, FluidForces::All);
        let [_, skew] = symmetric_and_skew(rates);
        for (c, axis) in axes.iter().enumerate() {
            let mut change = Force::ZERO;
            for (x, column) in axis.to_array().into_iter().zip(skew) {
                change += column * x;
            }
            for (row, other) in rows.iter_mut().zip(axes) {
                row[c] -= params.timestep * other.dot(change);
            }
        }
    }
}

/// Solves six equations, each with its right side as the seventh number, by elimination with row pivoting per lane.
#[inline(always)]
fn solve6<T: Real>(mut rows: [[T; 7]; 6]) -> [T; 6] {
    for k in 0..6 {
        let (above, below) = rows.split_at_mut(k + 1);
        let pivot = &mut above[k];
        for row in below.iter_mut() {
            let larger = row[k].abs().gt(pivot[k].abs());
            for (p, r) in pivot.iter_mut().zip(row) {
                (*p, *r) = (T::select(larger, *r, *p), T::select(larger, *p, *r));
            }
        }
        for row in below {
            let factor = row[k] / pivot[k];
            for (r, &p) in row.iter_mut().zip(&*pivot) {
                *r -= factor * p;
            }
        }
    }
    let mut x = [T::ZERO; 6];
    for (k, row) in rows.iter().enumerate().rev() {
        let known = row[k + 1..6].iter().zip(&x[k + 1..]);
        let rest = known.fold(row[6], |rest, (&a, &x)| rest - a * x);
        x[k] = rest / row[k];
    }
    x
}
