//! Collision elements: geoms, their meshes and height fields, and pairs.

use crate::model::{MeshSpec, Origin};
use clench_collide::{Hull, ShapeKind, TriangleMesh, convex_hull};
use clench_math::{Quat, Vec3};
use std::sync::{Arc, OnceLock};

/// A shape on a body.
#[derive(Clone, Debug)]
pub struct Geom {
    /// Name, possibly empty.
    pub name: String,
    /// Shape.
    pub kind: ShapeKind,
    /// Its mesh, for `ShapeKind::Mesh`.
    pub mesh: Option<usize>,
    /// Its height field, for `ShapeKind::HeightField`.
    pub height_field: Option<usize>,
    /// Body that carries it.
    pub body: usize,
    /// Contact type bits.
    pub contype: u32,
    /// Contact affinity bits.
    pub conaffinity: u32,
    /// Dimensions of the contact.
    pub condim: u32,
    /// Priority of its contact parameters.
    pub priority: i32,
    /// Group.
    pub group: i32,
    /// True if it is visible: rays pass through invisible geoms.
    pub visible: bool,
    /// True if fluid forces act on it as an ellipsoid.
    pub fluid_ellipsoid: bool,
    /// The user's own numbers.
    pub user: Arc<[f64]>,
    /// The source location.
    pub origin: Option<Origin>,
}

/// A mesh about its centre of mass, along its principal axes.
///
/// Its numbers are structure: they are the same in every environment.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Name.
    pub name: String,
    /// Its centre of mass in the coordinates of its author (scaled, about the reference pose), m.
    pub pos: Vec3<f64>,
    /// Orientation of its principal axes there.
    pub quat: Quat<f64>,
    /// Volume, m³, or area of a shell, m².
    pub measure: f64,
    /// Half sizes of the box of the same mass and inertia, m.
    pub half_box: Vec3<f64>,
    /// Vertices, m.
    pub vertices: Vec<Vec3<f64>>,
    /// Triangles, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
    /// Texture coordinates, across and down, each from 0 to 1; none if its author gave none.
    pub texcoords: Vec<[f32; 2]>,
    /// The texture coordinates of each corner of each triangle; as many as `faces` if there are any.
    pub face_texcoords: Vec<[u32; 3]>,
    /// Two tangents at each vertex, unit vectors; none if its author gave none.
    pub tangents: Vec<[Vec3<f64>; 2]>,
    /// The collision shape, and the volume of sites; `None` if no colliding geom and no site uses the mesh.
    pub hull: Option<Hull>,
    /// The mesh as its author gave it; a saved model writes this.
    pub spec: MeshSpec,
    /// Data for queries, computed on demand.
    pub on_demand: OnDemand,
}

/// Data of a mesh that only queries use.
#[derive(Clone, Debug, Default)]
pub struct OnDemand {
    triangles: OnceLock<TriangleMesh>,
    hull: OnceLock<Option<Hull>>,
}

impl Mesh {
    /// Returns its triangles, for rays. The first call takes some 0.4 µs per triangle (0.1 s for 200,000).
    pub fn triangles(&self) -> &TriangleMesh {
        self.on_demand.triangles.get_or_init(|| {
            // A model with numbers that are not finite gets meshes that no ray hits.
            let mesh = TriangleMesh::new(self.vertices.clone(), self.faces.clone());
            mesh.unwrap_or_default()
        })
    }

    /// Returns its hull, even if it does not collide. `None` if it is flat.
    pub fn any_hull(&self) -> Option<&Hull> {
        let make = || {
            let surface = convex_hull(&self.vertices, None).ok()?;
            Some(Hull::new(&surface, &self.vertices))
        };
        let on_demand = || self.on_demand.hull.get_or_init(make).as_ref();
        self.hull.as_ref().or_else(on_demand)
    }
}

/// Terrain. Its numbers are structure, as those of a [`Mesh`].
#[derive(Clone, Debug)]
pub struct HeightField {
    /// Name.
    pub name: String,
    /// Heights and size.
    pub shape: clench_collide::HeightField,
    /// Heights as their author gave them, in any unit.
    pub heights: Vec<f64>,
}

/// A geom pair that always collides; its parameters are in `params.pair_*`.
#[derive(Clone, Debug)]
pub struct Pair {
    /// Name, possibly empty.
    pub name: String,
    /// The geoms, that of the earlier body first.
    pub geoms: [usize; 2],
    /// Dimensions of the contact.
    pub condim: u32,
}
