//! Stored states.

use super::actuators::States;
use super::{FrameId, Frames, PlacedJoint, located};
use crate::LoadError;
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
                plastic.extend([linear(along.coordinate); 2]);
            }
        }
        let mocaps = self.mocaps.iter();
        let mocap_pos: Vec<Map> = mocaps.flat_map(|&frame| self.moved(frame)).collect();
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
            yields,
            ..
        } in joints
        {
            let length = self.scale(frame).length;
            let along = match kind {
                JointKind::Slide => length,
                _ => 1.0,
            };
            match kind {
                JointKind::Free => {
                    qpos.extend(self.moved(frame));
                    qpos.extend([linear(1.0); 4]);
                    qvel.extend([length, length, length, 1.0, 1.0, 1.0].map(linear));
                }
                _ => {
                    qpos.extend(vec![linear(along); kind.nq()]);
                    qvel.extend(vec![linear(along); kind.nv()]);
                }
            }
            if yields {
                plastic.extend(vec![linear(along); kind.nq()]);
            }
        }
        [qpos, qvel, plastic]
    }

    /// What becomes of the position of something in the world that a frame carries: it moves with the frame, and away from it.
    fn moved(&self, frame: FrameId) -> [Map; 3] {
        let frame = &self.list[frame];
        let length = frame.scale.length;
        let offset = frame.position - frame.unscaled * length;
        offset.to_array().map(|offset| (length, offset))
    }
}

/// What becomes of a number: it is multiplied by the first, and the second is added.
type Map = (f64, f64);

/// What becomes of the controls or activations of all actuators.
fn states(actuators: &[States], which: impl Fn(&States) -> &Vec<f64>) -> Vec<Map> {
    (actuators.iter().flat_map(which))
        .map(|&factor| linear(factor))
        .collect()
}

fn linear(factor: f64) -> Map {
    (factor, 0.0)
}

/// Numbers of another count than the maps are told of when the model is built.
fn apply(numbers: &mut Option<Vec<f64>>, maps: &[Map]) {
    for (number, (factor, offset)) in numbers.iter_mut().flatten().zip(maps) {
        *number = *number * factor + offset;
    }
}
