//! Sensor readings.

use crate::model::Model;
use clench_math::{Force, Motion, Real};

/// The sensor readings and the data that they are computed from.
#[derive(Clone, Debug)]
pub struct SensorReadings<T> {
    /// True if they are read; else they are not computed.
    pub wanted: bool,
    /// The readings, sensor after sensor (nsensordata).
    pub data: Vec<T>,
    /// The readings before any delay; empty if no sensor stores past values.
    pub measured: Vec<T>,
    /// Accelerations of bodies and forces between them, if requested.
    pub bodies: BodyForces<T>,
}

impl<T: Real> SensorReadings<T> {
    /// Returns zero readings.
    #[cold] // Compiled for size.
    #[inline(never)]
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

/// Returns true if any sensor stores past values.
pub fn keeps_past(model: &Model) -> bool {
    model.sensors.iter().any(|sensor| sensor.history.is_some())
}

/// Accelerations of bodies, and the forces in their joints.
#[derive(Clone, Debug)]
pub struct BodyForces<T> {
    /// Spatial accelerations about the centre of mass of each body's tree, including gravity's upward reaction (nbody).
    pub cacc: Vec<Motion<T>>,
    /// Force of each body's parent on it through their joints, about the same point (nbody).
    pub cfrc_int: Vec<Force<T>>,
    /// External forces on each body, six numbers per body.
    pub external: Vec<T>,
}

impl<T: Real> BodyForces<T> {
    /// Allocates the arrays if the model has sensors that read them; else they are empty.
    #[cold] // Compiled for size.
    #[inline(never)]
    pub fn new(model: &Model) -> Self {
        let mut bodies = BodyForces::default();
        if model
            .sensors
            .iter()
            .any(|sensor| sensor.kind.needs_body_forces())
        {
            bodies.allocate(model.nbody());
        }
        bodies
    }

    /// Allocates the arrays for `count` bodies.
    pub fn allocate(&mut self, count: usize) {
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
