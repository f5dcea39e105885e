//! Centres of mass, and inertias and dof axes as spatial vectors about them.

use crate::model::{JointKind, Model, Params};
use crate::part::Part;
use crate::stages::Positions;
use clench_math::{Inertia, Motion, Real, Vec3, kernel};

/// Below this mass (kg) a subtree's centre of mass is that of its top body (MuJoCo's `mjMINVAL`).
const MASSLESS: f64 = 1e-15;

/// Computes `subtree_com`, `cinert` and `cdof` of the bodies of some parts, from the poses.
#[kernel]
pub fn com_positions<T: Real>(
    model: &Model,
    params: &Params<T>,
    parts: &[Part],
    pos: &mut Positions<T>,
) {
    subtree_com(model, params, parts, pos);
    pos.cinert[0] = Inertia::ZERO;
    for part in parts {
        for b in part.bodies.start.max(1)..part.bodies.end {
            let offset = pos.xipos[b] - pos.subtree_com[model.bodies[b].root];
            pos.cinert[b] = Inertia::from_principal(
                params.body_inertia[b],
                &pos.ximat[b],
                offset,
                params.body_mass[b],
            );
        }
        dof_axes(model, part, pos);
    }
}

/// Sums moments from the last body to the first. Bodies outside the parts form whole trees on the world, whose moments
/// are still valid.
#[inline(always)]
fn subtree_com<T: Real>(model: &Model, params: &Params<T>, parts: &[Part], pos: &mut Positions<T>) {
    for part in parts {
        for b in part.bodies.clone() {
            pos.subtree_moment[b] = pos.xipos[b] * params.body_mass[b];
        }
        for b in part.bodies.clone().rev() {
            let parent = model.bodies[b].parent;
            if parent != 0 {
                let moment = pos.subtree_moment[b];
                pos.subtree_moment[parent] += moment;
            }
        }
    }
    for (b, body) in model.bodies.iter().enumerate().skip(1).rev() {
        if body.parent == 0 {
            let moment = pos.subtree_moment[b];
            pos.subtree_moment[0] += moment;
        }
    }
    for b in parts.iter().flat_map(|part| part.bodies.clone()) {
        let mass = params.body_subtreemass[b];
        let massless = mass.lt(T::new(MASSLESS));
        let inverse = T::ONE / T::select(massless, T::ONE, mass);
        let com = pos.subtree_moment[b] * inverse;
        pos.subtree_com[b] = Vec3::select(massless, pos.xipos[b], com);
    }
}

/// Computes the spatial motion of each dof at unit velocity: for a rotation about an axis through an anchor, the linear
/// part at the centre of mass is axis × (com − anchor). Ball and free joints rotate about the axes of the moved body; a
/// free joint translates along the world's axes.
#[inline(always)]
fn dof_axes<T: Real>(model: &Model, part: &Part, pos: &mut Positions<T>) {
    for j in part.joints.clone() {
        let joint = &model.joints[j];
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
