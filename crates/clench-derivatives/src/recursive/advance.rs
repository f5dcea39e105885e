//! Derivatives of the integration of positions: functions of the coordinates of each joint alone.

use crate::tangent;
use clench_dynamics::model::{Joint, JointKind, Model};
use clench_math::{Dual, Quat, Real, Vec3};
use std::ops::Range;

/// A number with its derivatives by a rotation and by an angular velocity.
type Number = Dual<f64, 6>;

/// The derivatives of the rotation of a joint about each axis of the child by the rotation before and by the angular
/// velocity.
#[derive(Clone, Copy, Debug)]
struct Turn {
    by_position: [[f64; 3]; 3],
    by_velocity: [[f64; 3]; 3],
}

/// The derivatives of the new positions.
#[derive(Debug, Default)]
pub(super) struct Advance {
    /// The time between the positions, s.
    time: f64,
    /// Those of ball and free joints, in order. All other motion is straight.
    turns: Vec<Turn>,
    /// Scratch: a row of the result.
    row: Vec<f64>,
}

impl Advance {
    /// Differentiates the positions after a time, s, by those before it, and by the velocities `qvel`.
    pub(super) fn run(&mut self, model: &Model, qpos: &[f64], qvel: &[f64], time: f64) {
        self.time = time;
        self.turns.clear();
        for joint in &model.joints {
            let rotation = rotation(joint);
            if !rotation.is_empty() {
                let q = joint.qpos + joint.kind.nv() - 3;
                let turn = Turn::new(&qpos[q..q + 4], &qvel[rotation], time);
                self.turns.push(turn);
            }
        }
    }

    /// Passes the derivatives of the new positions to `write`, dof after dof, from those of the velocities.
    pub(super) fn write_positions<'a>(
        &mut self,
        model: &Model,
        velocities: impl Iterator<Item = &'a [f64]> + Clone,
        write: &mut dyn FnMut(&[f64]),
    ) {
        let mut turns = self.turns.iter();
        for joint in &model.joints {
            let rotation = rotation(joint);
            let mut rows = velocities.clone().skip(joint.dof);
            for dof in joint.dof..rotation.start {
                let Some(velocity) = rows.next() else { return };
                self.row.clear();
                self.row.extend(velocity.iter().map(|x| self.time * x));
                self.row[dof] += 1.0;
                write(&self.row);
            }
            if rotation.is_empty() {
                continue;
            }
            let (Some(turn), Some(x), Some(y), Some(z)) =
                (turns.next(), rows.next(), rows.next(), rows.next())
            else {
                return;
            };
            for (by_position, [a, b, c]) in turn.by_position.iter().zip(turn.by_velocity) {
                self.row.clear();
                let columns = x.iter().zip(y).zip(z);
                self.row
                    .extend(columns.map(|((x, y), z)| a * x + b * y + c * z));
                for (sum, by_position) in self.row[rotation.clone()].iter_mut().zip(by_position) {
                    *sum += by_position;
                }
                write(&self.row);
            }
        }
    }

    /// Adds to gradients by the velocities and by the positions before what follows from that by the new positions.
    pub(super) fn pull_back(
        &self,
        model: &Model,
        by_position: &[f64],
        velocities: &mut [f64],
        positions: &mut [f64],
    ) {
        let mut turns = self.turns.iter();
        for joint in &model.joints {
            let rotation = rotation(joint);
            for dof in joint.dof..rotation.start {
                velocities[dof] += self.time * by_position[dof];
                positions[dof] += by_position[dof];
            }
            if rotation.is_empty() {
                continue;
            }
            let Some(turn) = turns.next() else { return };
            for (axis, &by) in by_position[rotation.clone()].iter().enumerate() {
                for k in 0..3 {
                    velocities[rotation.start + k] += by * turn.by_velocity[axis][k];
                    positions[rotation.start + k] += by * turn.by_position[axis][k];
                }
            }
        }
    }
}

impl Turn {
    fn new(orientation: &[f64], omega: &[f64], time: f64) -> Self {
        let mut q = [Number::ZERO; 4];
        for (number, &x) in q.iter_mut().zip(orientation) {
            *number = Number::new(x);
        }
        let mut rate = [Number::ZERO; 3];
        for (axis, (number, &x)) in rate.iter_mut().zip(omega).enumerate() {
            tangent::turn_along(&mut q, axis, (axis, 1.0));
            *number = Number::new(x);
            number.set_derivative(3 + axis, 1.0);
        }
        let advanced = Quat::from_slice(&q).integrate(Vec3::from_slice(&rate), Number::new(time));
        let turn = tangent::turn(&advanced.to_array());
        Turn {
            by_position: turn.map(|axis| [0, 1, 2].map(|k| axis.tangent[k])),
            by_velocity: turn.map(|axis| [3, 4, 5].map(|k| axis.tangent[k])),
        }
    }
}

/// Returns the dofs of the rotation of a ball or free joint, and an empty range after the dof of another joint.
pub(super) fn rotation(joint: &Joint) -> Range<usize> {
    let end = joint.dof + joint.kind.nv();
    match joint.kind {
        JointKind::Slide | JointKind::Hinge => end..end,
        JointKind::Ball | JointKind::Free => end - 3..end,
    }
}
