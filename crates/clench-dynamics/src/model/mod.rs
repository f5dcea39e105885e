//! The immutable description of a model: structure here, numbers in [`Params`].
//!
//! Structure determines loops and branches and is the same for every environment: the parent of each body, the kind of
//! each joint, the geoms that may collide. Numbers (masses, lengths, stiffnesses) are in [`Params`], so that each
//! environment of a batch can have its own.

mod custom;
mod element_numbers;
mod fields;
pub(crate) mod flat;
mod lookup;
mod params;
mod rule;
mod same_frame;
mod sensor;
mod sensor_target;
mod structure;

pub use custom::{Custom, TupleEntry};
pub use params::{ParamField, Params};
pub use same_frame::SameFrames;
pub use sensor::{Attachment, Sensor, SensorData, SensorDimension, SensorKind};
pub use sensor_target::{
    ContactField, ContactQuery, ContactReduction, ContactSide, FrameObject, RayField, RaySource,
    SensorTarget, TAXEL_CHANNELS,
};
pub use structure::{
    Actuator, Appearance, BiasKind, Body, Camera, CameraMode, ControlInput, ControllerStates,
    Coupled, Dof, DynamicsKind, Equality, EqualityTarget, Flags, GainKind, Geom, Headlight,
    HeightField, History, Integrator, Interpolation, Joint, JointKind, Keyframe, KinematicTree,
    Light, LightKind, LightProperties, Material, Mesh, MeshInertia, MeshSpec, Origin, Pair,
    Pattern, Pixels, RowPattern, Section, Site, SleepPolicy, Tendon, Texture, TextureKind,
    TextureMark, TexturePattern, TexturePicture, Transmission, Visuals, Wrap,
};

use crate::Budget;
use crate::options::RigidOptions;
use clench_solver::Tree;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// A model: immutable while stepping, shared by `Arc` between simulations.
///
/// Elements are numbered as in MuJoCo: bodies depth first, joints, dofs, geoms and sites in the order of their bodies.
#[derive(Clone, Debug)]
pub struct Model {
    /// Name.
    pub name: String,
    /// Bodies; the first is the world.
    pub bodies: Vec<Body>,
    /// Joints.
    pub joints: Vec<Joint>,
    /// Degrees of freedom.
    pub dofs: Vec<Dof>,
    /// Geoms.
    pub geoms: Vec<Geom>,
    /// Sites.
    pub sites: Vec<Site>,
    /// Cameras.
    pub cameras: Vec<Camera>,
    /// Tendons.
    pub tendons: Vec<Tendon>,
    /// The dofs that change the length of each tendon.
    pub tendon_dofs: RowPattern,
    /// Actuators.
    pub actuators: Vec<Actuator>,
    /// The dofs that each actuator acts on.
    pub actuator_dofs: RowPattern,
    /// Sensors.
    pub sensors: Vec<Sensor>,
    /// Equality constraints.
    pub equalities: Vec<Equality>,
    /// Maximum number of constraints added at run time: the slots of every state.
    pub max_dynamic_constraints: usize,
    /// Maximum number of pairs of geoms with a stick reference: the slots of every state. `None` without the option
    /// `stiction`. Simulations and batches set it, see [`StepSettings::adapt`](crate::StepSettings::adapt).
    pub max_stick_pairs: Option<usize>,
    /// Explicit geom pairs.
    pub pairs: Vec<Pair>,
    /// Body pairs (smaller index first) that never collide.
    pub excludes: HashSet<(u32, u32)>,
    /// The names of those of them that have one.
    pub exclude_names: HashMap<(u32, u32), String>,
    /// Stored states.
    pub keyframes: Vec<Keyframe>,
    /// Meshes.
    pub meshes: Vec<Arc<Mesh>>,
    /// Height fields.
    pub height_fields: Vec<Arc<HeightField>>,
    /// The mesh or height field of each geom in each of the models that share this layout; empty if this is
    /// the layout of one.
    pub geom_assets: Vec<Vec<Option<u32>>>,
    /// Position coordinates.
    pub nq: usize,
    /// Degrees of freedom.
    pub nv: usize,
    /// Activations.
    pub na: usize,
    /// Rest positions of yielding springs (count).
    pub nplastic: usize,
    /// Numbers in buffers of past values (count).
    pub nhistory: usize,
    /// Mocap bodies.
    pub nmocap: usize,
    /// Sparsity of the mass matrix.
    pub tree: Arc<Tree>,
    /// Kinematic trees, in the order of their dofs.
    pub trees: Vec<KinematicTree>,
    /// The two trees of each tendon that acts on two.
    pub tendon_ties: Vec<Option<[usize; 2]>>,
    /// The initial [`State::tree_asleep`](crate::State::tree_asleep), which has no numbers without the flag `sleep`.
    pub tree_asleep0: Vec<f64>,
    /// The integrator.
    pub integrator: Integrator,
    /// Feature switches.
    pub flags: Flags,
    /// True if contacts take the parameters in `params.override_*`.
    pub override_contacts: bool,
    /// Solver options of the file, over its format's defaults.
    pub options: RigidOptions,
    /// Limits on the resources of a step.
    pub budget: Budget,
    /// Every number of the model.
    pub params: Params<f64>,
    /// The fixed poses that are trivial.
    pub same_frames: SameFrames,
    /// Messages to report to the user once.
    pub notes: Vec<String>,
    /// Elements of the file that were omitted because they are not supported yet, each with its location.
    pub omitted: Vec<String>,
    /// The user's own data.
    pub custom: Custom,
    /// The appearance of its elements.
    pub visuals: Visuals,
}

impl Model {
    /// Returns the number of bodies, including the world.
    pub fn nbody(&self) -> usize {
        self.bodies.len()
    }
    /// Returns true if nothing can move a body: neither joints nor the user, who moves mocap bodies.
    #[inline(always)]
    pub fn is_fixed(&self, body: usize) -> bool {
        let weld = &self.bodies[self.bodies[body].weld];
        weld.dofs.is_empty() && weld.mocap.is_none()
    }
    /// Returns true if any tree can sleep.
    pub(crate) fn may_sleep(&self) -> bool {
        !self.tree_asleep0.is_empty()
    }
    /// Returns the number of kinematic trees.
    pub fn ntree(&self) -> usize {
        self.trees.len()
    }
    /// Returns the kinematic tree of a body; `None` if no joint moves it.
    pub fn tree_of_body(&self, body: usize) -> Option<usize> {
        self.bodies[body].last_dof.map(|dof| self.tree.tree_of(dof))
    }
    /// Returns the kinematic trees of some dofs, without duplicates.
    pub fn trees_of(&self, dofs: &[u32]) -> Vec<usize> {
        let mut trees = Vec::from_iter(dofs.iter().map(|&dof| self.tree.tree_of(dof as usize)));
        trees.sort_unstable();
        trees.dedup();
        trees
    }
    /// Returns the number of controls. Most actuators have one.
    pub fn nu(&self) -> usize {
        self.actuators.last().map_or(0, |last| last.controls.end)
    }
    /// Returns the number of actuator forces. Most actuators have one.
    pub fn nout(&self) -> usize {
        self.actuators.last().map_or(0, |last| last.outputs.end)
    }
    /// Returns the buffers of past values.
    pub fn histories(&self) -> impl Iterator<Item = &History> {
        let of_actuators = self.actuators.iter().filter_map(|a| a.history.as_ref());
        let of_sensors = self.sensors.iter().filter_map(|s| s.history.as_ref());
        of_actuators.chain(of_sensors)
    }
    /// Lets actuator `u` damp its target and add inertia to it, if that is a joint or a tendon. Other targets have
    /// neither, as in MuJoCo.
    pub fn let_reflect(&mut self, u: usize) {
        let reflecting = match self.actuators[u].transmission {
            Transmission::Joint(j) | Transmission::JointInParent(j) => {
                &mut self.joints[j].reflecting
            }
            Transmission::Tendon(t) => &mut self.tendons[t].reflecting,
            Transmission::Site(_)
            | Transmission::SiteInFrame(_)
            | Transmission::SliderCrank(_)
            | Transmission::Body(_)
            | Transmission::Rotation(_)
            | Transmission::RotationInFrame(_) => return,
        };
        if let Err(place) = reflecting.binary_search(&u) {
            reflecting.insert(place, u);
        }
    }
    /// Returns true if actuator `u` may damp its target or add inertia to it, or if its target has neither.
    fn reflects(&self, u: usize) -> bool {
        match self.actuators[u].transmission {
            Transmission::Joint(j) | Transmission::JointInParent(j) => {
                self.joints[j].reflecting.contains(&u)
            }
            Transmission::Tendon(t) => self.tendons[t].reflecting.contains(&u),
            Transmission::Site(_)
            | Transmission::SiteInFrame(_)
            | Transmission::SliderCrank(_)
            | Transmission::Body(_)
            | Transmission::Rotation(_)
            | Transmission::RotationInFrame(_) => true,
        }
    }
    /// Returns the total number of sensor values.
    pub fn nsensordata(&self) -> usize {
        self.sensors.last().map_or(0, |sensor| sensor.numbers.end)
    }
    /// Returns the range of a body and its descendants, numbered depth first.
    pub fn subtree(&self, body: usize) -> Range<usize> {
        let below = &self.bodies[body + 1..];
        let end = below.iter().position(|other| other.parent < body);
        body..end.map_or(self.bodies.len(), |end| body + 1 + end)
    }
}
