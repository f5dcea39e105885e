//! The relative motion of two frames, on two bodies: the rows of connects and welds with their rates, and how they
//! change with the motion of both bodies.
//!
//! A dof with axis s that moves a body changes its velocity v and acceleration a as in the module
//! `clench_dynamics::dynamics::inverse_derivatives`:
//!
//! ```text
//! by q:   δv = ṡ    δa = w × s − ṡ × u + ṡ × v    in a frame that moves with the body
//! by v:   δv = s    δa = ṡ − s × u′ + s × v       in the world
//! ```

use super::step::Step;
use clench_dynamics::constraint::AnchorFrames;
use clench_dynamics::dynamics::chains::BodyPoint;
use clench_dynamics::dynamics::inverse_derivatives::InverseDerivatives;
use clench_math::{Force, Motion, Quat, Vec3};

/// The rows r, ṙ and r̈ of a constraint, or their changes: the parts of translation and of rotation.
pub(super) type Rows = [[Vec3<f64>; 2]; 3];

/// The motion of an anchor with its body, or a change of this motion: angular, then linear at the anchor, along the
/// axes of the world.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Anchor {
    /// The displacement; zero if this is a motion.
    shift: Motion<f64>,
    velocity: Motion<f64>,
    /// The acceleration, gravity included.
    acceleration: Motion<f64>,
}

/// Two frames and their motion.
pub(super) struct Pair {
    pub bodies: [usize; 2],
    pub rows: Rows,
    /// The anchors from the reference points of the bodies' trees.
    offsets: [Vec3<f64>; 2],
    anchors: [Anchor; 2],
    relative: Option<Relative>,
}

/// The rotation of the first frame relative to the second.
struct Relative {
    rho: Quat<f64>,
    /// From world axes to the second frame.
    to_second: Quat<f64>,
    scale: f64,
    /// The angular velocity of the first frame minus the second's, and its rate, along the axes of the second.
    u: Vec3<f64>,
    u_rate: Vec3<f64>,
}

impl Pair {
    /// Returns the frames of a connect or weld at the motion that `inverse` holds.
    pub(super) fn new(
        step: &Step<'_>,
        inverse: &InverseDerivatives<f64>,
        frames: &AnchorFrames<f64>,
        weld: bool,
    ) -> Self {
        let (pos, bodies) = (&step.plain.position, frames.bodies);
        let points = frames.points(pos);
        let offset = |b: usize| BodyPoint::new(step.model, pos, bodies[b], points[b]).offset;
        let offsets = [offset(0), offset(1)];
        let anchors = [0, 1].map(|b| {
            let (velocity, acceleration) = (
                at(step.plain.velocity.cvel[bodies[b]], offsets[b]),
                at(inverse.accelerations()[bodies[b]], offsets[b]),
            );
            let turning = velocity.angular.cross(velocity.linear);
            Anchor {
                shift: Motion::ZERO,
                velocity,
                acceleration: acceleration + Motion::new(Vec3::ZERO, turning),
            }
        });
        let mut pair = Pair {
            bodies,
            rows: Rows::default(),
            offsets,
            anchors,
            relative: weld.then(|| Relative::new(step, frames, &anchors)),
        };
        let [r, velocity, acceleration] = &mut pair.rows;
        r[0] = points[0] - points[1];
        velocity[0] = anchors[0].velocity.linear - anchors[1].velocity.linear;
        acceleration[0] = anchors[0].acceleration.linear - anchors[1].acceleration.linear;
        if let Some(relative) = &pair.relative {
            let rows = relative.rows();
            for (row, rotation) in pair.rows.iter_mut().zip(rows) {
                row[1] = rotation;
            }
        }
        pair
    }

    /// Returns a motion of a body about its anchor.
    pub(super) fn about(&self, motion: Motion<f64>, b: usize) -> Motion<f64> {
        at(motion, self.offsets[b])
    }

    /// Returns the change of an anchor's motion with the position of a dof that moves its body.
    pub(super) fn by_position(
        &self,
        step: &Step<'_>,
        inverse: &InverseDerivatives<f64>,
        (dof, b): (usize, usize),
    ) -> Anchor {
        let (pos, vel) = (&step.plain.position, &step.plain.velocity);
        let (rate, now) = (vel.cdof_dot[dof], &self.anchors[b]);
        let [swing, _] = inverse.changes(dof);
        let shift = self.about(pos.cdof[dof], b);
        let velocity = self.about(rate, b);
        let acceleration = self.about(swing + rate.cross(vel.cvel[self.bodies[b]]), b);
        let turn = |motion: Motion<f64>| {
            let turn = shift.angular;
            Motion::new(turn.cross(motion.angular), turn.cross(motion.linear))
        };
        Anchor {
            shift,
            velocity: velocity + turn(now.velocity),
            acceleration: now.with_turning(acceleration, velocity) + turn(now.acceleration),
        }
    }

    /// Returns the change of an anchor's motion with the velocity of a dof that moves its body.
    pub(super) fn by_velocity(
        &self,
        step: &Step<'_>,
        inverse: &InverseDerivatives<f64>,
        (dof, b): (usize, usize),
    ) -> Anchor {
        let axis = step.plain.position.cdof[dof];
        let [_, drift] = inverse.changes(dof);
        let velocity = self.about(axis, b);
        let cvel = step.plain.velocity.cvel[self.bodies[b]];
        let acceleration = self.about(drift + axis.cross(cvel), b);
        Anchor {
            shift: Motion::ZERO,
            velocity,
            acceleration: self.anchors[b].with_turning(acceleration, velocity),
        }
    }

    /// Returns the changes of the rows with those of both anchors.
    pub(super) fn change(&self, [first, second]: &[Anchor; 2]) -> Rows {
        let relative = [
            first.shift - second.shift,
            first.velocity - second.velocity,
            first.acceleration - second.acceleration,
        ];
        let rotations = match &self.relative {
            Some(relative) => relative.change(&self.anchors, [first, second]),
            None => [Vec3::ZERO; 3],
        };
        [0, 1, 2].map(|k| [relative[k].linear, rotations[k]])
    }

    /// Returns the wrench on the first body about its anchor, of forces along the rows.
    pub(super) fn wrench(&self, [force, along]: [Vec3<f64>; 2]) -> Force<f64> {
        let torque = match &self.relative {
            Some(relative) => relative.torque(relative.rho, along),
            None => Vec3::ZERO,
        };
        Force::new(torque, force)
    }

    /// Returns the change of this wrench with those of the forces and of both anchors.
    pub(super) fn wrench_change(
        &self,
        [_, along]: [Vec3<f64>; 2],
        change: [Vec3<f64>; 2],
        [first, second]: &[Anchor; 2],
    ) -> Force<f64> {
        let mut wrench = self.wrench(change);
        if let Some(relative) = &self.relative {
            let rho = relative.rho_change([first, second]);
            wrench.angular += relative.torque(rho, along);
            let torque = relative.torque(relative.rho, along);
            wrench.angular += second.shift.angular.cross(torque);
        }
        wrench
    }
}

impl Anchor {
    /// Adds to a change of the spatial acceleration, about the anchor, the change of ω × ṗ.
    fn with_turning(&self, acceleration: Motion<f64>, velocity: Motion<f64>) -> Motion<f64> {
        let now = self.velocity;
        let turning = velocity.angular.cross(now.linear) + now.angular.cross(velocity.linear);
        acceleration + Motion::new(Vec3::ZERO, turning)
    }
}

impl Relative {
    fn new(step: &Step<'_>, frames: &AnchorFrames<f64>, [first, second]: &[Anchor; 2]) -> Self {
        let quat = |b: usize| step.plain.position.xquat[frames.bodies[b]] * frames.quats[b];
        let to_second = quat(1).conjugate();
        let omega = first.velocity.angular - second.velocity.angular;
        let rate = first.acceleration.angular - second.acceleration.angular;
        let seen = rate - second.velocity.angular.cross(omega);
        Relative {
            rho: to_second * quat(0),
            to_second,
            scale: frames.torquescale,
            u: to_second.rotate(omega),
            u_rate: to_second.rotate(seen),
        }
    }

    /// Returns r, ṙ and r̈.
    fn rows(&self) -> [Vec3<f64>; 3] {
        let turning = half_product(self.u, product(self.u, self.rho)) * 0.5;
        [
            self.rho.imaginary() * self.scale,
            half_product(self.u, self.rho) * self.scale,
            (half_product(self.u_rate, self.rho) + turning) * self.scale,
        ]
    }

    /// Returns the change of ρ with those of both anchors.
    fn rho_change(&self, [first, second]: [&Anchor; 2]) -> Quat<f64> {
        let turn = first.shift.angular - second.shift.angular;
        scaled(product(self.to_second.rotate(turn), self.rho), 0.5)
    }

    /// Returns the changes of r, ṙ and r̈ with those of both anchors.
    fn change(&self, now: &[Anchor; 2], [first, second]: [&Anchor; 2]) -> [Vec3<f64>; 3] {
        let turn = second.shift.angular;
        let omega = now[0].velocity.angular - now[1].velocity.angular;
        let omega_change = first.velocity.angular - second.velocity.angular;
        let seen = |omega2: Vec3<f64>, omega: Vec3<f64>| omega2.cross(omega);
        let now_rate = now[0].acceleration.angular
            - now[1].acceleration.angular
            - seen(now[1].velocity.angular, omega);
        let rate = first.acceleration.angular
            - second.acceleration.angular
            - seen(second.velocity.angular, omega)
            - seen(now[1].velocity.angular, omega_change);
        let u = (self.to_second).rotate(omega_change - turn.cross(omega));
        let u_rate = (self.to_second).rotate(rate - turn.cross(now_rate));
        let rho = self.rho_change([first, second]);
        let turning = half_product(u, product(self.u, self.rho))
            + half_product(self.u, product(u, self.rho))
            + half_product(self.u, product(self.u, rho));
        [
            rho.imaginary() * self.scale,
            (half_product(u, self.rho) + half_product(self.u, rho)) * self.scale,
            (half_product(u_rate, self.rho) + half_product(self.u_rate, rho) + turning * 0.5)
                * self.scale,
        ]
    }

    /// Returns the torque on the first body of forces along the rows of rotation, at an orientation ρ or its change.
    fn torque(&self, rho: Quat<f64>, along: Vec3<f64>) -> Vec3<f64> {
        let turned = along * rho.w + rho.imaginary().cross(along);
        (self.to_second.conjugate()).rotate(turned * (0.5 * self.scale))
    }
}

/// Returns a motion about the point at `offset`.
fn at(motion: Motion<f64>, offset: Vec3<f64>) -> Motion<f64> {
    Motion::new(motion.angular, motion.velocity_at(offset))
}

/// Returns (0, u) q.
fn product(u: Vec3<f64>, q: Quat<f64>) -> Quat<f64> {
    Quat::new(0.0, u.x, u.y, u.z) * q
}

/// Returns the imaginary part of ½ (0, u) q.
fn half_product(u: Vec3<f64>, q: Quat<f64>) -> Vec3<f64> {
    (u * q.w + u.cross(q.imaginary())) * 0.5
}

fn scaled(q: Quat<f64>, factor: f64) -> Quat<f64> {
    let [w, x, y, z] = q.to_array().map(|x| x * factor);
    Quat::new(w, x, y, z)
}
