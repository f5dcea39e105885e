//! The dofs that move two bodies relative to each other.
//!
//! The chain of a body is the set of dofs that move it: a row of the tree. Two chains begin with their common part; the
//! remainders lie on different branches, and dofs are numbered depth first, so one wholly precedes the other.

use crate::model::Model;
use crate::stages::{Positions, Velocities};
use clench_math::{Motion, Real, Vec3};

/// The body of a pair that a dof moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Both.
    Both,
    /// Only the first.
    First,
    /// Only the second.
    Second,
}

/// The dofs of two bodies, ascending, in three parts.
#[derive(Clone, Copy, Debug)]
pub struct Chains<'a> {
    parts: [(&'a [u32], Side); 3],
}

impl<'a> Chains<'a> {
    /// Returns all dofs that move either body.
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

    /// Omits dofs that move both bodies: they cause no relative motion at a common point.
    #[inline(always)]
    pub fn without_common(mut self) -> Self {
        self.parts[0].0 = &[];
        self
    }

    /// Replaces `dofs` with those of the chains.
    #[inline(always)]
    pub fn collect(&self, dofs: &mut Vec<u32>) {
        dofs.clear();
        for (part, _) in self.parts {
            dofs.extend_from_slice(part);
        }
    }

    /// Returns the dofs by the side that they move, ascending.
    #[inline(always)]
    pub fn parts(&self) -> [(&'a [u32], Side); 3] {
        self.parts
    }

    /// Returns each dof with its side, ascending.
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
    /// The offset from the reference point of the body's tree.
    pub offset: Vec3<T>,
}

impl<T: Real> BodyPoint<T> {
    /// Returns the point of `body` that is currently at `point` (world coordinates).
    #[inline(always)]
    pub fn new(model: &Model, pos: &Positions<T>, body: usize, point: Vec3<T>) -> Self {
        let root = model.bodies[body].root;
        BodyPoint {
            body,
            offset: point - pos.subtree_com[root],
        }
    }

    /// Returns the acceleration of the body and the point at zero dof acceleration (J̇ v): angular, then linear at the
    /// point.
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
