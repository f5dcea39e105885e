//! `<site>`: a frame, and a volume for sensors.

use super::appearance::read_appearance;
use super::compiler::CompilerOptions;
use super::geom::{read_kind, require_supported, segment_pose};
use super::linear_map::Deformation;
use super::orientation::{Orientation, Pose};
use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{AppearanceSpec, SiteSpec};
use clench_collide::ShapeKind;
use clench_math::Vec3;
use std::sync::Arc;

/// A site as written in an element or a default class.
#[derive(Clone, Debug)]
pub(crate) struct SiteDraft {
    kind: Option<ShapeKind>,
    mesh: String,
    size: [f64; 3],
    pos: [f64; 3],
    orientation: Orientation,
    fromto: Option<[f64; 6]>,
    group: i32,
    appearance: AppearanceSpec,
    user: Arc<[f64]>,
}

impl Default for SiteDraft {
    fn default() -> Self {
        SiteDraft {
            kind: Some(ShapeKind::Sphere),
            mesh: String::new(),
            size: [0.005; 3],
            pos: [0.0; 3],
            orientation: Orientation::default(),
            fromto: None,
            group: 0,
            appearance: AppearanceSpec::default(),
            user: Arc::default(),
        }
    }
}

impl SiteDraft {
    /// Overwrites the values that the element has.
    pub(super) fn read(&mut self, element: &Element) -> Result<(), LoadError> {
        read_kind(element, &mut self.kind)?;
        match self.kind {
            Some(ShapeKind::Plane) => return Err(element.error("a site cannot be a plane")),
            Some(ShapeKind::HeightField) => {
                return Err(element.error("a site cannot be a height field"));
            }
            _ => {}
        }
        if let Some(mesh) = element.text("mesh") {
            mesh.clone_into(&mut self.mesh);
        }
        element.overlay("size", &mut self.size)?;
        element.set_numbers("pos", &mut self.pos)?;
        self.orientation.read(element)?;
        self.fromto = element.numbers("fromto")?.or(self.fromto);
        element.set_integer("group", &mut self.group)?;
        element.set_user(&mut self.user)?;
        read_appearance(element, &mut self.appearance)
    }

    /// Returns the names of assets that it has: of a mesh and of a material.
    pub(super) fn assets(&self) -> [&str; 2] {
        [&self.mesh, &self.appearance.material]
    }

    /// Returns the site in its body, and the deformation of its shape by the enclosing frames.
    pub(super) fn finish(
        mut self,
        element: &Element,
        compiler: &CompilerOptions,
        frame: &Pose,
    ) -> Result<(SiteSpec, Deformation), LoadError> {
        let kind = require_supported(self.kind, element)?;
        let (pose, deformation) = match self.fromto {
            Some(points) => segment_pose(points, self.pos, kind, &mut self.size, element, frame)?,
            None => frame.carry(Pose {
                pos: Vec3::from_array(self.pos),
                quat: self.orientation.resolve(compiler, element)?,
                ..Pose::IDENTITY
            }),
        };
        let spec = SiteSpec {
            name: element.string("name"),
            pos: pose.pos,
            quat: pose.quat,
            kind,
            mesh: self.mesh,
            size: self.size,
            group: self.group,
            appearance: self.appearance,
            user: self.user,
            origin: Some(element.origin.clone()),
        };
        Ok((spec, deformation))
    }
}
