//! The results of a step that sensors and outputs read.

use crate::stage::Stage;
use clench_dynamics::model::{
    FrameObject, Integrator, JointKind, Model, Sensor, SensorKind, SensorTarget, Transmission,
};
use clench_dynamics::sensor_group;
use clench_rigid::Output;

/// The results of a step that y reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reads {
    /// The last stage.
    pub stage: Stage,
    /// The number of bodies whose motion it reads: the first ones.
    pub bodies: usize,
    /// True if it reads accelerations of bodies.
    pub accelerations: bool,
    /// True if it reads forces of constraints.
    pub forces: bool,
    /// True if it reads how contacts move.
    pub contacts: bool,
}

impl Reads {
    /// Reads the first `bodies` bodies up to a stage.
    fn of(stage: Stage, bodies: usize) -> Self {
        Reads {
            stage,
            bodies,
            accelerations: false,
            forces: false,
            contacts: false,
        }
    }

    /// Returns what sensors and outputs read; `None` if their derivatives need passes.
    pub(crate) fn new(model: &Model, sensors: &[Sensor], outputs: &[Output]) -> Option<Self> {
        let sensors = sensors.iter().map(|sensor| of_sensor(model, sensor));
        let outputs = outputs.iter().map(|output| {
            let positions = Reads::of(Stage::Positions, model.nbody());
            output.follows_from_positions().then_some(positions)
        });
        let mut all = Reads::of(Stage::Positions, 1);
        for reads in sensors.chain(outputs) {
            let reads = reads?;
            all = Reads {
                stage: all.stage.max(reads.stage),
                bodies: all.bodies.max(reads.bodies),
                accelerations: all.accelerations | reads.accelerations,
                forces: all.forces | reads.forces,
                contacts: all.contacts | reads.contacts,
            };
        }
        // The workspace holds the forces of the last stage of a step.
        let kept = !all.forces || model.integrator != Integrator::Rk4;
        kept.then_some(all)
    }

    /// Returns the last stage at which a direction that changes y starts.
    pub(crate) fn last_start(self) -> Stage {
        match self.accelerations || self.forces {
            true => Stage::Forces,
            false => self.stage,
        }
    }
}

/// Returns what a sensor reads; `None` if its derivatives need passes.
fn of_sensor(model: &Model, sensor: &Sensor) -> Option<Reads> {
    let all = model.nbody();
    let of_object = |object: FrameObject| match object {
        // Cameras may follow other bodies.
        FrameObject::Camera(_) => all,
        FrameObject::Inertial(_)
        | FrameObject::Body(_)
        | FrameObject::Geom(_)
        | FrameObject::Site(_) => object.body(model) + 1,
    };
    let own = match sensor.target {
        SensorTarget::Frame { object, reference } => {
            of_object(object).max(reference.map_or(0, of_object))
        }
        // Of a sensor of another element than a site, `own` is not used.
        SensorTarget::Element(site) => model.sites.get(site).map_or(all, |site| site.body + 1),
        SensorTarget::Nothing
        | SensorTarget::Inside { .. }
        | SensorTarget::Projection { .. }
        | SensorTarget::Rays { .. }
        | SensorTarget::Contacts(_)
        | SensorTarget::Taxels { .. }
        | SensorTarget::Geoms(_) => all,
    };
    let accelerated = Reads {
        accelerations: true,
        ..Reads::of(Stage::Velocities, own)
    };
    let pressed = Reads {
        forces: true,
        ..Reads::of(Stage::Positions, 0)
    };
    Some(match sensor.kind {
        SensorKind::JointPos | SensorKind::BallQuat | SensorKind::Clock | SensorKind::User => {
            Reads::of(Stage::Positions, 0)
        }
        SensorKind::Magnetometer
        | SensorKind::FramePos
        | SensorKind::FrameQuat
        | SensorKind::FrameXAxis
        | SensorKind::FrameYAxis
        | SensorKind::FrameZAxis => Reads::of(Stage::Positions, own),
        sensor_group!(geoms)
        | SensorKind::TendonPos
        | SensorKind::ActuatorPos
        | SensorKind::SubtreeCom
        | SensorKind::Rangefinder
        | SensorKind::CamProjection
        | SensorKind::InsideSite
        | SensorKind::PotentialEnergy => Reads::of(Stage::Positions, all),
        SensorKind::JointVel | SensorKind::BallAngVel => Reads::of(Stage::Velocities, 0),
        SensorKind::Velocimeter
        | SensorKind::Gyro
        | SensorKind::FrameLinVel
        | SensorKind::FrameAngVel => Reads::of(Stage::Velocities, own),
        SensorKind::TendonVel
        | SensorKind::ActuatorVel
        | SensorKind::SubtreeLinVel
        | SensorKind::SubtreeAngMom => Reads::of(Stage::Velocities, all),
        SensorKind::Accelerometer | SensorKind::FrameLinAcc | SensorKind::FrameAngAcc => {
            accelerated
        }
        SensorKind::JointActuatorFrc | SensorKind::TendonActuatorFrc | SensorKind::ActuatorFrc => {
            Reads::of(Stage::Forces, of_actuators(model))
        }
        SensorKind::Touch | SensorKind::JointLimitFrc | SensorKind::TendonLimitFrc => pressed,
        SensorKind::Contact | SensorKind::Tactile => Reads {
            contacts: true,
            forces: true,
            ..Reads::of(Stage::Velocities, all)
        },
        SensorKind::Force | SensorKind::Torque => Reads {
            contacts: true,
            forces: true,
            accelerations: true,
            ..Reads::of(Stage::Forces, all)
        },
        SensorKind::JointLimitPos
        | SensorKind::JointLimitVel
        | SensorKind::TendonLimitPos
        | SensorKind::TendonLimitVel
        | SensorKind::KineticEnergy => return None,
    })
}

/// Returns the number of bodies whose motion determines the forces of actuators: none if each acts along coordinates
/// of joints.
fn of_actuators(model: &Model) -> usize {
    let straight = model
        .actuators
        .iter()
        .all(|actuator| match actuator.transmission {
            Transmission::Joint(j) | Transmission::JointInParent(j) => match model.joints[j].kind {
                JointKind::Hinge | JointKind::Slide => true,
                JointKind::Ball | JointKind::Free => false,
            },
            Transmission::Tendon(t) => !model.tendons[t].is_spatial(),
            Transmission::Site(_)
            | Transmission::SiteInFrame(_)
            | Transmission::SliderCrank(_)
            | Transmission::Body(_)
            | Transmission::Rotation(_)
            | Transmission::RotationInFrame(_) => false,
        });
    let lifts = model.joints.iter().any(|joint| joint.actgravcomp);
    match straight && !lifts {
        true => 0,
        false => model.nbody(),
    }
}
