//! Scalar functions of positions that equalities, limits and dry friction of joints and tendons act on.

use super::context::ConstraintContext;
use crate::dynamics::tendon;
use clench_math::Real;

/// A joint coordinate or a tendon length, and its derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) enum Coordinate {
    /// A hinge or slide.
    Joint(usize),
    /// A tendon.
    Tendon(usize),
}

impl Coordinate {
    /// Returns its value.
    #[inline(always)]
    pub(super) fn value<T: Real>(self, context: &ConstraintContext<T>) -> T {
        match self {
            Coordinate::Joint(joint) => context.state.qpos[context.model.joints[joint].qpos],
            Coordinate::Tendon(tendon) => context.position.ten_length[tendon],
        }
    }

    /// Returns its value in the initial configuration.
    #[inline(always)]
    pub(super) fn initial<T: Real>(self, context: &ConstraintContext<T>) -> T {
        match self {
            Coordinate::Joint(joint) => context.params.qpos0[context.model.joints[joint].qpos],
            Coordinate::Tendon(tendon) => context.params.tendon_length0[tendon],
        }
    }

    /// Returns its inverse inertia in the initial configuration.
    #[inline(always)]
    pub(super) fn inverse_weight<T: Real>(self, context: &ConstraintContext<T>) -> T {
        match self {
            Coordinate::Joint(joint) => {
                context.params.dof_invweight0[context.model.joints[joint].dof]
            }
            Coordinate::Tendon(tendon) => context.params.tendon_invweight0[tendon],
        }
    }

    /// Inserts its dofs into `dofs`, which stays sorted without duplicates.
    #[inline(always)]
    pub(super) fn insert_dofs<T: Real>(self, context: &ConstraintContext<T>, dofs: &mut Vec<u32>) {
        self.each(context, |dof, _| {
            if let Err(place) = dofs.binary_search(&dof) {
                dofs.insert(place, dof);
            }
        });
    }

    /// Adds `scale` times its gradient to a Jacobian row over the dofs of [`insert_dofs`](Self::insert_dofs).
    #[inline(always)]
    pub(super) fn add_gradient<T: Real>(
        self,
        context: &ConstraintContext<T>,
        dofs: &[u32],
        scale: T,
        row: &mut [T],
    ) {
        self.each(context, |dof, derivative| {
            if let Ok(column) = dofs.binary_search(&dof) {
                row[column] += scale * derivative;
            }
        });
    }

    /// Calls `visit` with each of its dofs and the derivative by that dof.
    #[inline(always)]
    pub(super) fn each<T: Real>(
        self,
        context: &ConstraintContext<T>,
        mut visit: impl FnMut(u32, T),
    ) {
        match self {
            Coordinate::Joint(joint) => visit(context.model.joints[joint].dof as u32, T::ONE),
            Coordinate::Tendon(tendon) => {
                for (dof, arm) in tendon::gradient(context.model, context.position, tendon) {
                    visit(dof as u32, arm);
                }
            }
        }
    }
}
