//! Keyframes.

use super::element::Element;
use super::model_builder::ModelBuilder;
use super::{BuildError, KeyframeElement, KeyframePart, KeyframeSpec};
use clench_dynamics::State;
use clench_dynamics::model::{JointKind, Keyframe, Model};
use clench_math::{Quat, Vec3};

/// Adds all keyframes. A vector that is missing, or shorter than the model's, is completed from the initial state,
/// controls by zeros.
///
/// # Errors
/// Returns an error if a vector is longer than the model's, or ends within a position or quaternion of a mocap body.
pub(super) fn add_all(builder: &ModelBuilder, model: &mut Model) -> Result<(), BuildError> {
    let initial = State::<f64>::new(model);
    let mocap_pos: Vec<_> = initial.mocap_pos.into_iter().map(Vec3::to_array).collect();
    let mocap_quat: Vec<_> = initial.mocap_quat.into_iter().map(Quat::to_array).collect();
    for spec in &builder.keyframes {
        let mut keyframe = Keyframe {
            name: spec.name.clone(),
            time: spec.time,
            qpos: complete(spec, "qpos", 1, &spec.qpos, &initial.qpos)?,
            qvel: complete(spec, "qvel", 1, &spec.qvel, &initial.qvel)?,
            act: complete(spec, "act", 1, &spec.act, &initial.act)?,
            plastic: complete(spec, "plastic", 1, &spec.plastic, &initial.plastic)?,
            ctrl: complete(spec, "ctrl", 1, &spec.ctrl, &vec![0.0; model.nu()])?,
            mocap_pos: complete(
                spec,
                "mocap_pos",
                3,
                &spec.mocap_pos,
                mocap_pos.as_flattened(),
            )?,
            mocap_quat: complete(
                spec,
                "mocap_quat",
                4,
                &spec.mocap_quat,
                mocap_quat.as_flattened(),
            )?,
        };
        for part in &spec.parts {
            insert(spec, part, model, &mut keyframe)?;
        }
        normalize_quats(model, &mut keyframe);
        model.keyframes.push(keyframe);
    }
    Ok(())
}

fn complete(
    spec: &KeyframeSpec,
    field: &str,
    group: usize,
    numbers: &Option<Vec<f64>>,
    initial: &[f64],
) -> Result<Vec<f64>, BuildError> {
    let mut values = numbers.clone().unwrap_or_default();
    if values.len() > initial.len() {
        return Err(spec.error(format!(
            "{field} has {} numbers, the model has {}",
            values.len(),
            initial.len()
        )));
    }
    if !values.len().is_multiple_of(group) {
        return Err(spec.error(format!(
            "{field} has {} numbers, which is not a multiple of {group}",
            values.len()
        )));
    }
    values.extend_from_slice(&initial[values.len()..]);
    Ok(values)
}

/// Writes a keyframe's part of one element.
///
/// # Errors
/// Returns an error if the element does not exist, or has another number of values.
fn insert(
    spec: &KeyframeSpec,
    part: &KeyframePart,
    model: &Model,
    keyframe: &mut Keyframe,
) -> Result<(), BuildError> {
    let unknown = || spec.error(format!("there is no {:?}", part.element));
    let yielding = |start: Option<usize>, count| start.map_or(0..0, |at| at..at + count);
    let (into, ranges, plastic) = match part.element {
        KeyframeElement::Joint(j) => {
            let joint = model.joints.get(j).ok_or_else(unknown)?;
            let (q, v, kind) = (joint.qpos, joint.dof, joint.kind);
            let ranges = [q..q + kind.nq(), v..v + kind.nv()];
            let plastic = yielding(joint.plastic, kind.nq());
            ([&mut keyframe.qpos, &mut keyframe.qvel], ranges, plastic)
        }
        KeyframeElement::Actuator(a) => {
            let actuator = model.actuators.get(a).ok_or_else(unknown)?;
            let ranges = [actuator.controls.clone(), actuator.acts.clone()];
            ([&mut keyframe.ctrl, &mut keyframe.act], ranges, 0..0)
        }
        KeyframeElement::Mocap(k) if k < model.nmocap => {
            let ranges = [3 * k..3 * k + 3, 4 * k..4 * k + 4];
            let into = [&mut keyframe.mocap_pos, &mut keyframe.mocap_quat];
            (into, ranges, 0..0)
        }
        KeyframeElement::Mocap(_) => return Err(unknown()),
        KeyframeElement::Tendon(t) => {
            let tendon = model.tendons.get(t).ok_or_else(unknown)?;
            let plastic = yielding(tendon.plastic, 2);
            (
                [&mut keyframe.qpos, &mut keyframe.qvel],
                [0..0, 0..0],
                plastic,
            )
        }
    };
    let [first, second] = into;
    let [of_first, of_second] = ranges;
    for (values, range, given) in [
        (first, of_first, &part.first),
        (second, of_second, &part.second),
        (&mut keyframe.plastic, plastic, &part.plastic),
    ] {
        if given.is_empty() {
            continue;
        }
        if given.len() != range.len() {
            let (found, wanted) = (given.len(), range.len());
            let message = format!("{:?} has {wanted} numbers, not {found}", part.element);
            return Err(spec.error(message));
        }
        values[range].copy_from_slice(given);
    }
    Ok(())
}

fn normalize_quats(model: &Model, keyframe: &mut Keyframe) {
    let normalize = |q: &mut [f64]| Quat::from_slice(q).normalize().write(q);
    for joint in &model.joints {
        match joint.kind {
            JointKind::Free => normalize(&mut keyframe.qpos[joint.qpos + 3..]),
            JointKind::Ball => normalize(&mut keyframe.qpos[joint.qpos..]),
            JointKind::Slide | JointKind::Hinge => {}
        }
    }
    for joint in &model.joints {
        if let (JointKind::Ball, Some(start)) = (joint.kind, joint.plastic) {
            normalize(&mut keyframe.plastic[start..]);
        }
    }
    keyframe.mocap_quat.chunks_exact_mut(4).for_each(normalize);
}
