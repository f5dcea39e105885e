//! Pairs of geoms whose distance a sensor measures. They follow the pairs that collide, have the sensor's cutoff as
//! their contact range, and have one contact each, the deepest.

use crate::methods::method_of_pair;
use clench_rigid::contact::Candidate;
use clench_rigid::model::{Model, Sensor, SensorTarget};

/// A pair of geoms whose distance a sensor measures.
pub(super) struct Measured {
    /// The geoms.
    pub pair: Candidate,
    /// True if the sensor's first geom is the second of the pair.
    pub turned: bool,
    /// The maximum distance, m.
    pub cutoff: f64,
}

/// Returns the pairs of a distance sensor, in its order, without unsupported shapes.
pub(super) fn pairs_of(m: &Model, sensor: &Sensor) -> Vec<Measured> {
    let SensorTarget::Geoms([first, second]) = &sensor.target else {
        return Vec::new();
    };
    let measured = |a: usize, b: usize| {
        let turned = m.geoms[a].kind > m.geoms[b].kind;
        let geoms = if turned { [b, a] } else { [a, b] };
        Measured {
            pair: Candidate {
                geoms: geoms.map(|g| g as u32),
                kinds: geoms.map(|g| m.geoms[g].kind),
                pair: None,
            },
            turned,
            cutoff: sensor.cutoff.max(0.0),
        }
    };
    let pairs = first
        .clone()
        .flat_map(|a| second.clone().map(move |b| measured(a, b)));
    let has_distance = |m: &Measured| method_of_pair(m.pair.kinds).is_some();
    pairs.filter(has_distance).collect()
}

/// Returns the pairs of all sensors, one after another.
pub(super) fn measured(m: &Model) -> Vec<Measured> {
    m.sensors.iter().flat_map(|s| pairs_of(m, s)).collect()
}
