//! Keyframes of attached models.
//!
//! A keyframe is the concatenation of the numbers of a whole model. Before a model is attached, its keyframes are split
//! into the parts of single joints, mocap bodies, tendons and actuators, and these elements are numbered; copies of an
//! element retain its number. Finally a keyframe is assembled for the elements that exist. As in MuJoCo 4.0, keyframe
//! names get the prefix of the attachment, and a keyframe refers to the first of several replicas.

use super::attached_keyframe::{AttachedKeyframe, Fragment};
use super::composer::Composer;
use super::models::Part;
use super::names::Namespace;
use super::shared::Shared;
use crate::document::Element;
use crate::error::LoadError;
use crate::mjcf::appearance::Palette;
use crate::mjcf::body::{self, BodyReader};
use crate::mjcf::sections::{entries, sections};
use crate::mjcf::{keyframe, relations};
use clench_builder::{BuildError, KeyframeElement, KeyframePart, KeyframeSpec};
use std::collections::HashMap;

/// Splits the keyframes of a model that will be attached, and numbers its elements. Keyframes of models attached to it
/// follow.
///
/// # Errors
/// Returns an error if the model cannot be read or a vector is longer than the model's.
pub(super) fn split(
    root: &mut Element,
    attached: Vec<AttachedKeyframe>,
    shared: &mut Shared,
) -> Result<Vec<AttachedKeyframe>, LoadError> {
    if entries(root, "keyframe").next().is_none() {
        return Ok(attached);
    }
    number(root, shared);
    let layout = Layout::read(root, shared)?;
    let own = entries(root, "keyframe").map(|key| layout.split(key));
    let mut keyframes = own.collect::<Result<Vec<_>, _>>()?;
    keyframes.extend(attached);
    Ok(keyframes)
}

/// Numbers the elements that have a part of the state.
fn number(root: &mut Element, shared: &mut Shared) {
    let tree = root.children.iter_mut();
    let mut pending: Vec<&mut Element> = tree
        .filter(|section| ["worldbody", "tendon", "actuator"].contains(&section.tag.as_str()))
        .flat_map(|section| &mut section.children)
        .collect();
    while let Some(element) = pending.pop() {
        if element.number == 0 {
            element.number = shared.next_number();
        }
        pending.extend(&mut element.children);
    }
}

/// The layout of a model's state by element.
struct Layout {
    /// Each joint's number, and counts of positions and velocities.
    joints: Vec<(u32, [usize; 2])>,
    /// Each actuator's number, and counts of controls and activations.
    actuators: Vec<(u32, [usize; 2])>,
    /// Each mocap body's number.
    mocaps: Vec<(u32, [usize; 2])>,
    /// Each joint's and tendon's number, and the count of its spring's rest coordinates; 0 if it does not yield.
    springs: Vec<(u32, usize)>,
}

impl Layout {
    fn read(root: &Element, shared: &mut Shared) -> Result<Self, LoadError> {
        let palette = Palette::new(root, &[]);
        let mut bodies = vec![body::world()];
        let mut reader = BodyReader::new(&shared.sources, &palette, &mut bodies, shared.spending);
        for section in sections(root, "worldbody") {
            reader.read_world(section)?;
        }
        let (numbers, _) = reader.finish();
        let joints = || bodies.iter().flat_map(|body| &body.joints);
        let sizes = joints().map(|joint| [joint.kind.nq(), joint.kind.nv()]);
        let yielding = |spring: f64, count| if spring > 0.0 { count } else { 0 };
        let plastic_sizes = joints().map(|joint| yielding(joint.springyield, joint.kind.nq()));
        let mut springs: Vec<_> = numbers.joints.iter().copied().zip(plastic_sizes).collect();
        for element in entries(root, "tendon") {
            let spec = relations::read_tendon(element, &shared.sources)?;
            springs.push((element.number, yielding(spec.springyield, 2)));
        }
        let mut actuators = Vec::new();
        for element in entries(root, "actuator") {
            let spec = relations::read_actuator(element, &shared.sources)?;
            let refuse = |error: BuildError| element.error(error.message);
            let controls = spec.controls().map_err(refuse)?.len();
            let activations = spec.activations().map_err(refuse)?;
            actuators.push((element.number, [controls, activations]));
        }
        Ok(Layout {
            joints: numbers.joints.into_iter().zip(sizes).collect(),
            actuators,
            mocaps: numbers.mocaps.into_iter().map(|n| (n, [3, 4])).collect(),
            springs,
        })
    }

    fn split(&self, element: &Element) -> Result<AttachedKeyframe, LoadError> {
        let mut spec = keyframe::read(element)?;
        let mut parts = Vec::new();
        let vectors = [
            (
                &self.joints,
                ["qpos", "qvel"],
                [spec.qpos.take(), spec.qvel.take()],
            ),
            (
                &self.actuators,
                ["ctrl", "act"],
                [spec.ctrl.take(), spec.act.take()],
            ),
            (
                &self.mocaps,
                ["mpos", "mquat"],
                [spec.mocap_pos.take(), spec.mocap_quat.take()],
            ),
        ];
        for (elements, names, numbers) in vectors {
            let numbers = numbers.map(Option::unwrap_or_default);
            for k in [0, 1] {
                let counts = elements.iter().map(|(_, counts)| counts[k]);
                require_whole(element, names[k], &numbers[k], counts)?;
            }
            let mut rest = numbers.each_ref().map(Vec::as_slice);
            for &(number, counts) in elements {
                let [first, second] = [0, 1].map(|k| split_front(&mut rest[k], counts[k]));
                parts.push(Fragment {
                    number,
                    first,
                    second,
                    plastic: Vec::new(),
                });
            }
        }
        let numbers = spec.plastic.take().unwrap_or_default();
        let counts = self.springs.iter().map(|&(_, count)| count);
        require_whole(element, "plastic", &numbers, counts)?;
        let mut rest = numbers.as_slice();
        for &(number, count) in self.springs.iter().filter(|(_, count)| *count > 0) {
            parts.push(Fragment {
                number,
                first: Vec::new(),
                second: Vec::new(),
                plastic: split_front(&mut rest, count),
            });
        }
        Ok(AttachedKeyframe { spec, parts })
    }
}

/// Rejects a vector that ends within an element; `counts` are the sizes of the elements.
fn require_whole(
    element: &Element,
    name: &str,
    numbers: &[f64],
    counts: impl Iterator<Item = usize>,
) -> Result<(), LoadError> {
    let mut end = 0;
    let mut ends = counts.map(|count| {
        end += count;
        end
    });
    let count = numbers.len();
    if count == 0 || ends.any(|end| end == count) {
        return Ok(());
    }
    let reason = "which is more than the model has, or ends within one of its elements";
    Err(element.error(format!("{name} has {count} numbers, {reason}")))
}

/// Takes the first numbers of a vector; none if it has fewer, as in a keyframe of only the leading part of the state.
fn split_front(rest: &mut &[f64], count: usize) -> Vec<f64> {
    match rest.split_at_checked(count) {
        Some((taken, others)) => {
            *rest = others;
            taken.to_vec()
        }
        None => Vec::new(),
    }
}

impl Composer<'_, '_> {
    /// Adds the keyframes of an attached model for these copies: a part of the tree and the last tendons and actuators.
    pub(super) fn attach_keyframes(
        &mut self,
        element: &Element,
        model: &Part,
        tree: &mut Element,
        [tendons_before, actuators_before]: [usize; 2],
        namespace: &Namespace,
    ) -> Result<(), LoadError> {
        if model.keyframes.is_empty() {
            return Ok(());
        }
        let mut tendons = std::mem::take(self.list("tendon"));
        let mut actuators = std::mem::take(self.list("actuator"));
        let mut pending = vec![tree];
        pending.extend(tendons.iter_mut().skip(tendons_before));
        pending.extend(actuators.iter_mut().skip(actuators_before));
        let mut renumbered = HashMap::new();
        while let Some(copy) = pending.pop() {
            if copy.number != 0 {
                let new = renumbered.entry(copy.number);
                copy.number = *new.or_insert_with(|| self.shared.next_number());
            }
            pending.extend(&mut copy.children);
        }
        *self.list("tendon") = tendons;
        *self.list("actuator") = actuators;
        for keyframe in &model.keyframes {
            let mut copy = keyframe.clone();
            copy.parts
                .retain_mut(|part| match renumbered.get(&part.number) {
                    Some(&new) => {
                        part.number = new;
                        true
                    }
                    None => false,
                });
            if !copy.spec.name.is_empty() {
                copy.spec.name = namespace.apply(&copy.spec.name);
            }
            let bytes = copy.parts.len() * size_of::<Fragment>();
            let consumed = self.shared.spending.bytes(bytes as u64);
            consumed.map_err(|excess| element.error(excess))?;
            self.keyframes.push(copy);
        }
        Ok(())
    }
}

/// Resolves the numbers to elements of the complete model: joints and mocap bodies in order, actuators and tendons.
pub(crate) fn resolve(
    keyframes: &[AttachedKeyframe],
    root: &Element,
    numbers: body::Numbers,
) -> Vec<KeyframeSpec> {
    let mut elements = HashMap::new();
    let mut assign = |numbers: Vec<u32>, element: fn(usize) -> KeyframeElement| {
        for (index, number) in numbers.into_iter().enumerate() {
            elements.entry(number).or_insert(element(index));
        }
    };
    assign(numbers.joints, KeyframeElement::Joint);
    assign(numbers.mocaps, KeyframeElement::Mocap);
    let listed = |section| entries(root, section).map(|entry| entry.number).collect();
    assign(listed("actuator"), KeyframeElement::Actuator);
    assign(listed("tendon"), KeyframeElement::Tendon);
    let spec = |keyframe: &AttachedKeyframe| KeyframeSpec {
        parts: (keyframe.parts.iter())
            .filter_map(|part| {
                Some(KeyframePart {
                    element: *elements.get(&part.number)?,
                    first: part.first.clone(),
                    second: part.second.clone(),
                    plastic: part.plastic.clone(),
                })
            })
            .collect(),
        ..keyframe.spec.clone()
    };
    keyframes.iter().map(spec).collect()
}
