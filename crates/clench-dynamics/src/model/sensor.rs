//! Sensors: the table of sensor kinds, and the sensors of a model.

use super::History;
use super::sensor_target::SensorTarget;
use crate::model::Origin;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// The element that a kind of sensor is attached to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attachment {
    /// The whole simulation.
    Nothing,
    /// A site.
    Site,
    /// A slide or hinge joint.
    ScalarJoint,
    /// A ball joint.
    Ball,
    /// Any joint.
    Joint,
    /// A tendon.
    Tendon,
    /// An actuator.
    Actuator,
    /// A body and its descendants.
    Body,
    /// A frame of an object, and an optional reference frame.
    Frame,
    /// A frame, measured only relative to the world.
    WorldFrame,
    /// A site, and an object that may be inside it.
    Inside,
    /// A site, and a camera that sees it.
    Projection,
    /// A site or a camera that emits rays.
    Rays,
    /// Two geoms, or all geoms of a body.
    Geoms,
    /// The contacts between two sides.
    Contacts,
    /// The vertices of a mesh in the frame of a geom.
    Taxels,
    /// Data of a user's program; zero here.
    User,
}

impl fmt::Display for Attachment {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Attachment::Nothing => "nothing",
            Attachment::Site => "a site",
            Attachment::ScalarJoint => "a slide or hinge joint",
            Attachment::Ball => "a ball joint",
            Attachment::Joint => "a joint",
            Attachment::Tendon => "a tendon",
            Attachment::Actuator => "an actuator",
            Attachment::Body => "a body",
            Attachment::Frame | Attachment::WorldFrame => "a frame",
            Attachment::Inside => "a site and an object",
            Attachment::Projection => "a site and a camera",
            Attachment::Rays => "a site or a camera",
            Attachment::Geoms => "two geoms or bodies",
            Attachment::Contacts => "two sides of contacts",
            Attachment::Taxels => "a mesh and a geom",
            Attachment::User => "numbers of a user's own",
        })
    }
}

/// The range of the numbers of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorData {
    /// Any numbers; a cutoff clamps them to ± its value.
    Real,
    /// Numbers from zero to the cutoff.
    Positive,
    /// A unit vector; it has no cutoff.
    Axis,
    /// A unit quaternion; it has no cutoff.
    Quaternion,
}

/// The dimension of a sensor's numbers, with any power of time. It determines the scaling of cutoff and noise if a file
/// scales lengths and masses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorDimension {
    /// Without lengths and masses, or with lengths that are not scaled.
    None,
    /// A length.
    Length,
    /// A force.
    Force,
    /// A torque, or an angular momentum.
    Torque,
    /// A joint, tendon or actuator coordinate: a length or an angle.
    Coordinate,
    /// A force along such a coordinate.
    CoordinateForce,
}

/// Declares the kinds, in groups by the code that reads them.
macro_rules! sensor_kinds {
    ($($group:ident {$(
        $(#[$doc:meta])* $kind:ident $name:literal $attachment:ident $dim:literal $data:ident $dimension:ident;
    )*})*) => {
        /// The kinds of sensor. Numbers, frames and signs are MuJoCo's.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum SensorKind {
            $($($(#[$doc])* $kind,)*)*
        }

        impl SensorKind {
            /// Every kind.
            pub const ALL: &[SensorKind] = &[$($(SensorKind::$kind),*),*];

            /// Returns its name, which is that of its element in MJCF.
            pub fn name(self) -> &'static str {
                match self { $($(SensorKind::$kind => $name,)*)* }
            }
            /// Returns the element that it is attached to.
            pub fn attachment(self) -> Attachment {
                match self { $($(SensorKind::$kind => Attachment::$attachment,)*)* }
            }
            /// Returns the number of values; 0 if it depends on the sensor.
            pub fn dim(self) -> usize {
                match self { $($(SensorKind::$kind => $dim,)*)* }
            }
            /// Returns the range of its numbers.
            pub fn data(self) -> SensorData {
                match self { $($(SensorKind::$kind => SensorData::$data,)*)* }
            }
            /// Returns the dimension of its numbers.
            pub fn dimension(self) -> SensorDimension {
                match self { $($(SensorKind::$kind => SensorDimension::$dimension,)*)* }
            }
        }

        /// The pattern of the kinds of a group, so that a match names every kind.
        #[doc(hidden)]
        #[macro_export]
        macro_rules! sensor_group {
            $(($group) => { $(SensorKind::$kind)|* };)*
        }
    };
}

sensor_kinds! {
    element {
        /// Sum of the normal forces of contacts of the site's body within the site's volume, N.
        Touch "touch" Site 1 Positive Force;
        /// Linear acceleration with gravity's upward reaction, in the site's frame, m/s².
        Accelerometer "accelerometer" Site 3 Real Length;
        /// Linear velocity in the site's frame, m/s.
        Velocimeter "velocimeter" Site 3 Real Length;
        /// Angular velocity in the site's frame, rad/s.
        Gyro "gyro" Site 3 Real None;
        /// Force of the site's body on its parent through their joints, in the site's frame, N.
        Force "force" Site 3 Real Force;
        /// The torque likewise, about the site, N m.
        Torque "torque" Site 3 Real Torque;
        /// The magnetic field in the site's frame.
        Magnetometer "magnetometer" Site 3 Real None;
        /// Position of a slide or hinge joint, m or rad.
        JointPos "jointpos" ScalarJoint 1 Real Coordinate;
        /// Its velocity.
        JointVel "jointvel" ScalarJoint 1 Real Coordinate;
        /// Actuator force along its dof, gravity compensation included where it counts as actuation, N or N m.
        JointActuatorFrc "jointactuatorfrc" ScalarJoint 1 Real CoordinateForce;
        /// Orientation of a ball joint.
        BallQuat "ballquat" Ball 4 Quaternion None;
        /// Its angular velocity in the child's frame, rad/s.
        BallAngVel "ballangvel" Ball 3 Real None;
        /// Distance of a joint to its limit less the margin; zero where no limit acts.
        JointLimitPos "jointlimitpos" Joint 1 Real Coordinate;
        /// Its rate of change.
        JointLimitVel "jointlimitvel" Joint 1 Real Coordinate;
        /// The limit's force.
        JointLimitFrc "jointlimitfrc" Joint 1 Real CoordinateForce;
        /// Length of a tendon, m.
        TendonPos "tendonpos" Tendon 1 Real Coordinate;
        /// Its velocity, m/s.
        TendonVel "tendonvel" Tendon 1 Real Coordinate;
        /// Total force of its actuators, N.
        TendonActuatorFrc "tendonactuatorfrc" Tendon 1 Real CoordinateForce;
        /// Distance of a tendon to its limit less the margin; zero where no limit acts.
        TendonLimitPos "tendonlimitpos" Tendon 1 Real Coordinate;
        /// Its rate of change.
        TendonLimitVel "tendonlimitvel" Tendon 1 Real Coordinate;
        /// The limit's force.
        TendonLimitFrc "tendonlimitfrc" Tendon 1 Real CoordinateForce;
        /// Length of an actuator's transmission.
        ActuatorPos "actuatorpos" Actuator 1 Real Coordinate;
        /// Its velocity.
        ActuatorVel "actuatorvel" Actuator 1 Real Coordinate;
        /// The actuator's force.
        ActuatorFrc "actuatorfrc" Actuator 1 Real CoordinateForce;
        /// Centre of mass of a body and its descendants, m.
        SubtreeCom "subtreecom" Body 3 Real Length;
        /// Velocity of that, m/s.
        SubtreeLinVel "subtreelinvel" Body 3 Real Length;
        /// Angular momentum of a body and its descendants about their centre of mass, kg m²/s.
        SubtreeAngMom "subtreeangmom" Body 3 Real Torque;
    }
    frame {
        /// Position of a frame, m.
        FramePos "framepos" Frame 3 Real Length;
        /// Its orientation.
        FrameQuat "framequat" Frame 4 Quaternion None;
        /// Its x axis.
        FrameXAxis "framexaxis" Frame 3 Axis None;
        /// Its y axis.
        FrameYAxis "frameyaxis" Frame 3 Axis None;
        /// Its z axis.
        FrameZAxis "framezaxis" Frame 3 Axis None;
        /// Its linear velocity, m/s.
        FrameLinVel "framelinvel" Frame 3 Real Length;
        /// Its angular velocity, rad/s.
        FrameAngVel "frameangvel" Frame 3 Real None;
        /// Its linear acceleration with gravity's upward reaction, world axes, m/s².
        FrameLinAcc "framelinacc" WorldFrame 3 Real Length;
        /// Its angular acceleration, world axes, rad/s².
        FrameAngAcc "frameangacc" WorldFrame 3 Real None;
    }
    geoms {
        /// Smallest signed distance of two geoms or sets of geoms, at most the cutoff, m.
        Distance "distance" Geoms 1 Real Length;
        /// The direction from the first to the second of that distance; zero beyond the cutoff.
        Normal "normal" Geoms 3 Axis Length;
        /// The nearest points of both; zero beyond the cutoff, m.
        FromTo "fromto" Geoms 6 Real Length;
    }
    others {
        /// The first hits of rays with a geom: one ray along a site's z axis, or one through each pixel of a camera.
        Rangefinder "rangefinder" Rays 0 Real Length;
        /// Image position of a site in a camera, in pixels from the upper left corner of the picture.
        CamProjection "camprojection" Projection 2 Real None;
        /// 1 if an object's position is inside the site's volume, else 0. With `enclosed`: the distance by which the
        /// object protrudes from the volume, or the negative of its clearance inside, m.
        InsideSite "insidesite" Inside 1 Positive None;
        /// Data of contacts between two sides: a fixed number of contacts, zeros if there are fewer.
        Contact "contact" Contacts 0 Real None;
        /// Penetration depth of each vertex of a mesh in a geom's frame into objects that touch the geom's body, m;
        /// then its sliding velocity there along its first tangent, and along its second, m/s.
        Tactile "tactile" Taxels 0 Real None;
    }
    whole {
        /// Potential energy, J.
        PotentialEnergy "e_potential" Nothing 1 Real None;
        /// Kinetic energy, J.
        KineticEnergy "e_kinetic" Nothing 1 Real None;
        /// Time, s.
        Clock "clock" Nothing 1 Real None;
        /// Measurement of a user's own program; zero here.
        User "user" User 0 Real None;
    }
}

impl SensorKind {
    /// Returns the kind with a name.
    pub fn find(name: &str) -> Option<Self> {
        let mut kinds = SensorKind::ALL.iter().copied();
        kinds.find(|kind| kind.name() == name)
    }

    /// Returns true if it reads accelerations of bodies or forces between them, which other sensors do not need.
    pub fn needs_body_forces(self) -> bool {
        matches!(
            self,
            SensorKind::Accelerometer
                | SensorKind::Force
                | SensorKind::Torque
                | SensorKind::FrameLinAcc
                | SensorKind::FrameAngAcc
        )
    }
}

/// A sensor.
#[derive(Clone, Debug)]
pub struct Sensor {
    /// Name, possibly empty.
    pub name: String,
    /// The kind.
    pub kind: SensorKind,
    /// The measured element.
    pub target: SensorTarget,
    /// The range of its numbers.
    pub data: SensorData,
    /// Limit of its numbers, if positive.
    pub cutoff: f64,
    /// Standard deviation of the noise that the author expects; none is added.
    pub noise: f64,
    /// The range of its numbers in `sensordata`.
    pub numbers: Range<usize>,
    /// The buffer of its past values.
    pub history: Option<History>,
    /// Time of the last measurement before time zero of a periodic sensor, s; zero: one period before.
    pub phase: f64,
    /// The user's own numbers; equally many for each sensor.
    pub user: Arc<[f64]>,
    /// The source location.
    pub origin: Option<Origin>,
}
