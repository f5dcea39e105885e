//! The derivatives of sensors that follow from motion and actuation, after recursions found those of the acceleration.
//!
//! Poses, velocities and actuator forces in dual numbers suffice for these sensors. Contacts and constraints, whose
//! passes take longest, have no part in them.

use crate::direction::Start;
use crate::pass::DualPass;
use crate::seed::{self, Seed};
use crate::source::Source;
use clench_dynamics::dynamics::actuation::actuation;
use clench_dynamics::dynamics::kinematics::Computed;
use clench_dynamics::model::{Sensor, SensorKind};
use clench_dynamics::part::Part;
use clench_dynamics::pipeline::{poses, velocity_stage};
use clench_dynamics::sensor_group;
use clench_math::Real;
use clench_rigid::evaluate_sensors;

/// Returns true if a sensor reads nothing but motion, accelerations included, and the forces of actuators.
pub(crate) fn is_kinematic(sensor: &Sensor) -> bool {
    let kinematic = match sensor.kind {
        sensor_group!(frame)
        | sensor_group!(geoms)
        | SensorKind::Accelerometer
        | SensorKind::Velocimeter
        | SensorKind::Gyro
        | SensorKind::Magnetometer
        | SensorKind::JointPos
        | SensorKind::JointVel
        | SensorKind::JointActuatorFrc
        | SensorKind::BallQuat
        | SensorKind::BallAngVel
        | SensorKind::TendonPos
        | SensorKind::TendonVel
        | SensorKind::TendonActuatorFrc
        | SensorKind::ActuatorPos
        | SensorKind::ActuatorVel
        | SensorKind::ActuatorFrc
        | SensorKind::SubtreeCom
        | SensorKind::SubtreeLinVel
        | SensorKind::SubtreeAngMom
        | SensorKind::Rangefinder
        | SensorKind::CamProjection
        | SensorKind::InsideSite
        | SensorKind::Clock
        | SensorKind::User => true,
        SensorKind::Touch
        | SensorKind::Force
        | SensorKind::Torque
        | SensorKind::JointLimitPos
        | SensorKind::JointLimitVel
        | SensorKind::JointLimitFrc
        | SensorKind::TendonLimitPos
        | SensorKind::TendonLimitVel
        | SensorKind::TendonLimitFrc
        | SensorKind::Contact
        | SensorKind::Tactile
        | SensorKind::PotentialEnergy
        | SensorKind::KineticEnergy => false,
    };
    kinematic && sensor.history.is_none()
}

impl<L: Real<Scalar = f64>> DualPass<L> {
    /// Computes the derivatives of the sensors along directions, one in each seed's slot. `columns` are their columns
    /// in the derivatives of the acceleration. `write` receives those of each number of the sensors.
    pub(crate) fn read_sensors(
        &mut self,
        source: Source<'_>,
        (seeds, columns): (&[Seed], &[usize]),
        write: &mut dyn FnMut(usize, &[f64]),
    ) {
        let Source {
            model, settings, ..
        } = source;
        if source.first {
            self.before.set_values(source.state);
        } else {
            self.clear_state(model, source.request);
        }
        seed::set(model, seeds, &mut self.before, &mut self.params);
        let last = std::mem::replace(&mut self.last, source.start);
        let DualPass {
            params,
            before,
            ws,
            recursive,
            ..
        } = self;
        match source.start {
            Start::Positions => {
                ws.invalidate_poses();
                ws.contacts.clear();
                let whole = [Part::whole(model)];
                poses(
                    model,
                    params,
                    before,
                    Computed::all(&whole),
                    &mut ws.position,
                );
            }
            Start::Velocities | Start::Forces if last == Start::Positions => ws.hold_positions(),
            Start::Velocities | Start::Forces => {}
        }
        match source.start {
            Start::Positions | Start::Velocities => velocity_stage(model, params, before, ws),
            Start::Forces if last != Start::Forces => ws.hold_velocities(),
            Start::Forces => {}
        }
        let (pos, vel) = (&ws.position, &ws.velocity);
        actuation(model, params, before, pos, vel, Real::ZERO, &mut ws.force);
        for (dof, qacc) in ws.qacc.iter_mut().enumerate() {
            *qacc = Real::new(recursive.plain.qacc[dof]);
            let rates = recursive.acceleration(dof);
            for (slot, &column) in columns.iter().enumerate() {
                qacc.set_derivative(slot, rates[column]);
            }
        }
        ws.sensors.wanted = true;
        evaluate_sensors(model, params, settings, before, ws);
        for (row, number) in ws.sensors.data.iter().enumerate() {
            write(row, &L::as_scalars(&number.tangent)[..columns.len()]);
        }
    }
}
