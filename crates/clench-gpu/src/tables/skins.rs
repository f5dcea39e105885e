//! Tactile skins: their vertices in the frames of their geoms, and the tangents there.

use super::Tables;
use crate::codes::row;
use clench_math::Vec3;
use clench_rigid::model::{Model, Sensor, SensorTarget};
use std::iter::repeat_n;

row! {
    /// The words of a skin.
    words SkinWords, "SKIN" {
        /// The geom in whose frame its vertices are.
        geom,
        /// Its first vertex among those of all skins, and their number.
        first,
        count,
        /// The offset of its numbers in `sensordata`.
        offset,
        /// The offsets of the vertices and of the tangents, two of each vertex; the number of vertices with tangents.
        points,
        tangents,
        tangent_count,
    }
}

/// Returns the sensors with skins, the mesh and the geom of each.
fn skins(m: &Model) -> impl Iterator<Item = (&Sensor, usize, usize)> {
    m.sensors.iter().filter_map(|sensor| match sensor.target {
        SensorTarget::Taxels { mesh, geom } => Some((sensor, mesh, geom)),
        SensorTarget::Nothing
        | SensorTarget::Element(_)
        | SensorTarget::Frame { .. }
        | SensorTarget::Inside { .. }
        | SensorTarget::Projection { .. }
        | SensorTarget::Rays { .. }
        | SensorTarget::Geoms(_)
        | SensorTarget::Contacts(_) => None,
    })
}

/// Returns the number of vertices of all skins.
pub(crate) fn taxel_count(m: &Model) -> usize {
    let counts = skins(m).map(|(_, mesh, _)| m.meshes[mesh].vertices.len());
    counts.sum()
}

/// Rounds vectors to single precision, in which MuJoCo stores them.
fn rounded(v: &Vec3<f64>) -> [f64; 3] {
    v.to_array().map(|x| f64::from(x as f32))
}

impl Tables {
    /// Adds skins. They follow all parameters, because environments share them.
    pub(crate) fn skins(&mut self, m: &Model) {
        self.row::<SkinWords>();
        let (mut rows, mut of_taxel) = (Vec::new(), Vec::new());
        for (k, (sensor, mesh, geom)) in skins(m).enumerate() {
            let mesh = &m.meshes[mesh];
            let tangents = mesh.tangents.iter().flatten();
            let row = SkinWords {
                geom,
                first: of_taxel.len(),
                count: mesh.vertices.len(),
                offset: sensor.numbers.start,
                points: self.add_numbers(mesh.vertices.iter().flat_map(rounded)),
                tangents: self.add_numbers(tangents.flat_map(rounded)),
                tangent_count: mesh.tangents.len(),
            };
            rows.extend(row.words());
            of_taxel.extend(repeat_n(k, mesh.vertices.len()));
        }
        self.count("NTAXEL", of_taxel.len());
        self.words("TAXEL_SKIN", of_taxel);
        self.words("SKINS", rows);
    }
}
