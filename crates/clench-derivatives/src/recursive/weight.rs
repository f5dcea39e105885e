//! The derivatives of forces that are constant in the world and act at centres of mass: gravity compensation, and the
//! forces and torques that a user applies.
//!
//! A dof j of axis s moves the forces f, at the offsets o, and the torques t on all bodies below it, but does not turn
//! them. In a frame that moves with the dof they turn back. With F = Σ f, N = Σ f oᵀ and T = Σ t of the bodies below
//! the later of two dofs, the force along i changes by
//!
//! ```text
//! s_i · (N ω − ω tr N − ω × T, −ω × F)         ω = s.angular, if s_i turns with j
//! s_i · (s.linear × F + Nᵀ ω − ω tr N, 0)      otherwise
//! ```

use super::step::Step;
use clench_dynamics::dynamics::force_derivatives::ForceDerivatives;
use clench_dynamics::dynamics::inverse_derivatives::first_turning;
use clench_math::{Force, Mat3, Motion, Vec3};

/// Scratch memory of these derivatives.
#[derive(Clone, Debug, Default)]
pub(super) struct Weight {
    /// The sums of each body and all below it (nbody).
    loads: Vec<Load>,
}

/// Sums of forces and torques.
#[derive(Clone, Copy, Debug, Default)]
struct Load {
    force: Vec3<f64>,
    torque: Vec3<f64>,
    /// N.
    outer: Mat3<f64>,
}

impl Weight {
    /// Subtracts the derivatives of gravity compensation and of applied forces from the gradient.
    pub(super) fn subtract(&mut self, step: &Step<'_>, gradient: &mut ForceDerivatives<'_, f64>) {
        let (model, params) = (step.model, step.params);
        let lifted = params.body_gravcomp.iter().any(|&share| share > 0.0);
        if lifted && model.flags.gravity && (model.flags.spring || model.flags.damper) {
            let lift = |b: usize| {
                let share = params.body_mass[b] * params.body_gravcomp[b];
                (params.gravity * -share, Vec3::ZERO)
            };
            // Actuators may compensate gravity within the range of their joint.
            let actuated = model.flags.actuation && !model.actuators.is_empty();
            let passed = |dof: usize| {
                let joint = model.dofs[dof].joint;
                match (model.joints[joint].actgravcomp, actuated) {
                    (false, true | false) => 1.0,
                    (true, true) => step.passed_share(joint),
                    (true, false) => 0.0,
                }
            };
            self.run(step, lift, passed, gradient);
        }
        let applied = |b: usize| {
            let wrench = step.before.xfrc_applied[b];
            (wrench.linear, wrench.angular)
        };
        let acts = |b: usize| applied(b) != (Vec3::ZERO, Vec3::ZERO);
        if (1..model.nbody()).any(acts) {
            self.run(step, applied, |_| 1.0, gradient);
        }
    }

    /// Subtracts the derivatives of a force and a torque on each body. `passed` returns the share of the forces that
    /// acts along a dof.
    fn run(
        &mut self,
        step: &Step<'_>,
        wrench: impl Fn(usize) -> (Vec3<f64>, Vec3<f64>),
        passed: impl Fn(usize) -> f64,
        gradient: &mut ForceDerivatives<'_, f64>,
    ) {
        let (model, pos) = (step.model, &step.plain.position);
        self.loads.clear();
        self.loads.resize(model.nbody(), Load::default());
        for b in (1..model.nbody()).rev() {
            let offset = pos.xipos[b] - pos.subtree_com[model.bodies[b].root];
            let (force, torque) = wrench(b);
            self.loads[b].add(&Load {
                force,
                torque,
                outer: Mat3::from_rows(offset * force.x, offset * force.y, offset * force.z),
            });
            let load = self.loads[b];
            self.loads[model.bodies[b].parent].add(&load);
        }
        for (i, dof) in model.dofs.iter().enumerate() {
            let load = &self.loads[dof.body];
            let moved = load.moved(pos.cdof[i]);
            let turned_by_own = load.turned(pos.cdof[i]);
            let together = first_turning(model, i);
            for &j in model.tree.row(i) {
                let j = j as usize;
                let change = if j >= together { turned_by_own } else { moved };
                gradient.add(j, i, -passed(j) * pos.cdof[j].dot(change));
                if j != i {
                    let turned = load.turned(pos.cdof[j]);
                    gradient.add(i, j, -passed(i) * pos.cdof[i].dot(turned));
                }
            }
        }
    }
}

impl Load {
    fn add(&mut self, other: &Load) {
        self.force += other.force;
        self.torque += other.torque;
        for (row, &other) in self.outer.rows.iter_mut().zip(&other.outer.rows) {
            *row += other;
        }
    }

    /// Returns the change of the wrench as seen from a frame that moves with `axis`.
    fn turned(&self, axis: Motion<f64>) -> Force<f64> {
        let turn = axis.angular;
        let moment = self.outer * turn - turn * self.trace() - turn.cross(self.torque);
        Force::new(moment, -turn.cross(self.force))
    }

    /// Returns the change of the wrench about a fixed point with a motion along `axis`.
    fn moved(&self, axis: Motion<f64>) -> Force<f64> {
        let turn = axis.angular;
        let arm = self.outer.transpose_mul(turn) - turn * self.trace();
        Force::new(axis.linear.cross(self.force) + arm, Vec3::ZERO)
    }

    fn trace(&self) -> f64 {
        let [x, y, z] = self.outer.rows;
        x.x + y.y + z.z
    }
}
