//! Derivatives of the integration of positions: functions of the coordinates of each joint alone.

use crate::tangent;
use clench_dynamics::dynamics::integrate::integrate_positions;
use clench_dynamics::model::Model;
use clench_math::{Dual, Real};

/// A number with its derivatives by the dofs of a joint.
type Number = Dual<f64, 8>;

/// The derivatives of the motion of a dof by the k-th positions and new velocities of its joint.
#[derive(Clone, Copy, Debug, Default)]
struct Motion {
    by_position: [f64; 6],
    by_velocity: [f64; 6],
}

/// The derivatives of the motion of each dof.
#[derive(Debug, Default)]
pub(super) struct Advance {
    /// nv.
    motion: Vec<Motion>,
    qpos: Vec<Number>,
    qvel: Vec<Number>,
    /// Scratch: a row of the result.
    row: Vec<f64>,
}

impl Advance {
    /// Differentiates the positions after a time `h` by those before it, and by the velocities `qvel`.
    pub(super) fn run(&mut self, model: &Model, qpos: &[f64], qvel: &[f64], h: f64) {
        let mut straight = Motion::default();
        (straight.by_position[0], straight.by_velocity[0]) = (1.0, h);
        self.motion.clear();
        self.motion.resize(model.nv, straight);
        // Only rotations are not linear.
        if model.joints.iter().all(|joint| joint.kind.nv() == 1) {
            return;
        }
        for by_velocity in [false, true] {
            let numbers = |values: &[f64]| Vec::from_iter(values.iter().map(|&x| Number::new(x)));
            self.qpos = numbers(qpos);
            self.qvel = numbers(qvel);
            for joint in &model.joints {
                for k in 0..joint.kind.nv() {
                    match by_velocity {
                        true => self.qvel[joint.dof + k].set_derivative(k, 1.0),
                        false => {
                            let dof = joint.dof + k;
                            tangent::move_along(model, dof, (k, 1.0), &mut self.qpos);
                        }
                    }
                }
            }
            integrate_positions(model, &mut self.qpos, &self.qvel, Number::new(h));
            let mut motion = self.motion.iter_mut();
            tangent::each_motion(model, &self.qpos, |rates| {
                let Some(motion) = motion.next() else { return };
                let to = match by_velocity {
                    true => &mut motion.by_velocity,
                    false => &mut motion.by_position,
                };
                to.copy_from_slice(&rates[..6]);
            });
        }
    }

    /// Passes the derivatives of the new positions to `write`, dof after dof, from those of the new velocities.
    pub(super) fn write_positions<'a>(
        &mut self,
        model: &Model,
        velocities: impl Iterator<Item = &'a [f64]> + Clone,
        write: &mut dyn FnMut(&[f64]),
    ) {
        for joint in &model.joints {
            let dofs = joint.dof..joint.dof + joint.kind.nv();
            let velocities = velocities.clone().skip(joint.dof).take(dofs.len());
            for motion in &self.motion[dofs] {
                self.row.clear();
                for (velocity, slope) in velocities.clone().zip(motion.by_velocity) {
                    self.row.resize(velocity.len(), 0.0);
                    if slope != 0.0 {
                        let row = self.row.iter_mut().zip(velocity);
                        row.for_each(|(x, &velocity)| *x += slope * velocity);
                    }
                }
                let row = self.row[joint.dof..].iter_mut();
                let own = row.zip(&motion.by_position[..joint.kind.nv()]);
                own.for_each(|(x, &by_position)| *x += by_position);
                write(&self.row);
            }
        }
    }
}
