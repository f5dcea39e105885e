//! A scalar function of joint positions, which equalities, limits and dry friction of joints and tendons act on.

use super::Scene;
use crate::dynamics::tendon;
use clench_math::Real;

/// A joint coordinate or a tendon length, and its constant derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) enum Coordinate {
    /// A hinge or slide.
    Joint(usize),
    /// A fixed tendon.
    Tendon(usize),
}

impl Coordinate {
    /// Its value.
    #[inline(always)]
    pub fn value<T: Real>(self, scene: &Scene<T>) -> T {
        match self {
            Coordinate::Joint(joint) => scene.state.qpos[scene.model.joints[joint].qpos],
            Coordinate::Tendon(tendon) => scene.position.ten_length[tendon],
        }
    }

    /// Its value in the initial configuration.
    #[inline(always)]
    pub fn initial<T: Real>(self, scene: &Scene<T>) -> T {
        match self {
            Coordinate::Joint(joint) => scene.params.qpos0[scene.model.joints[joint].qpos],
            Coordinate::Tendon(tendon) => scene.params.tendon_length0[tendon],
        }
    }

    /// The inverse inertia that it sees in the initial configuration.
    #[inline(always)]
    pub fn inverse_weight<T: Real>(self, scene: &Scene<T>) -> T {
        match self {
            Coordinate::Joint(joint) => scene.params.dof_invweight0[scene.model.joints[joint].dof],
            Coordinate::Tendon(tendon) => scene.params.tendon_invweight0[tendon],
        }
    }

    /// Adds its dofs to `dofs`, keeping them ascending and each once.
    #[inline(always)]
    pub fn insert_dofs<T: Real>(self, scene: &Scene<T>, dofs: &mut Vec<u32>) {
        self.each(scene, |dof, _| {
            if let Err(place) = dofs.binary_search(&dof) {
                dofs.insert(place, dof);
            }
        });
    }

    /// Adds `scale` times its gradient to a Jacobian row over the dofs that [`insert_dofs`](Self::insert_dofs) left.
    #[inline(always)]
    pub fn add_gradient<T: Real>(self, scene: &Scene<T>, dofs: &[u32], scale: T, row: &mut [T]) {
        self.each(scene, |dof, coefficient| {
            if let Ok(column) = dofs.binary_search(&dof) {
                row[column] += scale * coefficient;
            }
        });
    }

    #[inline(always)]
    fn each<T: Real>(self, scene: &Scene<T>, mut visit: impl FnMut(u32, T)) {
        match self {
            Coordinate::Joint(joint) => visit(scene.model.joints[joint].dof as u32, T::ONE),
            Coordinate::Tendon(tendon) => {
                for (dof, coefficient) in tendon::terms(scene.model, scene.params, tendon) {
                    visit(dof as u32, coefficient);
                }
            }
        }
    }
}
