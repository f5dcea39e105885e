//! What sensors measure, by the numbers of elements.

use super::Model;
use std::ops::Range;

/// A frame that a sensor measures, or relative to which it does.
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
    /// The geoms that count as this object where its extent matters: itself, those of a body, or those of a body and all below it.
    pub fn enclosed_geoms(self, model: &Model) -> impl Iterator<Item = usize> {
        let bodies = match self {
            FrameObject::Inertial(body) => body..body + 1,
            FrameObject::Body(body) => model.subtree(body),
            FrameObject::Geom(_) | FrameObject::Site(_) | FrameObject::Camera(_) => 0..0,
        };
        let own = match self {
            FrameObject::Geom(geom) => Some(geom),
            _ => None,
        };
        let geoms = bodies.flat_map(|body| model.bodies[body].geoms.clone());
        geoms.chain(own)
    }
}

/// Where the rays of a sensor go out.
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
            /// All of them, in the order in which they stand in `sensordata`.
            pub const ALL: &[$name] = &[$($name::$field),*];

            /// Its name in MJCF.
            pub fn name(self) -> &'static str {
                match self { $($name::$field => $word,)* }
            }
            /// How many numbers it is.
            pub fn size(self) -> usize {
                match self { $($name::$field => $size,)* }
            }
        }
    };
}

fields! {
    /// What a sensor tells of each ray.
    RayField {
        /// Distance to the nearest geom, −1 where there is none, m.
        Dist "dist" 1;
        /// Unit vector along the ray, zero where it meets nothing.
        Dir "dir" 3;
        /// Where the ray begins, m.
        Origin "origin" 3;
        /// Where it meets the geom, zero where it meets nothing, m.
        Point "point" 3;
        /// Unit vector out of the geom there, zero where it meets nothing.
        Normal "normal" 3;
        /// Distance of that point from the plane of the camera, −1 where there is none, m.
        Depth "depth" 1;
    }
}

fields! {
    /// What a sensor tells of each contact.
    ContactField {
        /// How many contacts match, 0 where there is none.
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

/// Which of the contacts that match a sensor tells of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactReduction {
    /// The first ones.
    None,
    /// The deepest ones, the deepest first.
    MinDist,
    /// Those with the largest forces, the largest first.
    MaxForce,
    /// One contact in world axes that does what all of them do together.
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

/// Which contacts a sensor looks for, and what it tells of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ContactQuery {
    /// What touches; the normal points from the first to the second.
    pub sides: [ContactSide; 2],
    /// A site whose volume the contact's position must be in.
    pub site: Option<usize>,
    /// What is told of each contact, in order.
    pub fields: Vec<ContactField>,
    /// Which contacts are told of.
    pub reduction: ContactReduction,
    /// How many.
    pub count: usize,
}

impl ContactQuery {
    /// How many numbers are told of each contact.
    pub fn size(&self) -> usize {
        self.fields.iter().map(|field| field.size()).sum()
    }
}

/// What a sensor measures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SensorTarget {
    /// The whole simulation, or what only a user's program knows.
    Nothing,
    /// An element, of the kind that the sensor's [`Attachment`](super::Attachment) names.
    Element(usize),
    /// A frame, and one relative to which it is measured (else the world).
    Frame {
        /// What is measured.
        object: FrameObject,
        /// Where from.
        reference: Option<FrameObject>,
    },
    /// Whether an object is inside a site.
    Inside {
        /// The site.
        site: usize,
        /// The object.
        object: FrameObject,
        /// Whether its whole extent counts: how far it juts out is measured, rather than whether its position is inside. It is then no
        /// camera; of a body it is the geoms, with `Inertial` the body's own, with `Body` those of all below it too.
        enclosed: bool,
    },
    /// Where a camera sees a site.
    Projection {
        /// The site.
        site: usize,
        /// The camera.
        camera: usize,
    },
    /// What rays meet.
    Rays {
        /// Where they go out.
        source: RaySource,
        /// What is told of each, in order.
        fields: Vec<RayField>,
    },
    /// Two sets of geoms.
    Geoms([Range<usize>; 2]),
    /// Contacts.
    Contacts(ContactQuery),
    /// What the vertices of a mesh feel.
    Taxels {
        /// The mesh.
        mesh: usize,
        /// The geom in whose frame its vertices stand.
        geom: usize,
    },
}

/// The number of values that a tactile sensor reports for a vertex: the depth, and speeds along two tangents.
pub const TAXEL_CHANNELS: usize = 3;
