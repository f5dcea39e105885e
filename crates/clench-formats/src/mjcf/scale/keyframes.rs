//! Stored states.

use super::actuators::States;
use super::{FrameId, Frames, PlacedJoint, located};
use crate::LoadError;
use crate::mjcf::stretch::Stretch;
use clench_math::Vec3;
use clench_rigid::builder::ModelBuilder;
use clench_rigid::model::JointKind;

impl Frames {
    /// Scales what keyframes say of positions, velocities, springs, controls and activations.
    ///
    /// # Errors
    /// Keyframes of attached models.
    pub(super) fn scale_keyframes(
        &self,
        actuators: &[States],
        builder: &mut ModelBuilder,
    ) -> Result<(), LoadError> {
        let [qpos, qvel, mut plastic] = self.of_joints();
        for (tendon, &(frame, coordinate)) in builder.tendons.iter().zip(&self.all_tendons) {
            if tendon.springyield > 0.0 {
                let along = self.scale(frame).along(coordinate);
                plastic.extend([Map::Number(along.coordinate); 2]);
            }
        }
        let mocaps = self.mocaps.iter();
        let mocap_pos: Vec<Map> = mocaps.map(|&frame| self.moved(frame)).collect();
        let control = states(actuators, |states| &states.controls);
        let activation = states(actuators, |states| &states.activations);
        for keyframe in &mut builder.keyframes {
            if !keyframe.parts.is_empty() {
                let message =
                    "keyframes of attached models beside frames with a scale are not supported yet";
                return Err(located(&keyframe.origin, "key", &keyframe.name, message));
            }
            apply(&mut keyframe.qpos, &qpos);
            apply(&mut keyframe.qvel, &qvel);
            apply(&mut keyframe.plastic, &plastic);
            apply(&mut keyframe.ctrl, &control);
            apply(&mut keyframe.act, &activation);
            apply(&mut keyframe.mocap_pos, &mocap_pos);
        }
        Ok(())
    }
}

impl Frames {
    /// What becomes of the positions, the velocities and the springs of joints.
    fn of_joints(&self) -> [Vec<Map>; 3] {
        // Joints are numbered by body, and those of one body as they are read.
        let mut joints = self.all_joints.clone();
        joints.sort_by_key(|joint| joint.body);
        let (mut qpos, mut qvel, mut plastic) = (Vec::new(), Vec::new(), Vec::new());
        for PlacedJoint {
            frame,
            kind,
            length,
            yields,
            ..
        } in joints
        {
            let along = match kind {
                JointKind::Slide => length,
                _ => 1.0,
            };
            match kind {
                JointKind::Free => {
                    qpos.push(self.moved(frame));
                    qpos.extend([Map::Number(1.0); 4]);
                    qvel.push(Map::Point(self.list[frame].stretch, Vec3::ZERO));
                    qvel.extend([Map::Number(1.0); 3]);
                }
                _ => {
                    qpos.extend(vec![Map::Number(along); kind.nq()]);
                    qvel.extend(vec![Map::Number(along); kind.nv()]);
                }
            }
            if yields {
                plastic.extend(vec![Map::Number(along); kind.nq()]);
            }
        }
        [qpos, qvel, plastic]
    }

    /// What becomes of the position of something in the world that a frame carries: it moves with the frame, and away from it.
    fn moved(&self, frame: FrameId) -> Map {
        let frame = &self.list[frame];
        let offset = frame.position - frame.stretch.apply(frame.unscaled);
        Map::Point(frame.stretch, offset)
    }
}

/// What becomes of the next numbers.
#[derive(Clone, Copy, Debug)]
enum Map {
    /// One is multiplied by this.
    Number(f64),
    /// Three are a point: they are mapped, and this is added.
    Point(Stretch, Vec3<f64>),
}

impl Map {
    /// Maps the first of these numbers, and gives the others. Where a point is cut short, as it can be in a keyframe that
    /// is refused when the model is built, it stays.
    fn apply(self, numbers: &mut [f64]) -> &mut [f64] {
        match self {
            Map::Number(factor) => match numbers {
                [first, rest @ ..] => {
                    *first *= factor;
                    rest
                }
                [] => numbers,
            },
            Map::Point(stretch, offset) => match numbers {
                [x, y, z, rest @ ..] => {
                    let point = stretch.apply(Vec3::new(*x, *y, *z)) + offset;
                    [*x, *y, *z] = point.to_array();
                    rest
                }
                _ => &mut [],
            },
        }
    }
}

/// What becomes of the controls or activations of all actuators.
fn states(actuators: &[States], which: impl Fn(&States) -> &Vec<f64>) -> Vec<Map> {
    (actuators.iter().flat_map(which))
        .map(|&factor| Map::Number(factor))
        .collect()
}

/// Numbers of another count than the maps are told of when the model is built.
fn apply(numbers: &mut Option<Vec<f64>>, maps: &[Map]) {
    let mut rest = numbers.as_deref_mut().unwrap_or_default();
    for map in maps {
        rest = map.apply(rest);
    }
}
