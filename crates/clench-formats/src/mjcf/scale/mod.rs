//! Frames that scale their contents: `scale`, `scaling` and `massscale`.
//!
//! A frame multiplies lengths by s and masses by m, which defaults to s³. Other quantities depend on the policy. With
//! `similar` the units of length and mass change: a quantity of dimension Lᵃ Mᵇ Tᶜ is multiplied by sᵃ mᵇ. With
//! `geometry` only lengths, masses and inertias change, not forces, stiffnesses, dampings and gains. Nested frames
//! multiply, each by its own policy. Scales that differ between axes, only allowed with `geometry`, act by axis on
//! positions, sizes and the travel of slides; quantities without direction follow the cube root of their product, and a
//! change of the kind of shape is rejected. Elements that refer to the tree (pairs, tendons, equalities, actuators,
//! sensors, keyframes) get the scale of their targets: the geometric mean of two different ones, and for a tendon that
//! of the frames that enclose its entire path. The dimensions are those of MuJoCo's table of units (XMLunits); the
//! rules for two scales were determined by comparison with MuJoCo 4.0.

mod actuators;
mod elements;
mod instances;
mod keyframes;
mod relations;

use super::linear_map::LinearMap;
use super::orientation::Pose;
use super::shortcut::Shortcut;
use crate::document::Element;
use crate::error::LoadError;
use crate::spending::Spending;
use clench_builder::{
    BodySpec, BuildError, ElementNumber, JointSpec, ModelBuilder, NumberDimension, Origin,
};
use clench_dynamics::model::JointKind;
use clench_math::Vec3;
use std::collections::BTreeMap;

/// The factors by which the enclosing frames multiply an element's numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// The factor of lengths without direction.
    pub length: f64,
    /// The factor of masses.
    pub mass: f64,
    /// The unit of length that forces follow.
    unit_length: f64,
    /// The unit of mass that forces follow.
    unit_mass: f64,
    /// True if a frame's scale differs between axes, even if another frame compensates it.
    by_axis: bool,
}

impl Scale {
    const ONE: Scale = Scale {
        length: 1.0,
        mass: 1.0,
        unit_length: 1.0,
        unit_mass: 1.0,
        by_axis: false,
    };

    /// Reads the scale of a frame, and its linear map of positions.
    fn read(element: &Element) -> Result<(Scale, LinearMap), LoadError> {
        let axes = match element.list("scale")?.unwrap_or_default()[..] {
            [] => [1.0; 3],
            [all] => [all; 3],
            [x, y, z] => [x, y, z],
            _ => return Err(element.error("scale needs 1 or 3 numbers")),
        };
        if axes.iter().any(|&axis| axis <= 0.0) {
            return Err(element.error("scale must be positive"));
        }
        let policies = [("similar", true), ("geometry", false)];
        let similar = element.keyword("scaling", &policies)?.unwrap_or(true);
        let [x, y, z] = axes;
        let differ = y != x || z != x;
        if differ && similar {
            let message = "a scale that differs between axes needs scaling \"geometry\"";
            return Err(element.error(message));
        }
        let length = if differ { (x * y * z).cbrt() } else { x };
        let mut mass = 0.0;
        element.set_number("massscale", &mut mass)?;
        element.refuse_negative(&["massscale"])?;
        if mass == 0.0 {
            mass = x * y * z;
        }
        let (unit_length, unit_mass) = if similar { (length, mass) } else { (1.0, 1.0) };
        let scale = Scale {
            length,
            mass,
            unit_length,
            unit_mass,
            by_axis: differ,
        };
        Ok((scale, LinearMap::along_axes(Vec3::from_array(axes))))
    }

    /// Returns the scale of a frame in this one.
    fn then(self, inner: Scale) -> Scale {
        self.zip(inner, |outer, inner| outer * inner)
    }

    /// Returns the geometric mean of two scales.
    pub(super) fn mean(self, other: Scale) -> Scale {
        match self == other {
            true => self,
            false => self.zip(other, |a, b| (a * b).sqrt()),
        }
    }

    fn zip(self, other: Scale, combine: impl Fn(f64, f64) -> f64) -> Scale {
        Scale {
            length: combine(self.length, other.length),
            mass: combine(self.mass, other.mass),
            unit_length: combine(self.unit_length, other.unit_length),
            unit_mass: combine(self.unit_mass, other.unit_mass),
            by_axis: self.by_axis || other.by_axis,
        }
    }

    /// Returns the factor of a quantity of dimension M Lᵃ, times any power of time, that follows forces.
    fn force(self, lengths: i32) -> f64 {
        self.unit_mass * self.unit_length.powi(lengths)
    }

    /// Returns the factors along a coordinate: forces and lengths, or torques and angles.
    fn along(self, coordinate: Coordinate) -> Along {
        self.along_direction(coordinate, self.length)
    }

    /// Like `along`, in a direction with this factor of lengths.
    fn along_direction(self, coordinate: Coordinate, length: f64) -> Along {
        match coordinate {
            Coordinate::Length => Along {
                coordinate: length,
                unit: self.unit_length,
                force: self.force(1),
                pressure: self.force(-1),
            },
            Coordinate::Angle => Along {
                coordinate: 1.0,
                unit: 1.0,
                force: self.force(2),
                pressure: self.force(-1),
            },
        }
    }
}

/// The quantity that a coordinate measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Coordinate {
    Length,
    Angle,
}

/// The factors of the quantities along a coordinate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Along {
    /// The factor of positions and velocities.
    pub(super) coordinate: f64,
    /// The factor of the coordinate's unit for forces.
    unit: f64,
    /// The factor of forces or torques.
    force: f64,
    /// The factor of pressures.
    pressure: f64,
}

impl Along {
    /// Scales a stiffness or damping: coefficients of a coordinate, its square and its cube.
    fn polynomial(self, coefficients: &mut [f64; 3]) {
        let mut factor = self.force;
        for coefficient in coefficients {
            factor /= self.unit;
            *coefficient *= factor;
        }
    }

    /// Scales the numbers of some rows of a table.
    fn element_numbers(self, rows: &[ElementNumber], numbers: &mut [&mut f64]) {
        for (row, number) in rows.iter().zip(numbers) {
            **number *= match row.dimension {
                NumberDimension::Coordinate => self.coordinate,
                NumberDimension::Force => self.force,
                NumberDimension::ForcePerCoordinate => self.gain(),
            };
        }
    }

    /// Returns the factor of force per coordinate or rate.
    fn gain(self) -> f64 {
        self.force / self.unit
    }

    /// Returns the factor of torque: M L² for lengths, and the torque of angles, whose unit is 1.
    fn turning(self) -> f64 {
        self.force * self.unit
    }
}

/// The index of a frame that scales; 0 stands for none.
pub(super) type FrameId = usize;

/// A frame that scales.
#[derive(Clone, Copy, Debug)]
struct Frame {
    /// The enclosing frame.
    outer: FrameId,
    /// The scale of its contents.
    scale: Scale,
    /// Its position in the body, with and without scales.
    position: Vec3<f64>,
    unscaled: Vec3<f64>,
    /// The linear map of its positions, in the axes of the body.
    linear_map: LinearMap,
}

impl Frame {
    const NONE: Frame = Frame {
        outer: 0,
        scale: Scale::ONE,
        position: Vec3::ZERO,
        unscaled: Vec3::ZERO,
        linear_map: LinearMap::NONE,
    };

    /// Returns the position of a point of the frame without scales.
    fn unscaled(self, point: Vec3<f64>) -> Vec3<f64> {
        self.unscaled + self.linear_map.undo(point - self.position)
    }
}

/// The frames that scale, and the named elements in them.
#[derive(Debug)]
pub(super) struct Frames {
    list: Vec<Frame>,
    /// The frames of bodies, with the maps of positions in their axes.
    bodies: BTreeMap<String, (FrameId, LinearMap)>,
    joints: BTreeMap<String, JointScaling>,
    geoms: BTreeMap<String, FrameId>,
    sites: BTreeMap<String, FrameId>,
    cameras: BTreeMap<String, FrameId>,
    tendons: BTreeMap<String, (FrameId, Coordinate)>,
    /// All joints, in the order of reading.
    all_joints: Vec<JointScaling>,
    /// The frames and coordinates of tendons, in order.
    all_tendons: Vec<(FrameId, Coordinate)>,
    /// The frames of mocap bodies.
    mocaps: Vec<FrameId>,
    /// The shapes of a mesh or height field, in the order of the elements that use them.
    instances: BTreeMap<String, Vec<LinearMap>>,
    /// The shapes after the first ones, in the order of use.
    further_shapes: Vec<(String, usize)>,
    /// Scaled mesh geoms whose mass derives from a density: body, index in it, and scale of lengths.
    meshes: Vec<(usize, usize, f64)>,
}

/// The data for scaling a joint's numbers.
#[derive(Clone, Copy, Debug)]
struct JointScaling {
    body: usize,
    frame: FrameId,
    kind: JointKind,
    /// The factor of lengths along its axis.
    length: f64,
    /// True if its spring yields.
    yields: bool,
}

/// The kinds of elements that are referenced by name.
#[derive(Clone, Copy, Debug)]
pub(super) enum Named {
    Geom,
    Site,
    Camera,
}

impl Default for Frames {
    fn default() -> Self {
        Frames {
            list: vec![Frame::NONE],
            bodies: BTreeMap::new(),
            joints: BTreeMap::new(),
            geoms: BTreeMap::new(),
            sites: BTreeMap::new(),
            cameras: BTreeMap::new(),
            tendons: BTreeMap::new(),
            all_joints: Vec::new(),
            all_tendons: Vec::new(),
            mocaps: Vec::new(),
            instances: BTreeMap::new(),
            further_shapes: Vec::new(),
            meshes: Vec::new(),
        }
    }
}

impl Frames {
    /// Reads the scale of a nested frame, and composes its map with that of its pose in the body.
    pub(super) fn add_frame(
        &mut self,
        element: &Element,
        outer: FrameId,
        pose: &mut Pose,
    ) -> Result<FrameId, LoadError> {
        let (own, linear_map) = Scale::read(element)?;
        if own == Scale::ONE {
            return Ok(outer);
        }
        pose.linear_map = pose.linear_map.after(linear_map);
        let enclosing = self.list[outer];
        self.list.push(Frame {
            outer,
            scale: enclosing.scale.then(own),
            position: pose.pos,
            unscaled: enclosing.unscaled(pose.pos),
            linear_map: pose.linear_map.rotated(pose.quat.conjugate()),
        });
        Ok(self.list.len() - 1)
    }

    /// Returns the scale of a frame.
    pub(super) fn scale(&self, frame: FrameId) -> Scale {
        self.list[frame].scale
    }

    /// Returns true if any frame scales.
    fn any(&self) -> bool {
        self.list.len() > 1
    }

    /// Returns the innermost frame that encloses both.
    fn common(&self, mut a: FrameId, mut b: FrameId) -> FrameId {
        // A frame has a larger index than those that enclose it.
        while a != b {
            let (larger, smaller) = (a.max(b), a.min(b));
            (a, b) = (self.list[larger].outer, smaller);
        }
        a
    }

    /// Records a body in a frame, with the map of positions in its axes.
    pub(super) fn add_body(&mut self, body: &BodySpec, frame: FrameId, linear_map: LinearMap) {
        if frame != 0 && !body.name.is_empty() {
            self.bodies.insert(body.name.clone(), (frame, linear_map));
        }
        if body.mocap {
            self.mocaps.push(frame);
        }
    }

    /// Records a joint in a frame, with the factor of lengths along its axis.
    pub(super) fn add_joint(
        &mut self,
        joint: &JointSpec,
        body: usize,
        frame: FrameId,
        length: f64,
    ) {
        let placed = JointScaling {
            body,
            frame,
            kind: joint.kind,
            length,
            yields: joint.springyield > 0.0,
        };
        self.all_joints.push(placed);
        if frame != 0 && !joint.name.is_empty() {
            self.joints.insert(joint.name.clone(), placed);
        }
    }

    pub(super) fn add(&mut self, kind: Named, name: &str, frame: FrameId) {
        if frame == 0 || name.is_empty() {
            return;
        }
        let names = match kind {
            Named::Geom => &mut self.geoms,
            Named::Site => &mut self.sites,
            Named::Camera => &mut self.cameras,
        };
        names.insert(name.to_owned(), frame);
    }

    /// Scales the elements that refer to the frames' contents.
    ///
    /// # Errors
    /// Returns an error if an actuator or sensor cannot be scaled, or on excess memory.
    pub(super) fn scale_remaining(
        mut self,
        shortcuts: &[Shortcut],
        builder: &mut ModelBuilder,
        spending: &mut Spending,
    ) -> Result<(), LoadError> {
        if !self.any() {
            return Ok(());
        }
        self.make_instances(builder, spending)?;
        self.weigh_shells(builder);
        self.scale_tendons(builder);
        self.scale_pairs(builder);
        for equality in &mut builder.equalities {
            self.scale_equality(equality);
        }
        self.scale_sensors(builder)?;
        let actuators = self.scale_actuators(shortcuts, builder)?;
        self.scale_keyframes(&actuators, builder);
        Ok(())
    }
}

/// Creates an error about an element that was read before.
fn located(
    origin: &Option<Origin>,
    kind: &str,
    name: &str,
    message: impl Into<String>,
) -> LoadError {
    let label = match name {
        "" => kind.to_owned(),
        _ => format!("{kind} \"{name}\""),
    };
    LoadError::from(BuildError {
        origin: origin.clone(),
        element: label,
        message: message.into(),
    })
}
