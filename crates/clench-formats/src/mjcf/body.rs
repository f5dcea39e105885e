//! `<worldbody>` and what is in it: bodies, frames, replicas and the elements that bodies carry.

use super::assets::Visibility;
use super::compiler::CompilerOptions;
use super::defaults::{Classes, MAIN};
use super::document::Element;
use super::joint;
use super::orientation::{Orientation, Pose};
use crate::LoadError;
use crate::spending::Spending;
use clench_math::{Mat3, Quat, Vec3};
use clench_rigid::builder::{BodySpec, GeomSpec, InertiaSpec, InertialSpec, JointSpec, SiteSpec};
use std::collections::HashSet;

/// Reads the body tree into a list of bodies, parents before children.
pub(crate) struct BodyReader<'a> {
    compiler: &'a CompilerOptions,
    classes: &'a Classes,
    visibility: &'a Visibility,
    bodies: &'a mut Vec<BodySpec>,
    spending: &'a mut Spending,
    /// Names in the file that stand for several elements of the model.
    pub replicated: HashSet<String>,
}

/// What is read of an element stands in the builder, then in the model, and for a while in both.
const COPIES: usize = 3;

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

/// An element whose children are being read.
struct Level<'e> {
    element: &'e Element,
    /// The next child.
    next: usize,
    place: Place,
    replicas: Option<Replicas>,
}

/// Where the replicas of a `<replicate>` stand.
struct Replicas {
    /// How many there are, and the one being read.
    count: usize,
    current: usize,
    /// Where `<replicate>` itself stands.
    around: Place,
    class: usize,
    separator: String,
    euler: [f64; 3],
    /// From each to the next, and from the first to the current one.
    step: Pose,
    displaced: Pose,
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
        compiler: &'a CompilerOptions,
        classes: &'a Classes,
        visibility: &'a Visibility,
        bodies: &'a mut Vec<BodySpec>,
        spending: &'a mut Spending,
    ) -> Self {
        BodyReader {
            compiler,
            classes,
            visibility,
            bodies,
            spending,
            replicated: HashSet::new(),
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
        let mut open = vec![Level::new(element, world)];
        while let Some(level) = open.last_mut() {
            let Some(child) = level.element.children.get(level.next) else {
                if !self.begin_next_replica(level)? {
                    open.pop();
                }
                continue;
            };
            level.next += 1;
            if !level.place.suffix.is_empty() {
                let excess = |excess| child.error(excess);
                self.spending.elements(1).map_err(excess)?;
                self.charge(child, 0, &[&level.place.suffix])?;
            }
            let place = &level.place;
            let entered = match child.tag.as_str() {
                "body" => Some(self.enter_body(child, place)?),
                "frame" => Some(self.enter_frame(child, place)?),
                "replicate" => Some(self.enter_replicate(child, place)?),
                _ => {
                    self.read_part(child, place)?;
                    None
                }
            };
            open.extend(entered);
        }
        Ok(())
    }

    /// Takes the memory of an element of this size with these texts.
    fn charge(&mut self, element: &Element, size: usize, texts: &[&str]) -> Result<(), LoadError> {
        let texts: usize = texts.iter().map(|text| text.len()).sum();
        let bytes = COPIES * (size + texts);
        let charged = self.spending.bytes(bytes as u64);
        charged.map_err(|excess| element.error(excess))
    }

    fn enter_body<'e>(
        &mut self,
        element: &'e Element,
        place: &Place,
    ) -> Result<Level<'e>, LoadError> {
        self.push_body(element, place)?;
        let inside = Place {
            body: self.bodies.len() - 1,
            class: self.classes.named_by(element, "childclass", place.class)?,
            frame: Pose::IDENTITY,
            ..place.clone()
        };
        Ok(Level::new(element, inside))
    }

    fn push_body(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        let written = Pose::read(element, self.compiler)?;
        let pose = place.frame.then(written);
        let mut body = BodySpec {
            name: self.named(element, place)?,
            parent: place.body,
            pos: pose.pos,
            quat: pose.quat,
            written: Some((written.pos, written.quat)),
            origin: Some(element.origin.clone()),
            ..BodySpec::default()
        };
        element.set_boolean("mocap", &mut body.mocap)?;
        let simple = element.keyword("simple", &[("false", false), ("auto", true)])?;
        body.never_simple = simple == Some(false);
        element.set_number("gravcomp", &mut body.gravcomp)?;
        self.charge(element, size_of::<BodySpec>(), &[&body.name])?;
        self.bodies.push(body);
        Ok(())
    }

    fn enter_frame<'e>(&self, element: &'e Element, place: &Place) -> Result<Level<'e>, LoadError> {
        let class = self.classes.named_by(element, "class", place.class)?;
        let inside = Place {
            class: self.classes.named_by(element, "childclass", class)?,
            frame: place.frame.then(Pose::read(element, self.compiler)?),
            ..place.clone()
        };
        Ok(Level::new(element, inside))
    }

    /// The first of the replicas; each stands displaced once more, and its number in the names in it.
    fn enter_replicate<'e>(
        &self,
        element: &'e Element,
        place: &Place,
    ) -> Result<Level<'e>, LoadError> {
        let count = element
            .count("count")?
            .ok_or_else(|| element.missing("count"))?;
        if count == 0 {
            return Err(element.error("count must be positive"));
        }
        let offset = Vec3::from_array(element.numbers("offset")?.unwrap_or_default());
        let euler: [f64; 3] = element.numbers("euler")?.unwrap_or_default();
        let class = self.classes.named_by(element, "class", place.class)?;
        let replicas = Replicas {
            count,
            current: 0,
            around: place.clone(),
            class: self.classes.named_by(element, "childclass", class)?,
            separator: element.string("sep"),
            euler,
            step: Pose {
                pos: offset,
                quat: self.compiler.euler(euler),
            },
            displaced: Pose::IDENTITY,
        };
        Ok(Level {
            place: replicas.place(),
            replicas: Some(replicas),
            ..Level::new(element, place.clone())
        })
    }

    /// Goes back to the first child, for the next replica; false where there is none.
    fn begin_next_replica(&mut self, level: &mut Level) -> Result<bool, LoadError> {
        let Some(replicas) = &mut level.replicas else {
            return Ok(false);
        };
        replicas.current += 1;
        if replicas.current == replicas.count {
            return Ok(false);
        }
        let excess = |excess| level.element.error(excess);
        self.spending.elements(1).map_err(excess)?;
        replicas.displaced = replicas.displaced.then(replicas.step);
        // As in MuJoCo, angles are multiplied rather than rotations accumulated, so that no error builds up.
        let angles = replicas.euler.map(|angle| angle * replicas.current as f64);
        replicas.displaced.quat = self.compiler.euler(angles);
        level.place = replicas.place();
        level.next = 0;
        Ok(true)
    }

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
                self.push_joint(joint, element, place)?;
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
            quat: orientation.resolve(self.compiler, element)?,
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
    fn named(&mut self, element: &Element, place: &Place) -> Result<String, LoadError> {
        let name = element.string("name");
        if name.is_empty() || place.suffix.is_empty() {
            return Ok(name);
        }
        self.charge(element, 0, &[&name, &place.suffix])?;
        let full = format!("{name}{}", place.suffix);
        self.replicated.insert(name);
        Ok(full)
    }

    fn class(&self, element: &Element, place: &Place) -> Result<usize, LoadError> {
        self.classes.named_by(element, "class", place.class)
    }

    fn read_joint(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        let mut joint = self.classes[self.class(element, place)?].joint.clone();
        joint::read(element, &mut joint)?;
        let joint = joint::finish(joint, self.compiler, &place.frame);
        self.push_joint(joint, element, place)
    }

    fn push_joint(
        &mut self,
        joint: JointSpec,
        element: &Element,
        place: &Place,
    ) -> Result<(), LoadError> {
        let name = self.named(element, place)?;
        self.charge(element, size_of::<JointSpec>(), &[&name])?;
        self.bodies[place.body].joints.push(JointSpec {
            name,
            origin: Some(element.origin.clone()),
            ..joint
        });
        Ok(())
    }

    fn read_geom(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        let mut geom = self.classes[self.class(element, place)?].geom.clone();
        geom.read(element)?;
        let bytes = size_of::<GeomSpec>() + geom.text_length();
        self.charge(element, bytes, &[])?;
        let mut geom = geom.finish(element, self.compiler, self.visibility, &place.frame)?;
        geom.name = self.named(element, place)?;
        self.bodies[place.body].geoms.push(geom);
        Ok(())
    }

    fn read_site(&mut self, element: &Element, place: &Place) -> Result<(), LoadError> {
        let mut site = self.classes[self.class(element, place)?].site.clone();
        site.read(element)?;
        let mut site = site.finish(element, self.compiler, &place.frame)?;
        site.name = self.named(element, place)?;
        self.charge(element, size_of::<SiteSpec>(), &[&site.name])?;
        self.bodies[place.body].sites.push(site);
        Ok(())
    }
}

impl<'e> Level<'e> {
    /// An element that is read once.
    fn new(element: &'e Element, place: Place) -> Self {
        Level {
            element,
            next: 0,
            place,
            replicas: None,
        }
    }
}

impl Replicas {
    /// Where the current one stands.
    fn place(&self) -> Place {
        let (number, digits) = (self.current, self.count.to_string().len());
        Place {
            class: self.class,
            frame: self.around.frame.then(self.displaced),
            suffix: format!("{}{number:0digits$}{}", self.separator, self.around.suffix),
            replicated_in: Some(self.around.body),
            ..self.around.clone()
        }
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
