//! Elements and the user's own data by name, what to call elements that have no name, the body of an object, and what gives a geom its
//! shape.

use super::Model;
use super::custom::TupleEntry;
use super::sensor_target::FrameObject;
use clench_collide::{HeightField, Hull};

macro_rules! lookups {
    ($($(#[$doc:meta])* $method:ident in $elements:ident;)*) => {
        /// Each takes time proportional to the number of elements: look up once, keep the index.
        impl Model {
            $($(#[$doc])*
            pub fn $method(&self, name: &str) -> Option<usize> {
                self.$elements.iter().position(|e| !name.is_empty() && e.name == name)
            })*
        }
    };
}

lookups! {
    /// Index of the body of that name (`world` is the first).
    body in bodies;
    /// Index of the joint of that name.
    joint in joints;
    /// Index of the geom of that name.
    geom in geoms;
    /// Index of the site of that name.
    site in sites;
    /// Index of the camera of that name.
    camera in cameras;
    /// Index of the tendon of that name.
    tendon in tendons;
    /// Index of the actuator of that name.
    actuator in actuators;
    /// Index of the sensor of that name.
    sensor in sensors;
    /// Index of the equality constraint of that name.
    equality in equalities;
    /// Index of the keyframe of that name.
    keyframe in keyframes;
    /// Index of the mesh of that name.
    mesh in meshes;
    /// Index of the height field of that name.
    height_field in height_fields;
}

impl Model {
    /// What to call a geom where it is shown: its name, or else its body and its number among the geoms of that, as in `torso[1]`. A body
    /// without a name goes by its index, as in `body 3[0]`.
    ///
    /// # Panics
    /// If there is no such geom, as slices do.
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
    /// The body that carries it.
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
    /// The user's array of numbers with this name.
    pub fn numeric(&self, name: &str) -> Option<&[f64]> {
        named(&self.custom.numerics, name).map(Vec::as_slice)
    }

    /// The user's text with this name.
    pub fn text(&self, name: &str) -> Option<&str> {
        named(&self.custom.texts, name).map(String::as_str)
    }

    /// The user's list of elements with this name.
    pub fn tuple(&self, name: &str) -> Option<&[TupleEntry]> {
        named(&self.custom.tuples, name).map(Vec::as_slice)
    }
}

impl Model {
    /// The hull of a geom that is a mesh and may touch something.
    #[inline(always)]
    pub fn hull(&self, geom: usize) -> Option<&Hull> {
        let mesh = self.geoms[geom].mesh?;
        self.meshes[mesh].hull.as_ref()
    }
    /// The heights of a geom that is a height field.
    #[inline(always)]
    pub fn heights(&self, geom: usize) -> Option<&HeightField> {
        let field = self.geoms[geom].height_field?;
        Some(&self.height_fields[field].shape)
    }
}
