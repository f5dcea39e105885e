//! The shapes that rays hit.

use crate::items;
use crate::light::FAR;
use crate::looks::Looks;
use clench::collide::{HeightField, Pose, ShapeKind, TriangleMesh};
use clench::math::{Mat3, Real, Vec3};
use clench::rigid::{Precision, Sim};
use clench::{Model, SimError};

/// A shape that rays hit: a visible geom or a tendon segment.
pub(super) struct Target<'a> {
    /// The geom, or −1.
    pub(super) geom: i32,
    pub(super) kind: ShapeKind,
    pub(super) size: Vec3<f64>,
    pub(super) pose: Pose<f64>,
    pub(super) mesh: Option<&'a TriangleMesh>,
    pub(super) field: Option<&'a HeightField>,
    /// The radius of a ball around the origin that contains the shape, m; `None` for a plane.
    pub(super) radius: Option<f64>,
}

/// Returns the visible geoms and the tendons in the present state of a simulation, as a device draws them: infinite
/// planes end, and sites are omitted.
pub(super) fn targets<'a, T: Precision>(
    model: &'a Model,
    sim: &mut Sim<T>,
    (groups, looks): (&[usize], Option<&Looks>),
    extent: f32,
) -> Result<Vec<Target<'a>>, SimError> {
    let places = sim.output("geom_xpos")?;
    let rotations = sim.output("geom_xmat")?;
    let mut all = Vec::new();
    for (g, geom) in model.geoms.iter().enumerate() {
        let own = looks.and_then(|looks| looks.geom_rgba.get(g)).copied();
        let color = own.unwrap_or_else(|| model.visuals.rgba(model.visuals.geoms[g]));
        if !groups.contains(&(geom.group as usize)) || color[3] <= 0.0 {
            continue;
        }
        let params = sim.params();
        let mut size = params.geom_size[g].lane(0).to_array().map(T::to_f64);
        let radius = params.geom_rbound[g].lane(0).to_f64();
        let plane = geom.kind == ShapeKind::Plane;
        for side in size[..2].iter_mut().filter(|side| plane && **side <= 0.0) {
            *side = f64::from(FAR * extent);
        }
        let mesh = geom.mesh.and_then(|mesh| model.meshes.get(mesh));
        let numbers = |all: &[T], k: usize| [k, k + 1, k + 2].map(|k| all[k].to_f64());
        let row = |k: usize| Vec3::from_array(numbers(&rotations, 9 * g + 3 * k));
        all.push(Target {
            geom: g as i32,
            kind: geom.kind,
            size: Vec3::from_array(size),
            pose: Pose {
                position: Vec3::from_array(numbers(&places, 3 * g)),
                rotation: Mat3::from_rows(row(0), row(1), row(2)),
            },
            mesh: mesh.map(|mesh| mesh.triangles()),
            field: model.heights(g),
            radius: (!plane).then_some(radius),
        });
    }
    all.extend(items::of_tendons(sim)?.iter().map(Target::of_tendon));
    Ok(all)
}

impl Target<'_> {
    /// Creates a segment of a tendon from its item, whose axes have the lengths of its radius and of its half length.
    fn of_tendon(item: &items::Item) -> Self {
        let column = |k: usize| {
            let [x, y, z, _] = item.pose[k].map(f64::from);
            Vec3::new(x, y, z)
        };
        let [side, other, along] = [0, 1, 2].map(|k| column(k).normalize().0);
        let (radius, half) = (column(0).norm(), column(2).norm());
        Target {
            geom: -1,
            kind: ShapeKind::Cylinder,
            size: Vec3::new(radius, half, 0.0),
            pose: Pose {
                position: column(3),
                rotation: Mat3::from_columns(side, other, along),
            },
            mesh: None,
            field: None,
            radius: Some(radius + half),
        }
    }

    /// Returns true if each ray takes its own way through the shape.
    pub(super) fn branches(&self) -> bool {
        matches!(self.kind, ShapeKind::Mesh | ShapeKind::HeightField)
    }
}
