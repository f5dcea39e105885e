//! Scaling of stored states. Those of attached models are scaled at the final location of the elements, as in MuJoCo
//! 4.0.

use super::actuators::States;
use super::{FrameId, Frames, JointScaling};
use crate::mjcf::linear_map::LinearMap;
use clench_builder::{KeyframeElement, KeyframePart, KeyframeSpec, ModelBuilder};
use clench_dynamics::model::JointKind;
use clench_math::Vec3;

impl Frames {
    /// Scales positions, velocities, springs, controls and activations of keyframes, whole or, from attached models, by
    /// element.
    pub(super) fn scale_keyframes(&self, actuators: &[States], builder: &mut ModelBuilder) {
        let maps = Maps {
            joints: self.of_joints(),
            mocaps: self.mocaps.iter().map(|&frame| self.moved(frame)).collect(),
            tendons: self.of_tendons(builder),
            actuators,
        };
        for keyframe in &mut builder.keyframes {
            maps.apply(keyframe);
        }
    }

    /// Returns the maps of the state of joints.
    fn of_joints(&self) -> Vec<OfJoint> {
        // Joints are numbered by body, and within a body in the order of reading.
        let mut joints = self.all_joints.clone();
        joints.sort_by_key(|joint| joint.body);
        joints
            .into_iter()
            .map(|joint| self.scaling_of(joint))
            .collect()
    }

    fn scaling_of(&self, joint: JointScaling) -> OfJoint {
        let JointScaling { frame, kind, .. } = joint;
        let along = match kind {
            JointKind::Slide => joint.length,
            _ => 1.0,
        };
        let numbers = |count| vec![Map::Number(along); count];
        let (mut qpos, mut qvel) = (numbers(kind.nq()), numbers(kind.nv()));
        if kind == JointKind::Free {
            qpos.splice(..3, [self.moved(frame)]);
            qvel.splice(..3, [Map::Point(self.list[frame].linear_map, Vec3::ZERO)]);
        }
        OfJoint {
            qpos,
            qvel,
            plastic: numbers(if joint.yields { kind.nq() } else { 0 }),
        }
    }

    /// Returns the maps of the rest lengths of tendon springs; none if they do not yield.
    fn of_tendons(&self, builder: &ModelBuilder) -> Vec<Vec<Map>> {
        let tendons = builder.tendons.iter().zip(&self.all_tendons);
        tendons
            .map(|(tendon, &(frame, coordinate))| {
                let along = self.scale(frame).along(coordinate);
                let count = if tendon.springyield > 0.0 { 2 } else { 0 };
                vec![Map::Number(along.coordinate); count]
            })
            .collect()
    }

    /// Returns the map of a position in the world that a frame transforms: an object moves with the frame, and relative
    /// to it.
    fn moved(&self, frame: FrameId) -> Map {
        let frame = &self.list[frame];
        let offset = frame.position - frame.linear_map.apply(frame.unscaled);
        Map::Point(frame.linear_map, offset)
    }
}

/// The maps of the state of a joint.
struct OfJoint {
    qpos: Vec<Map>,
    qvel: Vec<Map>,
    plastic: Vec<Map>,
}

/// The maps of the state of each element.
struct Maps<'a> {
    joints: Vec<OfJoint>,
    mocaps: Vec<Map>,
    tendons: Vec<Vec<Map>>,
    actuators: &'a [States],
}

impl Maps<'_> {
    fn apply(&self, keyframe: &mut KeyframeSpec) {
        let joints = || self.joints.iter();
        apply(&mut keyframe.qpos, joints().flat_map(|joint| &joint.qpos));
        apply(&mut keyframe.qvel, joints().flat_map(|joint| &joint.qvel));
        let springs = joints().flat_map(|joint| &joint.plastic);
        apply(
            &mut keyframe.plastic,
            springs.chain(self.tendons.iter().flatten()),
        );
        let controls = self.actuators.iter().flat_map(|of| numbers(&of.controls));
        apply(&mut keyframe.ctrl, &controls.collect::<Vec<_>>());
        let activations = self
            .actuators
            .iter()
            .flat_map(|of| numbers(&of.activations));
        apply(&mut keyframe.act, &activations.collect::<Vec<_>>());
        apply(&mut keyframe.mocap_pos, &self.mocaps);
        for part in &mut keyframe.parts {
            self.apply_to_part(part);
        }
    }

    fn apply_to_part(&self, part: &mut KeyframePart) {
        match part.element {
            KeyframeElement::Joint(joint) => {
                let joint = &self.joints[joint];
                map_numbers(&mut part.first, &joint.qpos);
                map_numbers(&mut part.second, &joint.qvel);
                map_numbers(&mut part.plastic, &joint.plastic);
            }
            KeyframeElement::Actuator(actuator) => {
                let states = &self.actuators[actuator];
                map_numbers(&mut part.first, &numbers(&states.controls));
                map_numbers(&mut part.second, &numbers(&states.activations));
            }
            KeyframeElement::Mocap(mocap) => {
                map_numbers(&mut part.first, &self.mocaps[mocap..=mocap]);
            }
            KeyframeElement::Tendon(tendon) => {
                map_numbers(&mut part.plastic, &self.tendons[tendon]);
            }
        }
    }
}

/// A map of the next numbers.
#[derive(Clone, Copy, Debug)]
enum Map {
    /// Multiplies one number by this factor.
    Number(f64),
    /// Applies the map to three numbers, a point, and adds the offset.
    Point(LinearMap, Vec3<f64>),
}

impl Map {
    /// Maps the first of these numbers, and returns the others. A truncated point, rejected when the model is built, is
    /// unchanged.
    fn apply(self, numbers: &mut [f64]) -> &mut [f64] {
        match self {
            Map::Number(factor) => match numbers {
                [first, rest @ ..] => {
                    *first *= factor;
                    rest
                }
                [] => numbers,
            },
            Map::Point(linear_map, offset) => match numbers {
                [x, y, z, rest @ ..] => {
                    let point = linear_map.apply(Vec3::new(*x, *y, *z)) + offset;
                    [*x, *y, *z] = point.to_array();
                    rest
                }
                _ => &mut [],
            },
        }
    }
}

/// Returns maps that multiply by these factors.
fn numbers(factors: &[f64]) -> Vec<Map> {
    factors.iter().map(|&factor| Map::Number(factor)).collect()
}

fn apply<'a>(given: &mut Option<Vec<f64>>, maps: impl IntoIterator<Item = &'a Map>) {
    map_numbers(given.as_deref_mut().unwrap_or_default(), maps);
}

/// Maps numbers in order. A mismatch of counts is reported when the model is built.
fn map_numbers<'a>(numbers: &mut [f64], maps: impl IntoIterator<Item = &'a Map>) {
    let mut rest = numbers;
    for map in maps {
        rest = map.apply(rest);
    }
}
