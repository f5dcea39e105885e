//! The slope h G of the gyroscopic forces of a free body that is its own tree, for the integrator `implicitfast`.
//!
//! G a′ is linear in the angular velocity, along the body's axes, and the same with a′ and this velocity exchanged. Its
//! force turns with the body, its moment is along the body's axes.

use super::step::Step;
use clench_dynamics::dynamics::ellipsoid::FluidForces;
use clench_dynamics::dynamics::gyroscopic::{gyroscopic_product, is_free_tree, solve_gyroscopic};
use clench_dynamics::model::Integrator;
use clench_math::{Vec3, array};
use std::ops::Range;

/// A free body that is its own tree.
pub(super) struct Gyroscopic<'a> {
    step: &'a Step<'a>,
    joint: usize,
    dof: usize,
}

impl<'a> Gyroscopic<'a> {
    /// Returns all such bodies of a step that evaluates their forces at its end.
    pub(super) fn of_all(step: &'a Step<'a>) -> Vec<Self> {
        let model = step.model;
        let joints = match model.integrator {
            Integrator::ImplicitFast => 0..model.joints.len(),
            Integrator::Euler | Integrator::Implicit | Integrator::Rk4 | Integrator::Discrete => {
                0..0
            }
        };
        let free = joints.filter(|&joint| is_free_tree(model, joint));
        let bodies = free.map(|joint| Gyroscopic {
            step,
            joint,
            dof: model.joints[joint].dof,
        });
        bodies.collect()
    }

    /// Returns the range of its rows in a matrix.
    pub(super) fn rows(&self, width: usize) -> Range<usize> {
        self.dof * width..(self.dof + 6) * width
    }

    /// Adds h G da + h dG a′ to the right side of the equation of a − a′.
    pub(super) fn add_rates(&self, columns: &[f64], right: &mut [f64], width: usize) {
        let (dof, nv) = (self.dof, self.step.model.nv);
        let (qvel, qacc) = (&self.step.before.qvel, &self.step.plain.integration.qacc);
        let mut unit = vec![0.0; nv];
        for k in 3..6 {
            unit[dof + k] = 1.0;
            let slopes = self.product(qvel, &unit);
            let by_velocity = self.product(&unit, qacc);
            unit[dof + k] = 0.0;
            let changes = &columns[(dof + k) * width..][..width];
            for r in 0..6 {
                let row = &mut right[(dof + r) * width..][..width];
                let changed = row.iter_mut().zip(changes);
                changed.for_each(|(x, &change)| *x += slopes[r] * change);
                row[nv + dof + k] += by_velocity[r];
            }
        }
        let force = Vec3::from_slice(&self.product(qvel, qacc));
        let axes = &self.step.plain.position.xmat[self.step.model.joints[self.joint].body];
        for k in 0..3 {
            let turned = axes.column(k).cross(force);
            for r in 0..3 {
                right[(dof + r) * width + dof + 3 + k] += turned[r];
            }
        }
    }

    /// Returns the solutions of its part of the equation, its rows of the matrix.
    pub(super) fn solve(&self, right: &[f64], width: usize) -> Vec<f64> {
        let Step {
            model,
            params,
            before,
            plain,
            ..
        } = self.step;
        let mut solved = right[self.rows(width)].to_vec();
        for column in 0..width {
            let side = array(|r| solved[r * width + column]);
            let stages = (&plain.position, &plain.velocity);
            let system = (&plain.integration.matrix, side);
            let fluid = FluidForces::All;
            let x = solve_gyroscopic(
                model,
                params,
                self.joint,
                &before.qvel,
                stages,
                fluid,
                system,
            );
            for (r, x) in x.into_iter().enumerate() {
                solved[r * width + column] = x;
            }
        }
        solved
    }

    /// Returns h G x at an angular velocity.
    fn product(&self, qvel: &[f64], x: &[f64]) -> [f64; 6] {
        let Step {
            model,
            params,
            plain,
            ..
        } = self.step;
        let stages = (&plain.position, &plain.velocity);
        gyroscopic_product(model, params, self.joint, qvel, stages, FluidForces::All, x)
    }
}
