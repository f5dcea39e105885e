//! Springs that draw a body to where the user points, or turn it.
//!
//! Per unit of the mass m that the body resists a force with, the spring has the rate k = 100 s⁻² and critical damping, so that
//! light and heavy bodies follow alike: f = m (k (target − p) − 2 √k ṗ), at the point p of the body. m is the inverse of the
//! body's mean inverse weight in the initial configuration, `body_invweight0`. What turns has the same rate and damping about the
//! centre of mass, with the inverse of the rotational inverse weight in the place of m: τ = I (k θ − 2 √k ω), where θ is the rotation
//! vector that is left.

use clench::math::{Force, Quat, Real, Scalar, Vec3};
use clench::rigid::{Precision, Sim, Workspace};

/// The spring's rate over mass, s⁻².
const RATE: f64 = 100.0;

/// A spring between a point of a body and one of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Drag {
    /// The body.
    pub body: usize,
    /// The point in the body's frame, m.
    pub point: [f64; 3],
    /// Where it is drawn to, m.
    pub target: [f64; 3],
    /// The force of the last step, N.
    force: [f64; 3],
}

impl Drag {
    /// A spring that has not pulled yet.
    pub fn new(body: usize, point: [f64; 3], target: [f64; 3]) -> Self {
        Drag {
            body,
            point,
            target,
            force: [0.0; 3],
        }
    }

    /// Writes the spring's force into the applied forces of the body, in place of what is there.
    pub fn apply<T: Precision>(&mut self, sim: &mut Sim<T>) {
        let (model, ws) = (sim.model(), sim.workspace());
        let body = self.body;
        let compliance = model.params.body_invweight0[body][0];
        if compliance <= 0.0 {
            return;
        }
        let place = at(ws, body, self.point);
        let com = ws.position.subtree_com[model.bodies[body].root];
        let velocity = wide(ws.velocity.cvel[body].velocity_at(place - com));
        let place = wide(place);
        let pull = Vec3::from_array(self.target) - place;
        let force = (pull * RATE - velocity * (2.0 * RATE.sqrt())) * (1.0 / compliance);
        let torque = (place - wide(ws.position.xipos[body])).cross(force);
        self.force = force.to_array();
        sim.state.xfrc_applied[body] = Force::new(narrow(torque), narrow(force));
    }

    /// Takes the force away.
    pub fn release<T: Precision>(&self, sim: &mut Sim<T>) {
        sim.state.xfrc_applied[self.body] = Force::ZERO;
    }

    /// As a frame shows it: the body, the point in the world, where it is drawn to, the force.
    pub(crate) fn row<T: Real>(&self, ws: &Workspace<T>) -> [f32; 10] {
        let mut row = [self.body as f32; 10];
        let place = wide(at(ws, self.body, self.point)).to_array();
        let numbers = place.iter().chain(&self.target).chain(&self.force);
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
    /// The orientation that it is turned to; w first, of length 1.
    pub target: [f64; 4],
    /// The torque of the last step, N m.
    torque: [f64; 3],
}

impl Turn {
    /// A spring that has not turned yet.
    pub fn new(body: usize, target: [f64; 4]) -> Self {
        Turn {
            body,
            target,
            torque: [0.0; 3],
        }
    }

    /// Writes the spring's torque into the applied forces of the body, in place of what is there.
    pub fn apply<T: Precision>(&mut self, sim: &mut Sim<T>) {
        let (model, ws) = (sim.model(), sim.workspace());
        let compliance = model.params.body_invweight0[self.body][1];
        if compliance <= 0.0 {
            return;
        }
        let omega = wide(ws.velocity.cvel[self.body].angular);
        let spring = self.left(ws) * RATE - omega * (2.0 * RATE.sqrt());
        let torque = spring * (1.0 / compliance);
        self.torque = torque.to_array();
        sim.state.xfrc_applied[self.body] = Force::new(narrow(torque), Vec3::ZERO);
    }

    /// Takes the torque away.
    pub fn release<T: Precision>(&self, sim: &mut Sim<T>) {
        sim.state.xfrc_applied[self.body] = Force::ZERO;
    }

    /// The rotation from where the body is to where it shall be, in world axes, rad.
    fn left<T: Real>(&self, ws: &Workspace<T>) -> Vec3<f64> {
        let now = ws.position.xquat[self.body]
            .to_array()
            .map(|x| x.lane(0).to_f64());
        let from_now = Quat::from_f64(self.target) * Quat::from_f64(now).conjugate();
        from_now.to_rotation_vector()
    }

    /// As a frame shows it: the body, its centre of mass, what is left to turn, the torque.
    pub(crate) fn row<T: Real>(&self, ws: &Workspace<T>) -> [f32; 10] {
        let mut row = [self.body as f32; 10];
        let place = wide(ws.position.xipos[self.body]).to_array();
        let left = self.left(ws).to_array();
        let numbers = place.iter().chain(&left).chain(&self.torque);
        for (to, &from) in row[1..].iter_mut().zip(numbers) {
            *to = from as f32;
        }
        row
    }
}

/// A point of a body in the world.
fn at<T: Real>(ws: &Workspace<T>, body: usize, point: [f64; 3]) -> Vec3<T> {
    let turned = ws.position.xquat[body].rotate(narrow(Vec3::from_array(point)));
    ws.position.xpos[body] + turned
}

/// A vector of lane 0.
fn wide<T: Real>(v: Vec3<T>) -> Vec3<f64> {
    Vec3::from_array(v.to_array().map(|x| x.lane(0).to_f64()))
}

fn narrow<T: Real>(v: Vec3<f64>) -> Vec3<T> {
    Vec3::from_array(v.to_array().map(T::new))
}
