//! What sensors measure, evaluated after a forward pass and before the state moves on.
//!
//! The kinds are a table in `model/sensor.rs`; here stands how each is read. A file a subject: frames in motion, forces between
//! bodies, limits, volumes of sites, distances, rays.

pub(crate) mod bodies;
mod camera;
mod contact;
mod distance;
mod frame;
mod limit;
mod ray;
mod volume;

use crate::constraint::ConstraintSource;
use crate::dynamics::energy::energy;
use crate::dynamics::frames::Frames;
use crate::geometry::Geoms;
use crate::model::{
    FrameObject, Model, Params, Sensor, SensorData, SensorKind, SensorTarget, Transmission,
};
use crate::state::State;
use crate::workspace::Workspace;
use bodies::BodyForces;
use clench_math::{Mask, Quat, Real, Vec3, kernel};

/// What sensors give, and what they are computed from.
#[derive(Clone, Debug)]
pub struct SensorReadings<T> {
    /// Whether anybody reads them: else they are not computed.
    pub wanted: bool,
    /// All numbers, sensor after sensor (nsensordata).
    pub data: Vec<T>,
    /// The same as they are measured, before any delay; empty where no sensor keeps past values.
    pub measured: Vec<T>,
    /// Accelerations of bodies and forces between them, where anybody asked for them.
    pub(crate) bodies: BodyForces<T>,
}

impl<T: Real> SensorReadings<T> {
    /// Zeros.
    pub fn new(model: &Model) -> Self {
        SensorReadings {
            wanted: false,
            data: vec![T::ZERO; model.nsensordata()],
            measured: match keeps_past(model) {
                true => vec![T::ZERO; model.nsensordata()],
                false => Vec::new(),
            },
            bodies: BodyForces::new(model),
        }
    }
}

/// Whether any sensor keeps past values.
fn keeps_past(model: &Model) -> bool {
    model.sensors.iter().any(|sensor| sensor.history.is_some())
}

/// Evaluates all sensors of the model, if anybody wants them, or will.
#[kernel]
pub(crate) fn evaluate<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    ws: &mut Workspace<T>,
) {
    let kept = !ws.sensors.measured.is_empty();
    if !(ws.sensors.wanted || kept) || !model.flags.sensor {
        return;
    }
    let mut data = std::mem::take(&mut ws.sensors.data);
    let needs_bodies = |sensor: &Sensor| bodies::is_needed(sensor.kind);
    if model.sensors.iter().any(needs_bodies) {
        bodies::update(model, params, state, ws);
    }
    let source = Reading {
        model,
        params,
        state,
        ws,
    };
    for sensor in &model.sensors {
        let out = &mut data[sensor.numbers.clone()];
        source.read(sensor, out);
        if sensor.cutoff > 0.0 && is_clipped(sensor.kind) {
            clip(sensor, out);
        }
    }
    if kept {
        delay(model, params, state, &mut data, &mut ws.sensors.measured);
    }
    ws.sensors.data = data;
}

/// Keeps what was measured, and puts what was measured before in the place of what is told late, or not measured now.
fn delay<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    data: &mut [T],
    measured: &mut [T],
) {
    measured.copy_from_slice(data);
    for (s, sensor) in model.sensors.iter().enumerate() {
        let Some(history) = &sensor.history else {
            continue;
        };
        let late = params.sensor_delay[s];
        let due = history.is_due(
            &state.history,
            params.sensor_interval[s],
            state.rounded_time(),
        );
        let past = late.gt(T::ZERO) | !due;
        if past.any() {
            let told = &mut data[sensor.numbers.clone()];
            history.read(&state.history, -late, told);
            for (told, &now) in told.iter_mut().zip(&measured[sensor.numbers.clone()]) {
                *told = T::select(past, *told, now);
            }
        }
    }
}

/// Whether a cutoff holds the numbers of a kind of sensor within it.
fn is_clipped(kind: SensorKind) -> bool {
    !matches!(kind, SensorKind::FromTo | SensorKind::Contact)
}

/// Holds numbers within the cutoff.
fn clip<T: Real>(sensor: &Sensor, out: &mut [T]) {
    let cutoff = T::new(sensor.cutoff);
    for x in out {
        *x = match sensor.data {
            SensorData::Real => x.min(cutoff).max(-cutoff),
            SensorData::Positive => x.min(cutoff),
            SensorData::Axis | SensorData::Quaternion => *x,
        };
    }
}

/// All that sensors are read from.
#[derive(Clone, Copy)]
struct Reading<'a, T: Real> {
    model: &'a Model,
    params: &'a Params<T>,
    state: &'a State<T>,
    ws: &'a Workspace<T>,
}

impl<'a, T: Real> Reading<'a, T> {
    fn geoms(&self) -> Geoms<'a, T> {
        Geoms {
            model: self.model,
            params: self.params,
            position: &self.ws.position,
        }
    }

    fn frames(&self) -> Frames<'a, T> {
        Frames {
            model: self.model,
            params: self.params,
            pos: &self.ws.position,
        }
    }

    /// Writes the numbers of a sensor.
    #[kernel]
    fn read(&self, sensor: &Sensor, out: &mut [T]) {
        match &sensor.target {
            SensorTarget::Nothing => self.read_whole(sensor.kind, out),
            SensorTarget::Element(element) => self.read_element(sensor.kind, *element, out),
            SensorTarget::Frame { object, reference } => {
                self.read_frame(sensor.kind, *object, *reference, out);
            }
            SensorTarget::Inside { site, object } => {
                out[0] = self.is_inside(*site, self.position(*object));
            }
            SensorTarget::Projection { site, camera } => self.project(*site, *camera, out),
            SensorTarget::Rays { source, fields } => self.read_rays(*source, fields, out),
            SensorTarget::Contacts(query) => self.read_contacts(query, out),
            SensorTarget::Geoms(sets) => self.read_distance(sensor, sets, out),
        }
    }

    fn read_whole(&self, kind: SensorKind, out: &mut [T]) {
        let (pos, mass, state) = (&self.ws.position, &self.ws.problem.mass, self.state);
        let energy = || energy(self.model, self.params, pos, mass, &state.qpos, &state.qvel);
        match kind {
            SensorKind::PotentialEnergy => out[0] = energy().potential,
            SensorKind::KineticEnergy => out[0] = energy().kinetic,
            SensorKind::Clock => out[0] = state.rounded_time(),
            _ => out.fill(T::ZERO),
        }
    }

    /// A sensor of a site, joint, tendon, actuator or body.
    #[kernel]
    fn read_element(&self, kind: SensorKind, element: usize, out: &mut [T]) {
        use SensorKind as Kind;
        let (model, ws, state) = (self.model, self.ws, self.state);
        let joint = || &model.joints[element];
        let outputs = || model.actuators[element].outputs.clone();
        let limit = |of: ConstraintSource| self.limit(of);
        let joint_limit = || limit(ConstraintSource::JointLimit(element));
        let tendon_limit = || limit(ConstraintSource::TendonLimit(element));
        let site = FrameObject::Site(element);
        let local = |v: Vec3<T>| ws.position.site_xmat[element].transpose_mul(v);
        match kind {
            Kind::Touch => out[0] = self.touch(element),
            Kind::Accelerometer => local(self.acceleration(site).linear).write(out),
            Kind::Velocimeter => local(self.velocity(site).linear).write(out),
            Kind::Gyro => local(self.velocity(site).angular).write(out),
            Kind::Force => local(self.force_at(element).linear).write(out),
            Kind::Torque => local(self.force_at(element).angular).write(out),
            Kind::Magnetometer => local(self.params.magnetic).write(out),
            Kind::JointPos => out[0] = state.qpos[joint().qpos],
            Kind::JointVel => out[0] = state.qvel[joint().dof],
            Kind::JointActuatorFrc => out[0] = ws.force.qfrc_actuator[joint().dof],
            Kind::BallQuat => Quat::from_slice(&state.qpos[joint().qpos..])
                .normalize()
                .write(out),
            Kind::BallAngVel => out.copy_from_slice(&state.qvel[joint().dof..][..3]),
            Kind::JointLimitPos => out[0] = joint_limit().pos,
            Kind::JointLimitVel => out[0] = joint_limit().vel,
            Kind::JointLimitFrc => out[0] = joint_limit().force,
            Kind::TendonPos => out[0] = ws.position.ten_length[element],
            Kind::TendonVel => out[0] = ws.velocity.ten_velocity[element],
            Kind::TendonActuatorFrc => out[0] = self.tendon_actuator_force(element),
            Kind::TendonLimitPos => out[0] = tendon_limit().pos,
            Kind::TendonLimitVel => out[0] = tendon_limit().vel,
            Kind::TendonLimitFrc => out[0] = tendon_limit().force,
            Kind::ActuatorPos => out.copy_from_slice(&ws.position.actuator_length[outputs()]),
            Kind::ActuatorVel => out.copy_from_slice(&ws.velocity.actuator_velocity[outputs()]),
            Kind::ActuatorFrc => out.copy_from_slice(&ws.force.actuator_force[outputs()]),
            Kind::SubtreeCom => ws.position.subtree_com[element].write(out),
            Kind::SubtreeLinVel => self.subtree(element).velocity.write(out),
            Kind::SubtreeAngMom => self.subtree(element).angular_momentum.write(out),
            _ => out.fill(T::ZERO),
        }
    }

    /// The total force of a tendon's actuators.
    fn tendon_actuator_force(&self, tendon: usize) -> T {
        let mut sum = T::ZERO;
        for actuator in &self.model.actuators {
            if actuator.transmission == Transmission::Tendon(tendon) {
                sum += self.ws.force.actuator_force[actuator.outputs.start];
            }
        }
        sum
    }
}
