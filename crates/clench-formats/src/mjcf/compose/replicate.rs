//! `<replicate>`: repeats its content, each copy displaced from the previous one and with its number in the names.

use super::composer::Composer;
use super::names::{Kind, Namespace, kind_of};
use super::relations::{FOLLOWING, concerns, follows, resolves};
use crate::error::LoadError;
use crate::mjcf::document::Element;
use crate::mjcf::orientation::Pose;
use clench_math::Vec3;
use std::collections::HashSet;

/// The parameters of a `<replicate>`, and the pose of the next replica.
struct Replicas {
    count: usize,
    separator: String,
    euler: [f64; 3],
    /// The displacement between replicas.
    step: Pose,
    /// The displacement of the next replica from the first.
    displaced: Pose,
}

impl Composer<'_, '_> {
    /// Returns the frames that replace a `<replicate>` whose content is expanded.
    pub(super) fn replicate(&mut self, mut element: Element) -> Result<Vec<Element>, LoadError> {
        let mut replicas = self.read_replicas(&element)?;
        refuse_joints(&element)?;
        drop_inertia(&mut element);
        let mut following = self.following(&element);
        let mut frames = Vec::new();
        for number in 0..replicas.count {
            let digits = replicas.count.to_string().len();
            let suffix = format!("{}{number:0digits$}", replicas.separator);
            let namespace = Namespace {
                prefix: "",
                suffix: &suffix,
                foreign: false,
            };
            self.shared.consume(&element, &element)?;
            let suffixes = suffix.len() * self.count_names(&element);
            let taken = self.shared.spending.bytes(suffixes as u64);
            taken.map_err(|excess| element.error(excess))?;
            let mut frame = frame_of(&element, &self.next_pose(&mut replicas, number, &element));
            frame.children.clone_from(&element.children);
            for child in &mut frame.children {
                namespace.rename_tree(child);
                self.names.add_tree(child);
            }
            frames.push(frame);
            self.follow(&element, &mut following, &namespace)?;
        }
        self.discard(&element);
        Ok(frames)
    }

    fn read_replicas(&self, element: &Element) -> Result<Replicas, LoadError> {
        let count = element
            .integer("count")?
            .ok_or_else(|| element.missing("count"))?;
        let euler: [f64; 3] = element.numbers("euler")?.unwrap_or_default();
        let compiler = &self.shared.sources.of(element).compiler;
        Ok(Replicas {
            count: usize::try_from(count).unwrap_or_default(),
            separator: element.string("sep"),
            euler,
            step: Pose {
                pos: Vec3::from_array(element.numbers("offset")?.unwrap_or_default()),
                quat: compiler.euler(euler),
                ..Pose::IDENTITY
            },
            displaced: Pose::IDENTITY,
        })
    }

    /// Returns the pose of a replica. As in MuJoCo, angles are multiplied rather than rotations accumulated, so that no
    /// error builds up.
    fn next_pose(&self, replicas: &mut Replicas, number: usize, element: &Element) -> Pose {
        let compiler = &self.shared.sources.of(element).compiler;
        let quat = compiler.euler(replicas.euler.map(|angle| angle * number as f64));
        let pose = Pose {
            quat,
            ..replicas.displaced
        };
        replicas.displaced = pose.then(replicas.step);
        pose
    }

    fn count_names(&self, element: &Element) -> usize {
        let (mut count, mut pending) = (0, vec![element]);
        while let Some(element) = pending.pop() {
            count += usize::from(element.text("name").is_some());
            pending.extend(&element.children);
        }
        count
    }

    /// Returns the indices, by section, of the elements to copy with the replicated part.
    fn following(&self, element: &Element) -> Vec<(&'static str, Vec<usize>)> {
        let mut concerned = HashSet::new();
        let mut pending: Vec<&Element> = element.children.iter().collect();
        while let Some(part) = pending.pop() {
            concerned
                .extend(kind_of("worldbody", &part.tag).map(|kind| (kind, part.string("name"))));
            pending.extend(&part.children);
        }
        let mut following = Vec::new();
        for section in FOLLOWING {
            let list = self.lists.iter().find(|list| list.tag == section);
            let elements = list
                .map(|list| list.children.as_slice())
                .unwrap_or_default();
            let mut found = Vec::new();
            for (index, part) in elements.iter().enumerate() {
                if follows(section, part) && concerns(part, &concerned) {
                    concerned.extend(name_of(section, part));
                    found.push(index);
                }
            }
            following.push((section, found));
        }
        following
    }

    /// Copies these elements for one replica.
    fn follow(
        &mut self,
        at: &Element,
        following: &mut [(&'static str, Vec<usize>)],
        namespace: &Namespace,
    ) -> Result<(), LoadError> {
        for (section, indices) in following {
            let list = self.list(section);
            let from: Vec<Element> = indices.iter().map(|&index| list[index].clone()).collect();
            let from: Vec<&Element> = from.iter().collect();
            let copied = self.copy_following(at, section, &from, namespace)?;
            // A copy without references is copied again with the next replica.
            let list = self.list(section);
            let no_names = HashSet::new();
            indices.extend(
                copied
                    .into_iter()
                    .filter(|&copy| concerns(&list[copy], &no_names)),
            );
        }
        Ok(())
    }

    /// Removes the names of the replicated part, and the elements that referred to it.
    fn discard(&mut self, element: &Element) {
        let mut lost = Vec::new();
        for section in FOLLOWING {
            let names = &self.names;
            let list = self.lists.iter().find(|list| list.tag == section);
            let list = list
                .map(|list| list.children.as_slice())
                .unwrap_or_default();
            lost.push(
                list.iter()
                    .map(|part| resolves(part, names))
                    .collect::<Vec<_>>(),
            );
        }
        for child in &element.children {
            self.names.remove_tree(child);
        }
        for (section, resolved) in FOLLOWING.into_iter().zip(lost) {
            let list = std::mem::take(self.list(section));
            let mut kept = Vec::new();
            for (part, resolved) in list.into_iter().zip(resolved) {
                if !resolved || resolves(&part, &self.names) {
                    kept.push(part);
                } else {
                    self.names.remove(section, &part);
                }
            }
            *self.list(section) = kept;
        }
    }
}

fn name_of(section: &str, element: &Element) -> Option<(Kind, String)> {
    Some((kind_of(section, &element.tag)?, element.string("name")))
}

/// Creates a frame at the location of an element, with its class.
fn frame_of(element: &Element, pose: &Pose) -> Element {
    let mut frame = Element::with_location_of(element, "frame");
    let words = |numbers: &[f64]| {
        let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
        words.join(" ")
    };
    let pose = [
        ("pos", words(&pose.pos.to_array())),
        ("quat", words(&pose.quat.to_array())),
    ];
    frame
        .attributes
        .extend(pose.map(|(name, text)| (name.to_owned(), text)));
    let class = |(name, _): &&(String, String)| name == "class" || name == "childclass";
    frame
        .attributes
        .extend(element.attributes.iter().filter(class).cloned());
    frame
}

/// Returns the elements of the enclosing body, also in frames.
fn of_the_body<'a>(element: &'a Element) -> Vec<&'a Element> {
    let (mut found, mut pending): (_, Vec<&'a Element>) =
        (Vec::new(), element.children.iter().collect());
    while let Some(part) = pending.pop() {
        if part.tag == "frame" {
            pending.extend(&part.children);
        }
        found.push(part);
    }
    found
}

fn refuse_joints(element: &Element) -> Result<(), LoadError> {
    let is_joint = |part: &&Element| part.tag == "joint" || part.tag == "freejoint";
    match of_the_body(element).into_iter().find(is_joint) {
        Some(joint) => Err(joint
            .error("cannot be repeated in one body; put it into a <body> inside of <replicate>")),
        None => Ok(()),
    }
}

/// Drops the inertia of the enclosing body, which, as in MuJoCo, is neither repeated nor retained.
pub(super) fn drop_inertia(element: &mut Element) {
    let mut pending = vec![element];
    while let Some(part) = pending.pop() {
        part.children.retain(|child| child.tag != "inertial");
        pending.extend(
            part.children
                .iter_mut()
                .filter(|child| child.tag == "frame"),
        );
    }
}
