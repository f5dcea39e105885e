//! The solids of sensors of enclosure: the volume of a site, then those that may protrude from it.

use super::Tables;
use super::frames::Frame;
use crate::codes::{Code, row};
use clench_math::{Quat, Vec3};
use clench_rigid::model::{FrameObject, Model, Sensor, SensorTarget};
use clench_rigid::settings::StepSettings;

row! {
    /// The words of a solid.
    words SolidWords, "SOLID" {
        /// The kind of its frame, a geom's or a site's, and its index.
        frame,
        index,
        /// Its shape.
        kind,
        /// The offset of the position and the orientation of the shape in that frame.
        place,
        /// The points of a mesh, in the frame of the shape: their offset and their number.
        points,
        point_count,
    }
}

/// A geom or a site.
#[derive(Clone, Copy)]
enum Solid {
    Geom(usize),
    Site(usize),
}

impl Solid {
    fn size(self, m: &Model) -> [f64; 3] {
        let size = match self {
            Solid::Geom(g) => m.params.geom_size[g],
            Solid::Site(s) => m.params.site_size[s],
        };
        size.to_array()
    }

    /// Returns the position and the orientation of the shape: in a site a mesh has its original coordinates.
    fn place(self, m: &Model) -> (Vec3<f64>, Quat<f64>) {
        let mesh = match self {
            Solid::Geom(_) => None,
            Solid::Site(s) => m.sites[s].mesh.map(|mesh| &m.meshes[mesh]),
        };
        let in_frame = (Vec3::ZERO, Quat::IDENTITY);
        mesh.map_or(in_frame, |mesh| (mesh.pos, mesh.quat))
    }

    /// Returns the points whose extents are those of a mesh: the corners of its hull, or all vertices of a flat one.
    fn points(self, m: &Model) -> Vec<Vec3<f64>> {
        match self {
            Solid::Geom(g) => m.geoms[g].mesh.map_or(Vec::new(), |mesh| {
                let mesh = &m.meshes[mesh];
                let corners = mesh.any_hull().map(|hull| hull.vertices().to_vec());
                corners.unwrap_or_else(|| mesh.vertices.clone())
            }),
            Solid::Site(s) => m.sites[s].mesh.map_or(Vec::new(), |mesh| {
                let corners = m.meshes[mesh].hull.iter().flat_map(|hull| hull.vertices());
                corners.copied().collect()
            }),
        }
    }
}

/// Returns the solids of a sensor, first the volume of its site; none if it is not one of enclosure.
fn solids_of(m: &Model, sensor: &Sensor) -> Vec<Solid> {
    let &SensorTarget::Inside {
        site,
        object,
        enclosed: true,
    } = &sensor.target
    else {
        return Vec::new();
    };
    let inner = match object {
        FrameObject::Site(inner) => Some(Solid::Site(inner)),
        FrameObject::Inertial(_)
        | FrameObject::Body(_)
        | FrameObject::Geom(_)
        | FrameObject::Camera(_) => None,
    };
    let geoms = object.enclosed_geoms(m).map(Solid::Geom);
    let all = [Solid::Site(site)].into_iter().chain(inner);
    all.chain(geoms).collect()
}

/// Returns the number of solids of a sensor.
pub(super) fn solid_count(m: &Model, sensor: &Sensor) -> usize {
    solids_of(m, sensor).len()
}

/// Returns the solids of all sensors.
fn all_solids(m: &Model) -> Vec<Solid> {
    let each = m.sensors.iter();
    each.flat_map(|sensor| solids_of(m, sensor)).collect()
}

impl Tables {
    /// Adds the sizes of solids, and the limits of the search for protrusions.
    pub(super) fn solids(&mut self, m: &Model, s: &StepSettings) {
        self.row::<SolidWords>();
        let solids = all_solids(m);
        self.fixed_flag("ANY_ENCLOSED", !solids.is_empty());
        self.count("ASCENT_STEPS", s.ccd_iterations.max(1));
        self.real("ASCENT_TOLERANCE", s.ccd_tolerance);
        let sizes = solids.iter().flat_map(|solid| solid.size(m));
        self.numbers("SOLID_EXTENTS", sizes);
    }

    /// Adds the solids and the points of their meshes. They follow all parameters, because environments share them.
    pub(crate) fn solid_shapes(&mut self, m: &Model) {
        let mut rows = Vec::new();
        for solid in all_solids(m) {
            let points = solid.points(m);
            let (position, quat) = solid.place(m);
            let place = position.to_array().into_iter().chain(quat.to_array());
            let (frame, index, kind) = match solid {
                Solid::Geom(g) => (Frame::Geom, g, m.geoms[g].kind),
                Solid::Site(s) => (Frame::Site, s, m.sites[s].kind),
            };
            let row = SolidWords {
                frame: frame.code(),
                index,
                kind: kind.code(),
                place: self.add_numbers(place),
                points: self.add_numbers(points.iter().flat_map(|point| point.to_array())),
                point_count: points.len(),
            };
            rows.extend(row.words());
        }
        self.words("SOLIDS", rows);
    }
}
