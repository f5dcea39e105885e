//! `<geom>`.

use super::appearance::{Palette, read_appearance};
use super::compiler::CompilerOptions;
use super::linear_map::{Deformation, LinearMap};
use super::orientation::{Orientation, Pose, segment};
use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{GeomMass, GeomSpec};
use clench_collide::ShapeKind;
use clench_math::Vec3;

const KINDS: [(&str, Option<ShapeKind>); 9] = [
    ("plane", Some(ShapeKind::Plane)),
    ("hfield", Some(ShapeKind::HeightField)),
    ("sphere", Some(ShapeKind::Sphere)),
    ("capsule", Some(ShapeKind::Capsule)),
    ("ellipsoid", Some(ShapeKind::Ellipsoid)),
    ("cylinder", Some(ShapeKind::Cylinder)),
    ("box", Some(ShapeKind::Box)),
    ("mesh", Some(ShapeKind::Mesh)),
    ("sdf", None),
];

/// Overwrites the shape if `type` names one; `None` stands for a signed distance field.
pub(crate) fn read_kind(element: &Element, kind: &mut Option<ShapeKind>) -> Result<(), LoadError> {
    element.set_keyword("type", &KINDS, kind)
}

/// Returns the shape of an element of the model; a default class may have any.
///
/// # Errors
/// Returns an error for a signed distance field.
pub(crate) fn require_supported(
    kind: Option<ShapeKind>,
    element: &Element,
) -> Result<ShapeKind, LoadError> {
    kind.ok_or_else(|| element.error("the type \"sdf\" is not supported yet"))
}

/// A geom as written in an element or a default class.
#[derive(Clone, Debug)]
pub(crate) struct GeomDraft {
    pub spec: GeomSpec,
    kind: Option<ShapeKind>,
    size: [f64; 3],
    pos: [f64; 3],
    orientation: Orientation,
    fromto: Option<[f64; 6]>,
    mass: Option<f64>,
    density: f64,
}

impl Default for GeomDraft {
    fn default() -> Self {
        GeomDraft {
            spec: GeomSpec::default(),
            kind: Some(ShapeKind::Sphere),
            size: [0.0; 3],
            pos: [0.0; 3],
            orientation: Orientation::default(),
            fromto: None,
            mass: None,
            density: 1000.0,
        }
    }
}

impl GeomDraft {
    /// Overwrites the values that the element has.
    pub(super) fn read(&mut self, element: &Element) -> Result<(), LoadError> {
        let geom = &mut self.spec;
        read_kind(element, &mut self.kind)?;
        geom.contype = read_mask(element, "contype", geom.contype)?;
        geom.conaffinity = read_mask(element, "conaffinity", geom.conaffinity)?;
        if let Some(condim) = read_condim(element)? {
            geom.condim = condim;
        }
        element.overlay("friction", &mut geom.friction)?;
        element.set_integer("priority", &mut geom.priority)?;
        element.set_number("solmix", &mut geom.solmix)?;
        element.overlay("solref", &mut geom.solref)?;
        element.overlay("solimp", &mut geom.solimp)?;
        element.set_number("margin", &mut geom.margin)?;
        element.set_number("gap", &mut geom.gap)?;
        element.overlay("surfacevel", &mut geom.surfacevel)?;
        element.set_number("adhesion", &mut geom.adhesion)?;
        let shapes = [("none", false), ("ellipsoid", true)];
        element.set_keyword("fluidshape", &shapes, &mut geom.fluid_ellipsoid)?;
        element.overlay("fluidcoef", &mut geom.fluidcoef)?;
        element.set_boolean("shellinertia", &mut geom.shellinertia)?;
        element.set_integer("group", &mut geom.group)?;
        if let Some(mesh) = element.text("mesh") {
            mesh.clone_into(&mut geom.mesh);
        }
        if let Some(hfield) = element.text("hfield") {
            hfield.clone_into(&mut geom.hfield);
        }
        read_appearance(element, &mut geom.appearance)?;
        element.set_number("fitscale", &mut geom.fitscale)?;
        element.set_user(&mut geom.user)?;
        element.overlay("size", &mut self.size)?;
        element.set_numbers("pos", &mut self.pos)?;
        self.orientation.read(element)?;
        self.fromto = element.numbers("fromto")?.or(self.fromto);
        self.mass = element.numbers("mass")?.map(|[mass]| mass).or(self.mass);
        element.set_number("density", &mut self.density)
    }

    /// Returns the length of its texts, bytes.
    pub(super) fn text_length(&self) -> usize {
        self.spec.mesh.len() + self.spec.hfield.len()
    }

    /// Returns the names of assets that it has: of a mesh, of a height field and of a material.
    pub(super) fn assets(&self) -> [&str; 3] {
        let geom = &self.spec;
        [&geom.mesh, &geom.hfield, &geom.appearance.material]
    }

    /// Returns the geom in its body, with shorthand resolved, and the deformation of its shape by the enclosing frames.
    pub(super) fn finish(
        mut self,
        element: &Element,
        compiler: &CompilerOptions,
        palette: &Palette,
        frame: &Pose,
    ) -> Result<(GeomSpec, Deformation), LoadError> {
        self.spec.kind = require_supported(self.kind, element)?;
        let (pose, deformation) = match self.fromto {
            Some(_) if !self.spec.mesh.is_empty() => {
                return Err(element.error("fromto and mesh cannot both be given"));
            }
            Some(points) => {
                let size = &mut self.size;
                segment_pose(points, self.pos, self.spec.kind, size, element, frame)?
            }
            None => frame.carry(Pose {
                pos: Vec3::from_array(self.pos),
                quat: self.orientation.resolve(compiler, element)?,
                ..Pose::IDENTITY
            }),
        };
        let appearance = palette.of_geom(self.spec.appearance, &self.spec.mesh);
        let spec = GeomSpec {
            name: element.string("name"),
            visible: palette.shows(&appearance),
            appearance,
            size: Vec3::from_array(self.size),
            pos: pose.pos,
            quat: pose.quat,
            mass: match self.mass {
                Some(mass) => GeomMass::Mass(mass),
                None => GeomMass::Density(self.density),
            },
            origin: Some(element.origin.clone()),
            ..self.spec
        };
        Ok((spec, deformation))
    }
}

/// Returns the pose, in the body, of a shape between two points of a frame, whose distance becomes its size along z. If
/// the frame's scales differ between axes, the points are mapped.
pub(crate) fn segment_pose(
    points: [f64; 6],
    pos: [f64; 3],
    kind: ShapeKind,
    size: &mut [f64; 3],
    element: &Element,
    frame: &Pose,
) -> Result<(Pose, Deformation), LoadError> {
    if pos != [0.0; 3] {
        return Err(element.error("pos and fromto cannot both be given"));
    }
    let (written, mut half_length) = segment(points, element)?;
    let (mut pose, mut deformation) = frame.carry(written);
    if let LinearMap::General(map) = frame.linear_map {
        let [x0, y0, z0, x1, y1, z1] = points;
        let [from, to] = [Vec3::new(x0, y0, z0), Vec3::new(x1, y1, z1)].map(|point| map * point);
        let mapped = [from.x, from.y, from.z, to.x, to.y, to.z];
        let (between, half) = segment(mapped, element)?;
        let rigid = Pose {
            linear_map: LinearMap::NONE,
            ..*frame
        };
        (pose, half_length) = (rigid.then(between), half);
        deformation.segment = true;
    }
    match kind {
        ShapeKind::Capsule | ShapeKind::Cylinder => size[1] = half_length,
        ShapeKind::Ellipsoid | ShapeKind::Box => *size = [size[0], size[0], half_length],
        ShapeKind::Plane | ShapeKind::Sphere | ShapeKind::HeightField | ShapeKind::Mesh => {
            return Err(element.incomplete("fromto needs a capsule, cylinder, box or ellipsoid"));
        }
    }
    Ok((pose, deformation))
}

/// Reads contact bits: a 32-bit integer used as a bit mask.
fn read_mask(element: &Element, name: &str, current: u32) -> Result<u32, LoadError> {
    Ok(element.integer(name)?.map_or(current, |bits| bits as u32))
}

/// Reads the contact dimension.
pub(crate) fn read_condim(element: &Element) -> Result<Option<u32>, LoadError> {
    match element.integer("condim")? {
        Some(condim @ (1 | 3 | 4 | 6)) => Ok(Some(condim as u32)),
        Some(condim) => Err(element.error(format!("condim is {condim}, not 1, 3, 4 or 6"))),
        None => Ok(None),
    }
}
