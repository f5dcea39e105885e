//! `<worldbody>` and what is in it: bodies, frames, replicas and the elements that bodies carry.

use super::assets::Looks;
use super::compiler::Notation;
use super::defaults::{Classes, MAIN};
use super::document::Element;
use super::joint;
use super::orientation::{Orientation, Pose};
use crate::LoadError;
use clench_math::{Mat3, Quat, Vec3};
use clench_rigid::builder::{BodySpec, InertiaSpec, InertialSpec, JointSpec};
use std::collections::HashSet;

/// Reads the body tree into a list of bodies, parents before children.
pub(crate) struct BodyReader<'a> {
    notation: &'a Notation,
    classes: &'a Classes,
    looks: &'a Looks,
    bodies: &'a mut Vec<BodySpec>,
    /// Names in the file that stand for several elements of the model.
    pub replicated: HashSet<String>,
    replicas: usize,
}

/// More replicas than a file can mean to have; nested ones multiply, and a short file must not fill the memory.
const MAX_REPLICAS: usize = 100_000;

/// Where in the tree the reader is.
#[derive(Clone)]
struct Place {
    /// The body that carries what is read.
    body: usize,
    /// The class that elements without one of their own start from.
    class: usize,
    /// The frame that what is read is written in.
    frame: Pose,
    /// What the enclosing replicas append to names.
    suffix: String,
    /// The body that the innermost replicas are repeated in.
    replicated_in: Option<usize>,
}

/// The world, before anything is on it.
pub(crate) fn world() -> BodySpec {
    BodySpec {
        name: "world".to_owned(),
        quat: Quat::IDENTITY,
        ..BodySpec::default()
    }
}

impl<'a> BodyReader<'a> {
    /// A reader that adds to a list of bodies which begins with the world.
    pub fn new(
        notation: &'a Notation,
        classes: &'a Classes,
        looks: &'a Looks,
        bodies: &'a mut Vec<BodySpec>,
    ) -> Self {
        BodyReader {
            notation,
            classes,
            looks,
            bodies,
            replicated: HashSet::new(),
            replicas: 0,
        }
    }

    /// Reads one `<worldbody>`.
    pub fn read_world(&mut self, element: &Element) -> Result<(), LoadError> {
        let world = Place {
            body: 0,
            class: MAIN,
            frame: Pose::IDENTITY,
            suffix: String::new(),
            replicated_in: None,
        };
        self.read_children(element, &world)
    }

    // The recursion over the tree goes through here, so what needs room on the stack is done in functions of its own.
    fn read_children(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        for child in &element.children {
            match child.tag.as_str() {
                "body" => self.read_body(child, place)?,
                "frame" => self.read_frame(child, place)?,
                "replicate" => self.read_replicate(child, place)?,
                _ => self.read_part(child, place)?,
            }
        }
        Ok(())
    }

    fn read_body(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        self.push_body(element, place)?;
        let inside = Place {
            body: self.bodies.len() - 1,
            class: self.classes.named_by(element, "childclass", place.class)?,
            frame: Pose::IDENTITY,
            ..place.clone()
        };
        self.read_children(element, &inside)
    }

    #[inline(never)]
    fn push_body(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        let pose = place.frame.then(Pose::read(element, self.notation)?);
        let mut body = BodySpec {
            name: self.named(element, place),
            parent: place.body,
            pos: pose.pos,
            quat: pose.quat,
            origin: Some(element.origin.clone()),
            ..BodySpec::default()
        };
        element.set_boolean("mocap", &mut body.mocap)?;
        element.set_number("gravcomp", &mut body.gravcomp)?;
        self.bodies.push(body);
        Ok(())
    }

    fn read_frame(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        let class = self.classes.named_by(element, "class", place.class)?;
        let inside = Place {
            class: self.classes.named_by(element, "childclass", class)?,
            frame: place.frame.then(Pose::read(element, self.notation)?),
            ..place.clone()
        };
        self.read_children(element, &inside)
    }

    /// Reads the children several times, each time displaced once more, with the number of the replica in their names.
    fn read_replicate(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        let count = element
            .count("count")?
            .ok_or_else(|| element.missing("count"))?;
        if count == 0 {
            return Err(element.error("count must be positive"));
        }
        self.replicas = self.replicas.saturating_add(count);
        if self.replicas > MAX_REPLICAS {
            return Err(element.error(format!("there are more than {MAX_REPLICAS} replicas")));
        }
        let offset = Vec3::from_array(element.numbers("offset")?.unwrap_or_default());
        let euler: [f64; 3] = element.numbers("euler")?.unwrap_or_default();
        let class = self.classes.named_by(element, "class", place.class)?;
        let class = self.classes.named_by(element, "childclass", class)?;
        let (separator, digits) = (element.string("sep"), count.to_string().len());
        let turn = self.notation.euler(euler);
        let mut displaced = Pose::IDENTITY;
        for replica in 0..count {
            // As in MuJoCo, angles are multiplied rather than rotations accumulated, so that no error builds up.
            displaced.quat = self
                .notation
                .euler(euler.map(|angle| angle * replica as f64));
            let inside = Place {
                class,
                frame: place.frame.then(displaced),
                suffix: format!("{separator}{replica:0digits$}{}", place.suffix),
                replicated_in: Some(place.body),
                ..place.clone()
            };
            self.read_children(element, &inside)?;
            displaced = displaced.then(Pose {
                pos: offset,
                quat: turn,
            });
        }
        Ok(())
    }

    #[inline(never)]
    fn read_part(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        let in_world = |what| Err(element.error(format!("the world cannot have {what}")));
        let of_a_body = matches!(element.tag.as_str(), "inertial" | "joint" | "freejoint");
        if of_a_body && place.replicated_in == Some(place.body) {
            let message =
                "cannot be repeated in one body; put it into a <body> inside of <replicate>";
            return Err(element.error(message));
        }
        match element.tag.as_str() {
            "inertial" if place.body == 0 => in_world("inertia")?,
            "joint" | "freejoint" if place.body == 0 => in_world("joints")?,
            "inertial" => self.read_inertial(element, place)?,
            "joint" => self.read_joint(element, place)?,
            "freejoint" => {
                let joint = joint::read_free(element)?;
                self.push_joint(joint, element, place);
            }
            "geom" => self.read_geom(element, place)?,
            "site" => self.read_site(element, place)?,
            // Cameras and lights; the schema lets nothing else through.
            _ => {}
        }
        Ok(())
    }

    fn read_inertial(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        let mut orientation = Orientation::default();
        orientation.read(element)?;
        let pose = place.frame.then(Pose {
            pos: Vec3::from_array(element.required_numbers("pos")?),
            quat: orientation.resolve(self.notation, element)?,
        });
        let [mass] = element.required_numbers("mass")?;
        let inertia = read_inertia(element, &place.frame)?;
        let body = &mut self.bodies[place.body];
        if body.inertial.is_some() {
            return Err(element.error("a body can have only one inertial"));
        }
        body.inertial = Some(InertialSpec {
            pos: pose.pos,
            quat: pose.quat,
            mass,
            inertia,
            origin: Some(element.origin.clone()),
        });
        Ok(())
    }

    /// The name of an element with what replicas append to it; what has no name keeps none.
    fn named(&mut self, element: &Element, place: &Place) -> String {
        let name = element.string("name");
        if name.is_empty() || place.suffix.is_empty() {
            return name;
        }
        let full = format!("{name}{}", place.suffix);
        self.replicated.insert(name);
        full
    }

    fn class(&self, element: &Element, place: &Place) -> Result<usize, LoadError> {
        self.classes.named_by(element, "class", place.class)
    }

    fn read_joint(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        let mut joint = self.classes[self.class(element, place)?].joint.clone();
        joint::read(element, &mut joint)?;
        let joint = joint::finish(joint, self.notation, &place.frame);
        self.push_joint(joint, element, place);
        Ok(())
    }

    fn push_joint(&mut self, joint: JointSpec, element: &Element, place: &Place) {
        let name = self.named(element, place);
        self.bodies[place.body].joints.push(JointSpec {
            name,
            origin: Some(element.origin.clone()),
            ..joint
        });
    }

    fn read_geom(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        let mut geom = self.classes[self.class(element, place)?].geom.clone();
        geom.read(element)?;
        let mut geom = geom.finish(element, self.notation, self.looks, &place.frame)?;
        geom.name = self.named(element, place);
        self.bodies[place.body].geoms.push(geom);
        Ok(())
    }

    fn read_site(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        let mut site = self.classes[self.class(element, place)?].site.clone();
        site.read(element)?;
        let mut site = site.finish(element, self.notation, &place.frame)?;
        site.name = self.named(element, place);
        self.bodies[place.body].sites.push(site);
        Ok(())
    }
}

/// Moments in the inertial frame, or a matrix in the axes of the frame that the element is written in, which is turned
/// into those of the body.
fn read_inertia(element: &Element, frame: &Pose) -> Result<InertiaSpec, LoadError> {
    let Some([xx, yy, zz, xy, xz, yz]) = element.numbers("fullinertia")? else {
        let moments = element.numbers("diaginertia")?;
        return Ok(InertiaSpec::Diagonal(moments.unwrap_or_default()));
    };
    let others = [
        "quat",
        "axisangle",
        "euler",
        "xyaxes",
        "zaxis",
        "diaginertia",
    ];
    if let Some(other) = others.iter().find(|name| element.text(name).is_some()) {
        return Err(element.error(format!("fullinertia and {other} cannot both be given")));
    }
    let written = Mat3 {
        rows: [
            Vec3::new(xx, xy, xz),
            Vec3::new(xy, yy, yz),
            Vec3::new(xz, yz, zz),
        ],
    };
    let turn = frame.quat.to_matrix();
    let [x, y, z] = (turn * written * turn.transpose()).rows;
    Ok(InertiaSpec::Full([x.x, y.y, z.z, x.y, x.z, y.z]))
}
