//! The targets of sensors, by the indices of elements.

use super::Model;
use std::ops::Range;

/// A frame that a sensor measures or uses as reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameObject {
    /// The inertial frame of a body.
    Inertial(usize),
    /// The frame of a body.
    Body(usize),
    /// The frame of a geom.
    Geom(usize),
    /// A site.
    Site(usize),
    /// A camera.
    Camera(usize),
}

impl FrameObject {
    /// Returns the geoms of this object, for measurements of its volume: itself, those of a body, or those of a body
    /// and its descendants.
    pub fn enclosed_geoms(self, model: &Model) -> impl Iterator<Item = usize> {
        let bodies = match self {
            FrameObject::Inertial(body) => body..body + 1,
            FrameObject::Body(body) => model.subtree(body),
            FrameObject::Geom(_) | FrameObject::Site(_) | FrameObject::Camera(_) => 0..0,
        };
        let own = match self {
            FrameObject::Geom(geom) => Some(geom),
            FrameObject::Inertial(_)
            | FrameObject::Body(_)
            | FrameObject::Site(_)
            | FrameObject::Camera(_) => None,
        };
        let geoms = bodies.flat_map(|body| model.bodies[body].geoms.clone());
        geoms.chain(own)
    }
}

/// The source of the rays of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaySource {
    /// One ray along the z axis of a site.
    Site(usize),
    /// A ray through the middle of each pixel of a camera, line by line from the upper left corner.
    Camera(usize),
}

macro_rules! fields {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $field:ident $word:literal $size:literal;)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum $name {
            $($(#[$variant_doc])* $field,)*
        }

        impl $name {
            /// All fields, in their order in `sensordata`.
            pub const ALL: &[$name] = &[$($name::$field),*];

            /// Returns its name in MJCF.
            pub fn name(self) -> &'static str {
                match self { $($name::$field => $word,)* }
            }
            /// Returns the number of its values.
            pub fn size(self) -> usize {
                match self { $($name::$field => $size,)* }
            }
        }
    };
}

fields! {
    /// A quantity that a sensor reports for each ray.
    RayField {
        /// Distance to the nearest geom, −1 where there is none, m.
        Dist "dist" 1;
        /// Unit vector along the ray, zero if it hits nothing.
        Dir "dir" 3;
        /// The start of the ray, m.
        Origin "origin" 3;
        /// The hit point, zero if it hits nothing, m.
        Point "point" 3;
        /// Outward unit normal of the geom there, zero if the ray hits nothing.
        Normal "normal" 3;
        /// Distance of that point from the plane of the camera, −1 where there is none, m.
        Depth "depth" 1;
    }
}

fields! {
    /// A quantity that a sensor reports for each contact.
    ContactField {
        /// The number of matching contacts, 0 if there is none.
        Found "found" 1;
        /// Force on the second side in the frame of the contact, N.
        Force "force" 3;
        /// Torque on the second side likewise, N m.
        Torque "torque" 3;
        /// Signed distance, negative in penetration, m.
        Dist "dist" 1;
        /// Midpoint between the surfaces, m.
        Pos "pos" 3;
        /// Unit vector from the first side to the second.
        Normal "normal" 3;
        /// First tangent; the second is normal × tangent.
        Tangent "tangent" 3;
        /// Velocity of the second side relative to the first, in the frame of the contact, m/s.
        LinVel "linvel" 3;
        /// Angular velocity likewise, rad/s.
        AngVel "angvel" 3;
    }
}

/// The selection among the matching contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactReduction {
    /// The first ones.
    None,
    /// The deepest ones, the deepest first.
    MinDist,
    /// Those with the largest forces, the largest first.
    MaxForce,
    /// One contact in world axes, equivalent to all of them together.
    NetForce,
}

/// One side of a contact.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ContactSide {
    /// Any geom.
    Any,
    /// A geom.
    Geom(usize),
    /// Any geom of a body.
    Body(usize),
    /// Any geom of these bodies.
    Subtree(Range<usize>),
}

/// The contacts that a sensor selects, and the quantities that it reports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ContactQuery {
    /// The two sides; the normal points from the first to the second.
    pub sides: [ContactSide; 2],
    /// A site whose volume the contact's position must be in.
    pub site: Option<usize>,
    /// The quantities reported for each contact, in order.
    pub fields: Vec<ContactField>,
    /// The selection among the contacts.
    pub reduction: ContactReduction,
    /// The number of reported contacts.
    pub count: usize,
}

impl ContactQuery {
    /// Returns the number of values per contact.
    pub fn size(&self) -> usize {
        self.fields.iter().map(|field| field.size()).sum()
    }
}

/// The target of a sensor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SensorTarget {
    /// The whole simulation, or a quantity of a user's program.
    Nothing,
    /// An element, of the kind that the sensor's [`Attachment`](super::Attachment) names.
    Element(usize),
    /// A frame, and a reference frame (else the world).
    Frame {
        /// The measured frame.
        object: FrameObject,
        /// The reference frame.
        reference: Option<FrameObject>,
    },
    /// An object that may be inside a site.
    Inside {
        /// The site.
        site: usize,
        /// The object.
        object: FrameObject,
        /// False if the sensor tests if the object's position is inside, true if it measures how far the object
        /// protrudes. Then the object is not a camera; of a body, the geoms are measured (`Inertial`), or those of the
        /// subtree (`Body`).
        enclosed: bool,
    },
    /// The image of a site in a camera.
    Projection {
        /// The site.
        site: usize,
        /// The camera.
        camera: usize,
    },
    /// Ray hits.
    Rays {
        /// The source of the rays.
        source: RaySource,
        /// The quantities reported for each ray, in order.
        fields: Vec<RayField>,
    },
    /// Two sets of geoms.
    Geoms([Range<usize>; 2]),
    /// Contacts.
    Contacts(ContactQuery),
    /// The contact of the vertices of a mesh.
    Taxels {
        /// The mesh.
        mesh: usize,
        /// The geom whose frame is that of the vertices.
        geom: usize,
    },
}

/// The number of values that a tactile sensor reports for a vertex: the depth, and speeds along two tangents.
pub const TAXEL_CHANNELS: usize = 3;
