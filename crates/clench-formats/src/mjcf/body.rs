//! `<worldbody>` and its contents: bodies, frames and the elements of bodies.

use super::appearance::Palette;
use super::compiler::CompilerOptions;
use super::defaults::{Classes, MAIN};
use super::joint;
use super::linear_map::LinearMap;
use super::orientation::{Orientation, Pose};
use super::scale::{FrameId, Frames, Named};
use super::source::Sources;
use crate::document::Element;
use crate::error::LoadError;
use crate::spending::Spending;
use clench_builder::{
    BodySpec, CameraSpec, CompilerSpec, GeomSpec, InertiaSpec, InertialSpec, JointSpec, LightSpec,
    SiteSpec,
};
use clench_dynamics::model::SleepPolicy;
use clench_math::{Mat3, Quat, Vec3};
use std::sync::Arc;

/// A reader of the body tree into a list of bodies, parents before children.
pub(crate) struct BodyReader<'a> {
    sources: &'a Sources,
    palette: &'a Palette,
    bodies: &'a mut Vec<BodySpec>,
    spending: &'a mut Spending,
    /// The body and the number of each joint.
    joints: Vec<(usize, u32)>,
    /// The number of each mocap body.
    mocaps: Vec<u32>,
    frames: Frames,
}

/// The numbers by which keyframes of attached models refer to a model's joints and mocap bodies, in its order.
#[derive(Debug, Default)]
pub(crate) struct Numbers {
    pub joints: Vec<u32>,
    pub mocaps: Vec<u32>,
}

const SLEEP_POLICIES: [(&str, SleepPolicy); 4] = [
    ("auto", SleepPolicy::Auto),
    ("never", SleepPolicy::Never),
    ("allowed", SleepPolicy::Allowed),
    ("init", SleepPolicy::Init),
];

/// The memory factor of an element: stored in the builder, then in the model, for a while in both.
const COPIES: usize = 3;

/// The context of an element: the body, default class and frame that enclose it.
#[derive(Clone)]
struct Context {
    /// The body that contains the elements.
    body: usize,
    /// The default class of elements without a class.
    class: usize,
    /// The enclosing frame.
    frame: Pose,
    /// The innermost enclosing frame that scales.
    scale: FrameId,
}

impl Context {
    /// Returns the linear map of positions by the enclosing frames, in body axes.
    fn in_body(&self) -> LinearMap {
        self.frame.linear_map.rotated(self.frame.quat.conjugate())
    }
}

/// An element whose children are being read.
struct Level<'e> {
    element: &'e Element,
    /// The index of the next child.
    next: usize,
    context: Context,
}

/// Returns the empty world.
pub(crate) fn world() -> BodySpec {
    BodySpec {
        name: "world".to_owned(),
        quat: Quat::IDENTITY,
        ..BodySpec::default()
    }
}

impl<'a> BodyReader<'a> {
    /// Creates a reader that adds to a list of bodies, which begins with the world.
    pub(super) fn new(
        sources: &'a Sources,
        palette: &'a Palette,
        bodies: &'a mut Vec<BodySpec>,
        spending: &'a mut Spending,
    ) -> Self {
        BodyReader {
            sources,
            palette,
            bodies,
            spending,
            joints: Vec::new(),
            mocaps: Vec::new(),
            frames: Frames::default(),
        }
    }

    /// Returns the numbers of the elements read, and the frames that scale.
    pub(super) fn finish(mut self) -> (Numbers, Frames) {
        self.joints.sort_by_key(|&(body, _)| body);
        let numbers = Numbers {
            joints: self.joints.into_iter().map(|(_, number)| number).collect(),
            mocaps: self.mocaps,
        };
        (numbers, self.frames)
    }

    /// Reads one `<worldbody>`.
    pub(super) fn read_world(&mut self, element: &Element) -> Result<(), LoadError> {
        let world = Context {
            body: 0,
            class: MAIN,
            frame: Pose::IDENTITY,
            scale: 0,
        };
        let mut open = vec![Level {
            element,
            next: 0,
            context: world,
        }];
        while let Some(level) = open.last_mut() {
            let Some(child) = level.element.children.get(level.next) else {
                open.pop();
                continue;
            };
            level.next += 1;
            let context = &level.context;
            let opened = match child.tag.as_str() {
                "body" => Some(self.open_body(child, context)?),
                "frame" => Some(self.open_frame(child, context)?),
                _ => {
                    self.read_part(child, context)?;
                    None
                }
            };
            open.extend(opened);
        }
        Ok(())
    }

    /// Counts an element of this size with these texts against the budget.
    fn consume(&mut self, element: &Element, size: usize, texts: &[&str]) -> Result<(), LoadError> {
        let texts: usize = texts.iter().map(|text| text.len()).sum();
        let bytes = COPIES * (size + texts);
        let consumed = self.spending.bytes(bytes as u64);
        consumed.map_err(|excess| element.error(excess))
    }

    fn open_body<'e>(
        &mut self,
        element: &'e Element,
        context: &Context,
    ) -> Result<Level<'e>, LoadError> {
        let linear_map = self.push_body(element, context)?;
        let inside = Context {
            body: self.bodies.len() - 1,
            class: self
                .classes(element)
                .named_by(element, "childclass", context.class)?,
            frame: Pose {
                linear_map,
                ..Pose::IDENTITY
            },
            scale: context.scale,
        };
        Ok(Level {
            element,
            next: 0,
            context: inside,
        })
    }

    /// Reads a body without its contents, and returns the enclosing frames' map of positions in its axes.
    fn push_body(&mut self, element: &Element, context: &Context) -> Result<LinearMap, LoadError> {
        let written = Pose::read(element, self.compiler(element))?;
        let pose = context.frame.then(written);
        let mut body = BodySpec {
            name: element.string("name"),
            parent: context.body,
            pos: pose.pos,
            quat: pose.quat,
            written: Some((context.frame.linear_map.apply(written.pos), written.quat)),
            compiler: self.own_settings(element),
            origin: Some(element.origin.clone()),
            ..BodySpec::default()
        };
        element.set_boolean("mocap", &mut body.mocap)?;
        if let Some(policy) = element.keyword("sleep", &SLEEP_POLICIES)? {
            body.sleep = policy;
        }
        let simple = element.keyword("simple", &[("false", false), ("auto", true)])?;
        body.never_simple = simple == Some(false);
        let fused = element.keyword("fuse", &[("false", false), ("auto", true)])?;
        body.never_fused = fused == Some(false);
        element.set_number("gravcomp", &mut body.gravcomp)?;
        element.set_user(&mut body.user)?;
        self.consume(element, size_of::<BodySpec>(), &[&body.name])?;
        if body.mocap {
            self.mocaps.push(element.number);
        }
        self.frames.add_body(&body, context.scale, pose.linear_map);
        self.bodies.push(body);
        Ok(pose.linear_map)
    }

    fn open_frame<'e>(
        &mut self,
        element: &'e Element,
        context: &Context,
    ) -> Result<Level<'e>, LoadError> {
        let mut frame = context
            .frame
            .then(Pose::read(element, self.compiler(element))?);
        let scale = self.frames.add_frame(element, context.scale, &mut frame)?;
        let class = self
            .classes(element)
            .named_by(element, "class", context.class)?;
        let inside = Context {
            class: self
                .classes(element)
                .named_by(element, "childclass", class)?,
            frame,
            scale,
            ..context.clone()
        };
        Ok(Level {
            element,
            next: 0,
            context: inside,
        })
    }

    fn read_part(&mut self, element: &Element, context: &Context) -> Result<(), LoadError> {
        let in_world = |what| Err(element.error(format!("the world cannot have {what}")));
        match element.tag.as_str() {
            "inertial" if context.body == 0 => in_world("inertia")?,
            "joint" | "freejoint" if context.body == 0 => in_world("joints")?,
            "inertial" => self.read_inertial(element, context)?,
            "joint" => self.read_joint(element, context)?,
            "freejoint" => {
                let joint = joint::read_free(element)?;
                self.push_joint(joint, element, context)?;
            }
            "geom" => self.read_geom(element, context)?,
            "site" => self.read_site(element, context)?,
            "camera" => self.read_camera(element, context)?,
            "light" => self.read_light(element, context)?,
            // The schema admits no other element.
            _ => {}
        }
        Ok(())
    }

    fn read_inertial(&mut self, element: &Element, context: &Context) -> Result<(), LoadError> {
        let mut orientation = Orientation::default();
        orientation.read(element)?;
        let pose = context.frame.then(Pose {
            pos: Vec3::from_array(element.required_numbers("pos")?),
            quat: orientation.resolve(self.compiler(element), element)?,
            ..Pose::IDENTITY
        });
        let [mass] = element.required_numbers("mass")?;
        let inertia = read_inertia(element, &context.frame)?;
        let body = &mut self.bodies[context.body];
        if body.inertial.is_some() {
            return Err(element.error("a body can have only one inertial"));
        }
        let mut inertial = InertialSpec {
            pos: pose.pos,
            quat: pose.quat,
            mass,
            inertia,
            origin: Some(element.origin.clone()),
        };
        let scale = self.frames.scale(context.scale);
        scale.inertial(&mut inertial, context.in_body());
        body.inertial = Some(inertial);
        Ok(())
    }

    /// Returns the settings of the body's attached model, if any.
    fn own_settings(&self, element: &Element) -> Option<Arc<CompilerSpec>> {
        let own = &self.sources.of(element).spec;
        (own != &self.sources.main().spec).then(|| own.clone())
    }

    /// Returns the compiler options for an element.
    fn compiler(&self, element: &Element) -> &'a CompilerOptions {
        &self.sources.of(element).compiler
    }

    /// Returns the default classes for an element.
    fn classes(&self, element: &Element) -> &'a Classes {
        &self.sources.of(element).classes
    }

    fn class(&self, element: &Element, context: &Context) -> Result<usize, LoadError> {
        self.classes(element)
            .named_by(element, "class", context.class)
    }

    fn read_joint(&mut self, element: &Element, context: &Context) -> Result<(), LoadError> {
        let mut joint = self.classes(element)[self.class(element, context)?]
            .joint
            .clone();
        joint::read(element, &mut joint)?;
        let mut joint = joint::finish(joint, self.compiler(element), &context.frame);
        let resolve = |what, range, said| self.sources.resolve_limit(element, what, range, said);
        resolve("", joint.range, &mut joint.limited)?;
        resolve(
            "actuatorfrc",
            joint.actuatorfrcrange,
            &mut joint.actuatorfrclimited,
        )?;
        self.push_joint(joint, element, context)
    }

    fn push_joint(
        &mut self,
        joint: JointSpec,
        element: &Element,
        context: &Context,
    ) -> Result<(), LoadError> {
        let name = element.string("name");
        self.consume(element, size_of::<JointSpec>(), &[&name])?;
        self.joints.push((context.body, element.number));
        let mut joint = JointSpec {
            name,
            origin: Some(element.origin.clone()),
            ..joint
        };
        let scaled = self.frames.scale(context.scale);
        let length = scaled.joint(&mut joint, context.in_body());
        let length = length.map_err(|reason| element.error(reason))?;
        (self.frames).add_joint(&joint, context.body, context.scale, length);
        self.bodies[context.body].joints.push(joint);
        Ok(())
    }

    fn read_geom(&mut self, element: &Element, context: &Context) -> Result<(), LoadError> {
        let mut geom = self.classes(element)[self.class(element, context)?]
            .geom
            .clone();
        geom.read(element)?;
        let bytes = size_of::<GeomSpec>() + geom.text_length();
        self.consume(element, bytes, &[])?;
        let (mut geom, deformation) = geom.finish(
            element,
            self.compiler(element),
            self.palette,
            &context.frame,
        )?;
        let scaled = self
            .frames
            .scale(context.scale)
            .geom(&mut geom, deformation);
        scaled.map_err(|reason| element.error(reason))?;
        self.frames.instance(&mut geom.mesh, deformation.linear_map);
        self.frames
            .instance(&mut geom.hfield, deformation.linear_map);
        self.frames.add(Named::Geom, &geom.name, context.scale);
        let number = self.bodies[context.body].geoms.len();
        (self.frames).add_mesh(&geom, context.body, number, context.scale);
        self.bodies[context.body].geoms.push(geom);
        Ok(())
    }

    fn read_site(&mut self, element: &Element, context: &Context) -> Result<(), LoadError> {
        let mut site = self.classes(element)[self.class(element, context)?]
            .site
            .clone();
        site.read(element)?;
        let (mut site, deformation) =
            site.finish(element, self.compiler(element), &context.frame)?;
        self.frames
            .scale(context.scale)
            .site(&mut site, deformation);
        self.frames.instance(&mut site.mesh, deformation.linear_map);
        self.frames.add(Named::Site, &site.name, context.scale);
        self.consume(element, size_of::<SiteSpec>(), &[&site.name])?;
        self.bodies[context.body].sites.push(site);
        Ok(())
    }

    fn read_light(&mut self, element: &Element, context: &Context) -> Result<(), LoadError> {
        let mut light = self.classes(element)[self.class(element, context)?]
            .light
            .clone();
        light.read(element)?;
        let mut light = light.finish(element, &context.frame);
        self.frames.scale(context.scale).light(&mut light);
        self.consume(element, size_of::<LightSpec>(), &[&light.name])?;
        self.bodies[context.body].lights.push(light);
        Ok(())
    }

    fn read_camera(&mut self, element: &Element, context: &Context) -> Result<(), LoadError> {
        let mut camera = self.classes(element)[self.class(element, context)?]
            .camera
            .clone();
        camera.read(element)?;
        let mut camera = camera.finish(element, self.compiler(element), &context.frame)?;
        self.frames.scale(context.scale).camera(&mut camera);
        self.frames.add(Named::Camera, &camera.name, context.scale);
        self.consume(element, size_of::<CameraSpec>(), &[&camera.name])?;
        self.bodies[context.body].cameras.push(camera);
        Ok(())
    }
}

/// Reads moments in the inertial frame, or a matrix in the axes of the enclosing frame, which is rotated to those of
/// the body.
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
    let rotation = frame.quat.to_matrix();
    let [x, y, z] = (rotation * written * rotation.transpose()).rows;
    Ok(InertiaSpec::Full([x.x, y.y, z.z, x.y, x.z, y.z]))
}
