//! The dofs that move two bodies relative to each other, and how.
//!
//! The dofs that move a body are its chain: a row of the tree. Of two chains the common part comes first in both; what
//! is left lies on different branches, and dofs are numbered depth first, so one rest comes wholly before the other.

use crate::model::Model;
use crate::stages::{Positions, Velocities};
use clench_math::{Motion, Real, Vec3};

/// Which of the two bodies a dof moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Both.
    Both,
    /// The first alone.
    First,
    /// The second alone.
    Second,
}

/// The dofs of two bodies, ascending, in three parts.
#[derive(Clone, Copy, Debug)]
pub struct Chains<'a> {
    parts: [(&'a [u32], Side); 3],
}

impl<'a> Chains<'a> {
    /// All dofs that move either body.
    #[inline(always)]
    pub fn new(model: &'a Model, [body1, body2]: [usize; 2]) -> Self {
        let chain = |body: usize| match model.bodies[body].last_dof {
            Some(dof) => model.tree.row(dof),
            None => &[],
        };
        let (first, second) = (chain(body1), chain(body2));
        let common = first.iter().zip(second).take_while(|(a, b)| a == b).count();
        let (shared, first) = first.split_at(common);
        let second = &second[common..];
        let mut parts = [
            (shared, Side::Both),
            (first, Side::First),
            (second, Side::Second),
        ];
        if let ([a, ..], [b, ..]) = (first, second)
            && b < a
        {
            parts.swap(1, 2);
        }
        Chains { parts }
    }

    /// Leaves out dofs that move both bodies: at one common point their motion has no difference.
    #[inline(always)]
    pub fn without_common(mut self) -> Self {
        self.parts[0].0 = &[];
        self
    }

    /// Replaces `dofs` by those of the chains.
    #[inline(always)]
    pub fn collect(&self, dofs: &mut Vec<u32>) {
        dofs.clear();
        for (part, _) in self.parts {
            dofs.extend_from_slice(part);
        }
    }

    /// Dofs by whom they move, ascending.
    #[inline(always)]
    pub fn parts(&self) -> [(&'a [u32], Side); 3] {
        self.parts
    }

    /// Each dof and whom it moves, ascending.
    #[inline(always)]
    pub fn iter(&self) -> impl Iterator<Item = (usize, Side)> {
        let parts = self.parts.into_iter();
        parts.flat_map(|(part, side)| part.iter().map(move |&dof| (dof as usize, side)))
    }
}

/// A point that moves with a body.
#[derive(Clone, Copy, Debug)]
pub struct BodyPoint<T> {
    /// The body.
    pub body: usize,
    /// From the reference point of the body's tree.
    pub offset: Vec3<T>,
}

impl<T: Real> BodyPoint<T> {
    /// The point of `body` that is at `point` (world coordinates) now.
    #[inline(always)]
    pub fn new(model: &Model, pos: &Positions<T>, body: usize, point: Vec3<T>) -> Self {
        let root = model.bodies[body].root;
        BodyPoint {
            body,
            offset: point - pos.subtree_com[root],
        }
    }

    /// Acceleration of the body and of the point while no dof accelerates (J̇ v): angular, then linear at the point.
    #[inline(always)]
    pub fn bias_acceleration(&self, model: &Model, vel: &Velocities<T>, qvel: &[T]) -> Motion<T> {
        let mut sum = Motion::ZERO;
        if let Some(last) = model.bodies[self.body].last_dof {
            for &dof in model.tree.row(last) {
                let dof = dof as usize;
                sum += vel.cdof_dot[dof] * qvel[dof];
            }
        }
        let velocity = vel.cvel[self.body];
        let turning = velocity.angular.cross(velocity.velocity_at(self.offset));
        Motion::new(sum.angular, sum.velocity_at(self.offset) + turning)
    }
}
