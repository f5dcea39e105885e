//! What sensors give.

use crate::model::{Model, SensorKind};
use clench_math::{Force, Motion, Real};

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
    pub bodies: BodyForces<T>,
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
pub fn keeps_past(model: &Model) -> bool {
    model.sensors.iter().any(|sensor| sensor.history.is_some())
}

/// Accelerations of bodies, and what their joints carry.
#[derive(Clone, Debug)]
pub struct BodyForces<T> {
    /// Spatial accelerations about the centre of mass of each body's tree, gravity's upward reaction included (nbody).
    pub cacc: Vec<Motion<T>>,
    /// Force of each body's parent on it through their joints, about the same point (nbody).
    pub cfrc_int: Vec<Force<T>>,
    /// What acts on each body from outside, six numbers a body.
    pub external: Vec<T>,
}

impl<T: Real> BodyForces<T> {
    /// Room for the bodies of a model that has sensors of them; else none.
    pub fn new(model: &Model) -> Self {
        let mut bodies = BodyForces::default();
        if model.sensors.iter().any(|sensor| is_needed(sensor.kind)) {
            bodies.make_room(model.nbody());
        }
        bodies
    }

    /// Makes room for a number of bodies.
    pub fn make_room(&mut self, count: usize) {
        self.cacc.resize(count, Motion::ZERO);
        self.cfrc_int.resize(count, Force::ZERO);
        self.external.clear();
        self.external.reserve(6 * count);
    }
}

impl<T> Default for BodyForces<T> {
    fn default() -> Self {
        BodyForces {
            cacc: Vec::new(),
            cfrc_int: Vec::new(),
            external: Vec::new(),
        }
    }
}

/// Whether a kind of sensor reads accelerations or forces of bodies.
pub fn is_needed(kind: SensorKind) -> bool {
    matches!(
        kind,
        SensorKind::Accelerometer
            | SensorKind::Force
            | SensorKind::Torque
            | SensorKind::FrameLinAcc
            | SensorKind::FrameAngAcc
    )
}
