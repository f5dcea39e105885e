//! Springs that pull a body to the point that the user selects, or rotate it.
//!
//! Per unit of the effective mass m of the body, the spring has the stiffness k = 100 s⁻² and critical damping, so that
//! light and heavy bodies respond equally: f = m (k (target − p) − 2 √k ṗ), at the point p of the body. m is the
//! inverse of the body's mean inverse weight in the initial configuration, `body_invweight0`. The torsional spring has
//! the same stiffness and damping about the centre of mass, with the inverse rotational weight: τ = I (k θ − 2 √k ω),
//! where θ is the remaining rotation vector.

use clench::math::{Force, Quat, Real, Scalar, Vec3};
use clench::rigid::{Precision, Sim, Workspace};

/// The spring's stiffness over mass, s⁻².
const RATE: f64 = 100.0;

/// A spring between a point of a body and a point of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Drag {
    /// The body.
    pub body: usize,
    /// The point in the body frame, m.
    pub point: [f64; 3],
    /// The target, m.
    pub target: [f64; 3],
    /// The force of the last step, N.
    force: [f64; 3],
}

impl Drag {
    /// Creates a spring with zero force.
    pub fn new(body: usize, point: [f64; 3], target: [f64; 3]) -> Self {
        Drag {
            body,
            point,
            target,
            force: [0.0; 3],
        }
    }

    /// Sets the applied force of the body to the spring's force.
    pub fn apply<T: Precision>(&mut self, sim: &mut Sim<T>) {
        let (model, ws) = (sim.model(), sim.workspace());
        let body = self.body;
        let compliance = model.params.body_invweight0[body][0];
        if compliance <= 0.0 {
            return;
        }
        let position = at(ws, body, self.point);
        let com = ws.position.subtree_com[model.bodies[body].root];
        let velocity = wide(ws.velocity.cvel[body].velocity_at(position - com));
        let position = wide(position);
        let pull = Vec3::from_array(self.target) - position;
        let force = (pull * RATE - velocity * (2.0 * RATE.sqrt())) * (1.0 / compliance);
        let torque = (position - wide(ws.position.xipos[body])).cross(force);
        self.force = force.to_array();
        sim.state.xfrc_applied[body] = Force::new(narrow(torque), narrow(force));
    }

    /// Clears the applied force.
    pub fn release<T: Precision>(&self, sim: &mut Sim<T>) {
        sim.state.xfrc_applied[self.body] = Force::ZERO;
    }

    /// Returns the row of a frame: the body, the point in the world, the target, the force.
    pub(crate) fn row<T: Real>(&self, ws: &Workspace<T>) -> [f32; 10] {
        let mut row = [self.body as f32; 10];
        let position = wide(at(ws, self.body, self.point)).to_array();
        let numbers = position.iter().chain(&self.target).chain(&self.force);
        for (to, &from) in row[1..].iter_mut().zip(numbers) {
            *to = from as f32;
        }
        row
    }
}

/// A torsional spring between a body and an orientation in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// The body.
    pub body: usize,
    /// The target orientation, a unit quaternion with w first.
    pub target: [f64; 4],
    /// The torque of the last step, N m.
    torque: [f64; 3],
}

impl Turn {
    /// Creates a spring with zero torque.
    pub fn new(body: usize, target: [f64; 4]) -> Self {
        Turn {
            body,
            target,
            torque: [0.0; 3],
        }
    }

    /// Sets the applied force of the body to the spring's torque.
    pub fn apply<T: Precision>(&mut self, sim: &mut Sim<T>) {
        let (model, ws) = (sim.model(), sim.workspace());
        let compliance = model.params.body_invweight0[self.body][1];
        if compliance <= 0.0 {
            return;
        }
        let omega = wide(ws.velocity.cvel[self.body].angular);
        let spring = self.remaining(ws) * RATE - omega * (2.0 * RATE.sqrt());
        let torque = spring * (1.0 / compliance);
        self.torque = torque.to_array();
        sim.state.xfrc_applied[self.body] = Force::new(narrow(torque), Vec3::ZERO);
    }

    /// Clears the applied torque.
    pub fn release<T: Precision>(&self, sim: &mut Sim<T>) {
        sim.state.xfrc_applied[self.body] = Force::ZERO;
    }

    /// Returns the rotation from the current to the target orientation, in world axes, rad.
    fn remaining<T: Real>(&self, ws: &Workspace<T>) -> Vec3<f64> {
        let now = ws.position.xquat[self.body]
            .to_array()
            .map(|x| x.lane(0).to_f64());
        let from_now = Quat::from_f64(self.target) * Quat::from_f64(now).conjugate();
        from_now.to_rotation_vector()
    }

    /// Returns the row of a frame: the body, its centre of mass, the remaining rotation, the torque.
    pub(crate) fn row<T: Real>(&self, ws: &Workspace<T>) -> [f32; 10] {
        let mut row = [self.body as f32; 10];
        let position = wide(ws.position.xipos[self.body]).to_array();
        let remaining = self.remaining(ws).to_array();
        let numbers = position.iter().chain(&remaining).chain(&self.torque);
        for (to, &from) in row[1..].iter_mut().zip(numbers) {
            *to = from as f32;
        }
        row
    }
}

/// Returns the world position of a point of a body.
fn at<T: Real>(ws: &Workspace<T>, body: usize, point: [f64; 3]) -> Vec3<T> {
    let turned = ws.position.xquat[body].rotate(narrow(Vec3::from_array(point)));
    ws.position.xpos[body] + turned
}

/// Converts lane 0 of a vector.
fn wide<T: Real>(v: Vec3<T>) -> Vec3<f64> {
    Vec3::from_array(v.to_array().map(|x| x.lane(0).to_f64()))
}

fn narrow<T: Real>(v: Vec3<f64>) -> Vec3<T> {
    Vec3::from_array(v.to_array().map(T::new))
}
