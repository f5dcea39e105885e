//! The sensors that follow from motion and actuation.

use crate::stage::Stage;
use clench_dynamics::model::{Sensor, SensorKind};
use clench_dynamics::sensor_group;

/// Returns the last stage whose results a sensor reads, besides accelerations; `None` if it also reads contacts,
/// constraints or past measurements.
pub(crate) fn last_stage(sensor: &Sensor) -> Option<Stage> {
    let stage = match sensor.kind {
        sensor_group!(geoms)
        | SensorKind::Magnetometer
        | SensorKind::JointPos
        | SensorKind::BallQuat
        | SensorKind::TendonPos
        | SensorKind::ActuatorPos
        | SensorKind::SubtreeCom
        | SensorKind::FramePos
        | SensorKind::FrameQuat
        | SensorKind::FrameXAxis
        | SensorKind::FrameYAxis
        | SensorKind::FrameZAxis
        | SensorKind::Rangefinder
        | SensorKind::CamProjection
        | SensorKind::InsideSite
        | SensorKind::Clock
        | SensorKind::User => Stage::Positions,
        SensorKind::Velocimeter
        | SensorKind::Gyro
        | SensorKind::JointVel
        | SensorKind::BallAngVel
        | SensorKind::TendonVel
        | SensorKind::ActuatorVel
        | SensorKind::SubtreeLinVel
        | SensorKind::SubtreeAngMom
        | SensorKind::FrameLinVel
        | SensorKind::FrameAngVel => Stage::Velocities,
        SensorKind::Accelerometer
        | SensorKind::JointActuatorFrc
        | SensorKind::TendonActuatorFrc
        | SensorKind::ActuatorFrc
        | SensorKind::FrameLinAcc
        | SensorKind::FrameAngAcc => Stage::Forces,
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
        | SensorKind::KineticEnergy => return None,
    };
    sensor.history.is_none().then_some(stage)
}
