//! The factorization of the mass matrix by articulated bodies (Featherstone 2008, §7.3), for long chains in single
//! precision.
//!
//! Let IA_i be the inertia at dof i if the joints below it are free, s_i its axis, and M = LᵀDL as elsewhere.
//! Eliminating the dofs below i from M leaves s_jᵀ IA_i s_i in row i, hence
//!
//! ```text
//! u_i = IA_i s_i        D_i = s_i · u_i + armature        D_i L_ij = s_j · u_i    for the ancestors j
//! IA of what carries dof i:  IA_i − u_i u_iᵀ / D_i
//! ```
//!
//! Computed from M, the pivot D_i of a link near the root of a chain is a small difference of large numbers: in a chain
//! of 50 links it is 10⁻⁶ of the original entry, beyond single precision. IA has the magnitude of the pivot if it is
//! taken about a nearby point, here each body's centre of mass. Thus D and L have errors of a few roundings for any
//! length of chain. In double precision, M is accurate enough.

use crate::dynamics::reflected::{dof_armature, tendon_armature};
use crate::model::{JointKind, Model, Params};
use crate::stages::Positions;
use clench_math::{Inertia, Mask, Mat3, Real, Scalar, Vec3, kernel};
use clench_solver::TreeFactor;

/// The inertia of an articulated body about a point: moment = rotational ω + coupling v, force = couplingᵀ ω + mass v.
#[derive(Clone, Copy, Debug, Default)]
pub struct ArticulatedInertia<T> {
    rotational: Mat3<T>,
    coupling: Mat3<T>,
    mass: Mat3<T>,
}

impl<T: Real> ArticulatedInertia<T> {
    /// The inertia of no body.
    pub const ZERO: Self = ArticulatedInertia {
        rotational: Mat3::ZERO,
        coupling: Mat3::ZERO,
        mass: Mat3::ZERO,
    };

    /// Creates a rigid body about its centre of mass.
    #[inline(always)]
    fn rigid(diagonal: Vec3<T>, axes: &Mat3<T>, mass: T) -> Self {
        let [xx, yy, zz, xy, xz, yz] =
            Inertia::from_principal(diagonal, axes, Vec3::ZERO, mass).rotational;
        ArticulatedInertia {
            rotational: Mat3::from_rows(
                Vec3::new(xx, xy, xz),
                Vec3::new(xy, yy, yz),
                Vec3::new(xz, yz, zz),
            ),
            coupling: Mat3::ZERO,
            mass: Mat3::diagonal(Vec3::new(mass, mass, mass)),
        }
    }

    /// Returns the moment and force that accelerate it by (`angular`, `linear`).
    #[inline(always)]
    fn mul(&self, angular: Vec3<T>, linear: Vec3<T>) -> (Vec3<T>, Vec3<T>) {
        (
            self.rotational * angular + self.coupling * linear,
            self.coupling.transpose_mul(angular) + self.mass * linear,
        )
    }

    /// Subtracts u uᵀ / pivot.
    #[inline(always)]
    fn release(&mut self, (moment, force): (Vec3<T>, Vec3<T>), inverse_pivot: T) {
        for i in 0..3 {
            self.rotational.rows[i] -= moment * (moment[i] * inverse_pivot);
            self.coupling.rows[i] -= force * (moment[i] * inverse_pivot);
            self.mass.rows[i] -= force * (force[i] * inverse_pivot);
        }
    }

    /// Adds `other`, whose reference point is at `offset` from this one's.
    ///
    /// With r× the matrix of the cross product by the offset: coupling' = coupling + r× mass and
    /// rotational' = rotational − coupling r× + r× coupling'ᵀ.
    #[inline(always)]
    fn add_shifted(&mut self, other: &Self, offset: Vec3<T>) {
        let lever = crossed(offset, &other.mass);
        // −coupling r× is the transpose of r× couplingᵀ.
        let turned = crossed(offset, &other.coupling.transpose()).transpose();
        for i in 0..3 {
            self.mass.rows[i] += other.mass.rows[i];
            self.coupling.rows[i] += other.coupling.rows[i] + lever.rows[i];
        }
        let whole = Mat3::from_rows(
            other.coupling.rows[0] + lever.rows[0],
            other.coupling.rows[1] + lever.rows[1],
            other.coupling.rows[2] + lever.rows[2],
        );
        let carried = crossed(offset, &whole.transpose());
        for i in 0..3 {
            self.rotational.rows[i] += other.rotational.rows[i] + turned.rows[i] + carried.rows[i];
        }
    }
}

/// Returns the cross products of a vector with the columns of a matrix.
#[inline(always)]
fn crossed<T: Real>(vector: Vec3<T>, m: &Mat3<T>) -> Mat3<T> {
    Mat3::from_columns(
        vector.cross(m.column(0)),
        vector.cross(m.column(1)),
        vector.cross(m.column(2)),
    )
}

/// The maximum number of dofs on a path from a root for which the factor is computed from M in single precision: the
/// relative rounding error of the smallest pivots grows with the cube of this number, at 20 to about one hundredth.
const MAX_DOFS: usize = 20;

/// Allocates memory for `articulated_factor`; empty if the precision of `T` and the model do not require it. Models
/// with tendon armature, which is no body inertia, factor M itself.
pub fn articulated_bodies<T: Real>(model: &Model) -> Vec<ArticulatedInertia<T>> {
    let longest = (0..model.nv).map(|i| model.tree.row(i).len()).max();
    let heavy = |t| tendon_armature(model, &model.params, t) > 0.0;
    let heavy_tendons = (0..model.tendons.len()).any(heavy);
    if T::Scalar::IS_SINGLE && longest.is_some_and(|n| n > MAX_DOFS) && !heavy_tendons {
        vec![ArticulatedInertia::ZERO; model.nbody()]
    } else {
        Vec::new()
    }
}

/// Factors M + diag(`added`) into `factor`. Returns false in lanes with a pivot that is not positive.
///
/// `bodies` is scratch memory for all bodies.
#[kernel]
pub(crate) fn articulated_factor<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    added: impl Fn(usize) -> T,
    bodies: &mut [ArticulatedInertia<T>],
    factor: &mut TreeFactor<T>,
) -> T::Mask {
    for (b, body) in bodies.iter_mut().enumerate() {
        let (inertia, mass) = (params.body_inertia[b], params.body_mass[b]);
        *body = ArticulatedInertia::rigid(inertia, &pos.ximat[b], mass);
    }
    let mut positive = T::Mask::splat(true);
    for b in (1..model.nbody()).rev() {
        let centre = pos.xipos[b];
        for i in model.bodies[b].dofs.clone().rev() {
            let (angular, linear) = axis(model, pos, i, centre);
            let (moment, force) = bodies[b].mul(angular, linear);
            let own = dof_armature(model, params, i) + added(i);
            let pivot = angular.dot(moment) + linear.dot(force) + own;
            positive &= factor.set_row(&model.tree, i, pivot, |j| {
                let (angular, linear) = axis(model, pos, j, centre);
                angular.dot(moment) + linear.dot(force)
            });
            bodies[b].release((moment, force), T::ONE / pivot);
        }
        let parent = model.bodies[b].parent;
        if parent != 0 {
            let own = bodies[b];
            bodies[parent].add_shifted(&own, centre - pos.xipos[parent]);
        }
    }
    positive
}

/// Returns the angular and linear velocity at `point` if dof `i` moves at unit velocity, computed from the joint's
/// anchor, to avoid cancellation near it.
#[inline(always)]
fn axis<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    i: usize,
    point: Vec3<T>,
) -> (Vec3<T>, Vec3<T>) {
    let number = model.dofs[i].joint;
    let joint = &model.joints[number];
    let translates = match joint.kind {
        JointKind::Slide => true,
        JointKind::Free => i - joint.dof < 3,
        JointKind::Hinge | JointKind::Ball => false,
    };
    let motion = pos.cdof[i];
    if translates {
        (Vec3::ZERO, motion.linear)
    } else {
        let arm = point - pos.xanchor[number];
        (motion.angular, motion.angular.cross(arm))
    }
}
