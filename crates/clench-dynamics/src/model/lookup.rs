//! Lookup of elements and of the user's own data by name, labels of unnamed elements, the body of an object, and the
//! shape data of geoms.

use super::Model;
use super::custom::TupleEntry;
use super::sensor_target::FrameObject;
use clench_collide::{HeightField, Hull};

macro_rules! lookups {
    ($($(#[$doc:meta])* $method:ident in $elements:ident;)*) => {
        /// Each lookup takes time proportional to the number of elements: look up once and store the index.
        impl Model {
            $($(#[$doc])*
            pub fn $method(&self, name: &str) -> Option<usize> {
                self.$elements.iter().position(|e| !name.is_empty() && e.name == name)
            })*
        }
    };
}

lookups! {
    /// Returns the index of the body with a name (`world` is the first).
    body in bodies;
    /// Returns the index of the joint with a name.
    joint in joints;
    /// Returns the index of the geom with a name.
    geom in geoms;
    /// Returns the index of the site with a name.
    site in sites;
    /// Returns the index of the camera with a name.
    camera in cameras;
    /// Returns the index of the tendon with a name.
    tendon in tendons;
    /// Returns the index of the actuator with a name.
    actuator in actuators;
    /// Returns the index of the sensor with a name.
    sensor in sensors;
    /// Returns the index of the equality constraint with a name.
    equality in equalities;
    /// Returns the index of the keyframe with a name.
    keyframe in keyframes;
    /// Returns the index of the mesh with a name.
    mesh in meshes;
    /// Returns the index of the height field with a name.
    height_field in height_fields;
}

impl Model {
    /// Returns the label of a geom: its name, or else its body and its index among that body's geoms, as in `torso[1]`.
    /// A body without a name is shown by its index, as in `body 3[0]`.
    ///
    /// # Panics
    /// Panics if there is no such geom.
    pub fn geom_label(&self, geom: usize) -> String {
        let found = &self.geoms[geom];
        if !found.name.is_empty() {
            return found.name.clone();
        }
        let body = &self.bodies[found.body];
        let number = geom - body.geoms.start;
        match body.name.as_str() {
            "" => format!("body {}[{number}]", found.body),
            name => format!("{name}[{number}]"),
        }
    }
}

impl FrameObject {
    /// Returns the body that carries it.
    #[inline(always)]
    pub fn body(self, model: &Model) -> usize {
        match self {
            FrameObject::Inertial(body) | FrameObject::Body(body) => body,
            FrameObject::Geom(geom) => model.geoms[geom].body,
            FrameObject::Site(site) => model.sites[site].body,
            FrameObject::Camera(camera) => model.cameras[camera].body,
        }
    }
}

fn named<'a, T>(list: &'a [(String, T)], name: &str) -> Option<&'a T> {
    let found = list.iter().find(|(other, _)| other == name);
    found.map(|(_, value)| value)
}

impl Model {
    /// Returns the user's array of numbers with a name.
    pub fn numeric(&self, name: &str) -> Option<&[f64]> {
        named(&self.custom.numerics, name).map(Vec::as_slice)
    }

    /// Returns the user's text with a name.
    pub fn text(&self, name: &str) -> Option<&str> {
        named(&self.custom.texts, name).map(String::as_str)
    }

    /// Returns the user's list of elements with a name.
    pub fn tuple(&self, name: &str) -> Option<&[TupleEntry]> {
        named(&self.custom.tuples, name).map(Vec::as_slice)
    }
}

impl Model {
    /// Returns the hull of a mesh geom that may collide.
    #[inline(always)]
    pub fn hull(&self, geom: usize) -> Option<&Hull> {
        let mesh = self.geoms[geom].mesh?;
        self.meshes[mesh].hull.as_ref()
    }
    /// Returns the height field of a geom that is one.
    #[inline(always)]
    pub fn heights(&self, geom: usize) -> Option<&HeightField> {
        let field = self.geoms[geom].height_field?;
        Some(&self.height_fields[field].shape)
    }
}
