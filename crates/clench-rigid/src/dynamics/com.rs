//! Centres of mass, and inertias and dof axes as spatial vectors about them.

use crate::model::{JointKind, Model, Params};
use crate::workspace::Positions;
use clench_math::{Inertia, Motion, Real, Vec3, kernel};

/// Below this mass (kg) a subtree's centre of mass is that of its top body (MuJoCo's `mjMINVAL`).
const MASSLESS: f64 = 1e-15;

/// `subtree_com`, `cinert` and `cdof` from the poses.
#[kernel]
pub fn com_positions<T: Real>(model: &Model, params: &Params<T>, pos: &mut Positions<T>) {
    subtree_com(model, params, pos);
    pos.cinert[0] = Inertia::ZERO;
    for b in 1..model.nbody() {
        let offset = pos.xipos[b] - pos.subtree_com[model.bodies[b].root];
        pos.cinert[b] = Inertia::from_principal(
            params.body_inertia[b],
            &pos.ximat[b],
            offset,
            params.body_mass[b],
        );
    }
    dof_axes(model, pos);
}

#[inline(always)]
fn subtree_com<T: Real>(model: &Model, params: &Params<T>, pos: &mut Positions<T>) {
    for ((com, &xipos), &mass) in (pos.subtree_com.iter_mut())
        .zip(&pos.xipos)
        .zip(&params.body_mass)
    {
        *com = xipos * mass;
    }
    for b in (1..model.nbody()).rev() {
        let moment = pos.subtree_com[b];
        pos.subtree_com[model.bodies[b].parent] += moment;
    }
    for ((com, &xipos), &mass) in (pos.subtree_com.iter_mut())
        .zip(&pos.xipos)
        .zip(&params.body_subtreemass)
    {
        let massless = mass.lt(T::new(MASSLESS));
        let inverse = T::ONE / T::select(massless, T::ONE, mass);
        *com = Vec3::select(massless, xipos, *com * inverse);
    }
}

/// The spatial motion of each dof at unit velocity: for a rotation about an axis through an anchor, the linear part at
/// the centre of mass is axis × (com − anchor). Ball and free joints rotate about the body's own axes as they end up; a
/// free joint translates along the world's.
#[inline(always)]
fn dof_axes<T: Real>(model: &Model, pos: &mut Positions<T>) {
    for (j, joint) in model.joints.iter().enumerate() {
        let offset = pos.subtree_com[model.bodies[joint.body].root] - pos.xanchor[j];
        let rotation = |axis: Vec3<T>| Motion::new(axis, axis.cross(offset));
        let mut dof = joint.dof;
        match joint.kind {
            JointKind::Slide => pos.cdof[dof] = Motion::new(Vec3::ZERO, pos.xaxis[j]),
            JointKind::Hinge => pos.cdof[dof] = rotation(pos.xaxis[j]),
            JointKind::Ball | JointKind::Free => {
                if joint.kind == JointKind::Free {
                    for k in 0..3 {
                        let mut axis = Vec3::ZERO;
                        axis[k] = T::ONE;
                        pos.cdof[dof + k] = Motion::new(Vec3::ZERO, axis);
                    }
                    dof += 3;
                }
                for k in 0..3 {
                    pos.cdof[dof + k] = rotation(pos.xmat[joint.body].column(k));
                }
            }
        }
    }
}
