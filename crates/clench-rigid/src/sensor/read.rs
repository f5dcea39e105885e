//! The reading of one sensor by its kind, and the data that it is read from.

use clench_dynamics::Step;
use clench_dynamics::constraint::ConstraintSource;
use clench_dynamics::dynamics::frames::Frames;
use clench_dynamics::geometry::Geoms;
use clench_dynamics::model::{
    FrameObject, Model, Params, Sensor, SensorKind, SensorTarget, Transmission,
};
use clench_dynamics::sensor_group;
use clench_dynamics::settings::StepSettings;
use clench_dynamics::state::State;
use clench_dynamics::workspace::Workspace;
use clench_math::{Quat, Real, Vec3, kernel};

#[derive(Clone, Copy)]
pub(super) struct Reading<'a, T: Real> {
    pub(super) model: &'a Model,
    pub(super) params: &'a Params<T>,
    pub(super) settings: &'a StepSettings,
    pub(super) state: &'a State<T>,
    pub(super) ws: &'a Workspace<T>,
}

impl<'a, T: Real> Reading<'a, T> {
    pub(super) fn geoms(&self) -> Geoms<'a, T> {
        Geoms {
            model: self.model,
            params: self.params,
            position: &self.ws.position,
        }
    }

    pub(super) fn frames(&self) -> Frames<'a, T> {
        Frames {
            model: self.model,
            params: self.params,
            pos: &self.ws.position,
        }
    }

    /// Writes the values of a sensor.
    #[kernel]
    pub(super) fn read(&self, sensor: &Sensor, out: &mut [T]) {
        match &sensor.target {
            SensorTarget::Nothing => self.read_whole(sensor.kind, out),
            SensorTarget::Element(element) => self.read_element(sensor.kind, *element, out),
            SensorTarget::Frame { object, reference } => {
                self.read_frame(sensor.kind, *object, *reference, out);
            }
            &SensorTarget::Inside {
                site,
                object,
                enclosed,
            } => {
                out[0] = match enclosed {
                    true => self.protrusion(site, object),
                    false => self.is_inside(site, self.position(object)),
                };
            }
            SensorTarget::Projection { site, camera } => self.project(*site, *camera, out),
            SensorTarget::Rays { source, fields } => self.read_rays(*source, fields, out),
            SensorTarget::Contacts(query) => self.read_contacts(query, out),
            &SensorTarget::Taxels { mesh, geom } => self.read_taxels(mesh, geom, out),
            SensorTarget::Geoms(sets) => self.read_distance(sensor, sets, out),
        }
    }

    fn read_whole(&self, kind: SensorKind, out: &mut [T]) {
        let (pos, mass, state) = (&self.ws.position, self.ws.mass(), self.state);
        let energy = || (Step::compiled().energy)(self.model, self.params, pos, mass, state);
        match kind {
            SensorKind::PotentialEnergy => out[0] = energy().potential,
            SensorKind::KineticEnergy => out[0] = energy().kinetic,
            SensorKind::Clock => out[0] = state.rounded_time(),
            // No program of the user's writes it here.
            SensorKind::User => out.fill(T::ZERO),
            // The builder gives these kinds other targets.
            sensor_group!(element)
            | sensor_group!(frame)
            | sensor_group!(geoms)
            | sensor_group!(others) => out.fill(T::ZERO),
        }
    }

    /// Reads a sensor of a site, joint, tendon, actuator or body.
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
            // The builder gives these kinds other targets.
            sensor_group!(whole)
            | sensor_group!(frame)
            | sensor_group!(geoms)
            | sensor_group!(others) => out.fill(T::ZERO),
        }
    }

    /// Returns the total force of a tendon's actuators.
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
