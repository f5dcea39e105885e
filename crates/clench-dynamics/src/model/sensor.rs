//! What a model measures: the table of kinds of sensor, and the sensors of a model.

use super::History;
use super::sensor_target::SensorTarget;
use crate::model::Origin;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// What a kind of sensor is attached to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attachment {
    /// Nothing: it measures the whole simulation.
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
    /// A body, and all below it.
    Body,
    /// A frame of an object, and perhaps one relative to which it is measured.
    Frame,
    /// A frame, measured in the world alone.
    WorldFrame,
    /// A site, and an object that may be inside it.
    Inside,
    /// A site, and a camera that sees it.
    Projection,
    /// A site or a camera, from which rays go out.
    Rays,
    /// Two geoms, or all geoms of a body.
    Geoms,
    /// The contacts between two sides.
    Contacts,
    /// The vertices of a mesh in the frame of a geom.
    Taxels,
    /// Numbers of a user's program: it is zero here.
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

/// What the numbers of a sensor can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorData {
    /// Any numbers; a cutoff holds them between its negative and itself.
    Real,
    /// Numbers of at least zero, at most the cutoff.
    Positive,
    /// A unit vector; it has no cutoff.
    Axis,
    /// A unit quaternion; it has no cutoff.
    Quaternion,
}

/// The dimension of a sensor's numbers, with any power of time: what becomes of its cutoff and its noise where a file scales lengths and
/// masses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorDimension {
    /// Neither lengths nor masses, or lengths that are not scaled.
    None,
    /// A length.
    Length,
    /// A force.
    Force,
    /// A torque, or an angular momentum.
    Torque,
    /// That of a joint, tendon or actuator: a length or an angle.
    Coordinate,
    /// That of a force along such a coordinate.
    CoordinateForce,
}

macro_rules! sensor_kinds {
    ($($(#[$doc:meta])* $kind:ident $name:literal $attachment:ident $dim:literal $data:ident $dimension:ident;)*) => {
        /// Kinds of sensor. Numbers, frames and signs are MuJoCo's.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum SensorKind {
            $($(#[$doc])* $kind,)*
        }

        impl SensorKind {
            /// Every kind.
            pub const ALL: &[SensorKind] = &[$(SensorKind::$kind),*];

            /// Its name, which is that of its element in MJCF.
            pub fn name(self) -> &'static str {
                match self { $(SensorKind::$kind => $name,)* }
            }
            /// What it is attached to.
            pub fn attachment(self) -> Attachment {
                match self { $(SensorKind::$kind => Attachment::$attachment,)* }
            }
            /// How many numbers it gives; 0 where a sensor says so itself.
            pub fn dim(self) -> usize {
                match self { $(SensorKind::$kind => $dim,)* }
            }
            /// What its numbers can be.
            pub fn data(self) -> SensorData {
                match self { $(SensorKind::$kind => SensorData::$data,)* }
            }
            /// The dimension of its numbers.
            pub fn dimension(self) -> SensorDimension {
                match self { $(SensorKind::$kind => SensorDimension::$dimension,)* }
            }
        }
    };
}

sensor_kinds! {
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
    /// The same as a torque about the site, N m.
    Torque "torque" Site 3 Real Torque;
    /// The magnetic field in the site's frame.
    Magnetometer "magnetometer" Site 3 Real None;
    /// Where rays first meet a geom: one ray along a site's z axis, or one through each pixel of a camera.
    Rangefinder "rangefinder" Rays 0 Real Length;
    /// Where a camera sees a site, in pixels from the upper left corner of its picture.
    CamProjection "camprojection" Projection 2 Real None;
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
    /// Centre of mass of a body and all below it, m.
    SubtreeCom "subtreecom" Body 3 Real Length;
    /// Velocity of that, m/s.
    SubtreeLinVel "subtreelinvel" Body 3 Real Length;
    /// Angular momentum of a body and all below it about their centre of mass, kg m²/s.
    SubtreeAngMom "subtreeangmom" Body 3 Real Torque;
    /// 1 where an object's position is inside the site's volume, else 0; or, of one that is to be enclosed, how far it juts out of that volume,
    /// negative by its clearance where it lies inside, m.
    InsideSite "insidesite" Inside 1 Positive None;
    /// Smallest signed distance of two geoms or sets of geoms, at most the cutoff, m.
    Distance "distance" Geoms 1 Real Length;
    /// The direction from the first to the second along which that is measured; zero where they are further apart.
    Normal "normal" Geoms 3 Axis Length;
    /// The nearest points of both; zero where they are further apart, m.
    FromTo "fromto" Geoms 6 Real Length;
    /// What contacts between two sides are and do: a fixed number of them, zeros where there are fewer.
    Contact "contact" Contacts 0 Real None;
    /// How deep each vertex of a mesh in a geom's frame is in what touches the geom's body, m; then how fast each slides there along
    /// its first tangent, and along its second, m/s.
    Tactile "tactile" Taxels 0 Real None;
    /// Potential energy, J.
    PotentialEnergy "e_potential" Nothing 1 Real None;
    /// Kinetic energy, J.
    KineticEnergy "e_kinetic" Nothing 1 Real None;
    /// Time, s.
    Clock "clock" Nothing 1 Real None;
    /// What a user's own program measures; zero here.
    User "user" User 0 Real None;
}

impl SensorKind {
    /// The kind of that name.
    pub fn find(name: &str) -> Option<Self> {
        let mut kinds = SensorKind::ALL.iter().copied();
        kinds.find(|kind| kind.name() == name)
    }
}

/// A sensor.
#[derive(Clone, Debug)]
pub struct Sensor {
    /// Name, possibly empty.
    pub name: String,
    /// What it measures.
    pub kind: SensorKind,
    /// Of what.
    pub target: SensorTarget,
    /// What its numbers can be.
    pub data: SensorData,
    /// Bound of its numbers, where positive.
    pub cutoff: f64,
    /// Standard deviation of the noise that the author expects; none is added.
    pub noise: f64,
    /// Where its numbers are in `sensordata`.
    pub numbers: Range<usize>,
    /// The buffer of its past values.
    pub history: Option<History>,
    /// When a sensor that measures periodically did so last before time zero, s; zero: one period before.
    pub phase: f64,
    /// The user's own numbers, as many for each element of its kind.
    pub user: Arc<[f64]>,
    /// Where it was written.
    pub origin: Option<Origin>,
}
