//! `<collision>` and `<visual>`: shapes on links, and `<material>`, which may make them invisible to rays.

use super::element::consume;
use super::meshes::Meshes;
use crate::document::Element;
use crate::error::LoadError;
use crate::mjcf::orientation::Pose;
use crate::spending::Spending;
use clench_builder::{GeomMass, GeomSpec};
use clench_collide::ShapeKind;
use clench_math::{Quat, Vec3};
use std::collections::{HashMap, HashSet};

/// The group of visual shapes, as in MuJoCo.
const VISUAL_GROUP: i32 = 1;

/// The colours of materials, by name.
pub(super) struct Materials(HashMap<String, [f32; 4]>);

impl Materials {
    /// Collects the coloured materials of a whole file; the first of a name takes precedence.
    pub(super) fn read(root: &Element) -> Result<Self, LoadError> {
        let mut found = HashMap::new();
        let mut pending = vec![root];
        while let Some(element) = pending.pop() {
            if element.tag == "material"
                && let Some(name) = element.text("name")
                && !found.contains_key(name)
                && let Some(color) = element.child("color")?
            {
                found.insert(name.to_owned(), read_rgba(color)?);
            }
            pending.extend(element.children.iter().rev());
        }
        Ok(Materials(found))
    }
}

fn read_rgba(color: &Element) -> Result<[f32; 4], LoadError> {
    color.singles("rgba")?.ok_or_else(|| color.missing("rgba"))
}

/// A reader of the shapes of all links.
pub(super) struct GeomReader<'a> {
    pub meshes: Meshes<'a>,
    pub materials: Materials,
    /// The names in use.
    pub names: HashSet<String>,
    pub discard_visual: bool,
}

impl GeomReader<'_> {
    /// Reads the shapes of a link, in order.
    ///
    /// # Errors
    /// Returns an error if a shape is unknown or lacks its sizes, or a mesh is missing.
    pub(super) fn read(
        &mut self,
        link: &Element,
        notes: &mut Vec<String>,
        spending: &mut Spending,
    ) -> Result<Vec<GeomSpec>, LoadError> {
        let mut geoms = Vec::new();
        // The colour of a visual also applies to the shapes after it.
        let mut rgba = None;
        for element in &link.children {
            let visual = match element.tag.as_str() {
                "visual" => true,
                "collision" => false,
                _ => continue,
            };
            if visual {
                self.read_color(element, &mut rgba)?;
                if self.discard_visual {
                    continue;
                }
            }
            let name = self.free_name(element, notes);
            consume(element, size_of::<GeomSpec>(), &[&name], spending)?;
            let mut geom = self.read_shape(element, spending)?;
            geom.name = name;
            geom.visible = rgba.is_none_or(|[.., alpha]| alpha != 0.0);
            geom.appearance.rgba = rgba;
            if visual {
                (geom.contype, geom.conaffinity) = (0, 0);
                geom.group = VISUAL_GROUP;
                geom.mass = GeomMass::Density(0.0);
            }
            geoms.push(geom);
        }
        Ok(geoms)
    }

    fn read_color(&self, visual: &Element, rgba: &mut Option<[f32; 4]>) -> Result<(), LoadError> {
        let Some(material) = visual.child("material")? else {
            return Ok(());
        };
        let found = match material.child("color")? {
            Some(color) => Some(read_rgba(color)?),
            None => self
                .materials
                .0
                .get(material.required_text("name")?)
                .copied(),
        };
        *rgba = found.or(*rgba);
        Ok(())
    }

    /// Returns the name of a shape, or an empty one if the name is taken, as in MuJoCo.
    fn free_name(&mut self, element: &Element, notes: &mut Vec<String>) -> String {
        let name = element.string("name");
        if name.is_empty() || self.names.insert(name.clone()) {
            return name;
        }
        notes.push(format!(
            "line {}: another geom has the name \"{name}\"; this one gets no name",
            element.origin.line
        ));
        String::new()
    }

    fn read_shape(
        &mut self,
        element: &Element,
        spending: &mut Spending,
    ) -> Result<GeomSpec, LoadError> {
        let geometry = element.required_child("geometry")?;
        let mut geom = GeomSpec {
            origin: Some(element.origin.clone()),
            ..GeomSpec::default()
        };
        if let Some(shape) = geometry.child("box")? {
            let size: [f64; 3] = shape.required_numbers("size")?;
            geom.kind = ShapeKind::Box;
            geom.size = Vec3::from_array(size) * 0.5;
        } else if let Some(shape) = geometry.child("cylinder")? {
            geom.kind = ShapeKind::Cylinder;
            geom.size = round(shape)?;
        } else if let Some(shape) = geometry.child("sphere")? {
            let [radius] = shape.required_numbers("radius")?;
            geom.kind = ShapeKind::Sphere;
            geom.size = Vec3::new(radius, 0.0, 0.0);
        } else if let Some(shape) = geometry.child("capsule")? {
            geom.kind = ShapeKind::Capsule;
            geom.size = round(shape)?;
        } else if let Some(shape) = geometry.child("mesh")? {
            geom.kind = ShapeKind::Mesh;
            geom.mesh = self.meshes.read(shape, spending)?;
        } else {
            let message = "needs a <box>, <cylinder>, <sphere>, <capsule> or <mesh>";
            return Err(geometry.error(message));
        }
        let pose = read_origin(element)?;
        (geom.pos, geom.quat) = (pose.pos, pose.quat);
        Ok(geom)
    }
}

/// Returns the radius and half length.
fn round(shape: &Element) -> Result<Vec3<f64>, LoadError> {
    let [radius] = shape.required_numbers("radius")?;
    let [length] = shape.required_numbers("length")?;
    Ok(Vec3::new(radius, length * 0.5, 0.0))
}

/// Reads the pose in `<origin>`: roll, pitch and yaw turn about the fixed axes x, y, z in this order.
pub(super) fn read_origin(element: &Element) -> Result<Pose, LoadError> {
    let Some(origin) = element.child("origin")? else {
        return Ok(Pose::IDENTITY);
    };
    let axes = [
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(0.0, 1.0, 0.0),
        Vec3::new(0.0, 0.0, 1.0),
    ];
    let angles: [f64; 3] = origin.numbers("rpy")?.unwrap_or_default();
    let rotation = |total: Quat<f64>, (axis, angle)| Quat::from_axis_angle(axis, angle) * total;
    let quat = axes.into_iter().zip(angles).fold(Quat::IDENTITY, rotation);
    Ok(Pose {
        pos: Vec3::from_array(origin.numbers("xyz")?.unwrap_or_default()),
        quat: quat.normalize(),
        ..Pose::IDENTITY
    })
}
