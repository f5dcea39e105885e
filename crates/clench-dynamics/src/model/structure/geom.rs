//! What collides: geoms, the meshes and height fields that they are made of, and pairs.

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
    /// Whose parameters win.
    pub priority: i32,
    /// Group.
    pub group: i32,
    /// Whether it can be seen: rays pass through what cannot.
    pub visible: bool,
    /// Feels a surrounding medium as an ellipsoid.
    pub fluid_ellipsoid: bool,
    /// The user's own numbers, as many for each element of its kind.
    pub user: Arc<[f64]>,
    /// Where it was written.
    pub origin: Option<Origin>,
}

/// A mesh about its centre of mass, along its principal axes.
///
/// Its numbers are structure: they are the same in every environment.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Name.
    pub name: String,
    /// Its centre of mass where its author put it (scaled, about the reference pose), m.
    pub pos: Vec3<f64>,
    /// Its principal axes there.
    pub quat: Quat<f64>,
    /// Vertices, m.
    pub vertices: Vec<Vec3<f64>>,
    /// Triangles, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
    /// Places in a picture that lies on the mesh, across and down, each from 0 to 1; none where its author gave none.
    pub texcoords: Vec<[f32; 2]>,
    /// Which of these each corner of each triangle has; as many as `faces` where there are any.
    pub face_texcoords: Vec<[u32; 3]>,
    /// Two tangents at each vertex, unit vectors; none where its author gave none.
    pub tangents: Vec<[Vec3<f64>; 2]>,
    /// What collides, and the volume of sites; `None` where no geom with this mesh collides and no site is it.
    pub hull: Option<Hull>,
    /// As its author gave it, which is what a saved model says.
    pub spec: MeshSpec,
    /// What queries need of it, made when they first do.
    pub on_demand: OnDemand,
    /// Where it was written.
    pub origin: Option<Origin>,
}

/// What of a mesh only queries need.
#[derive(Clone, Debug, Default)]
pub struct OnDemand {
    triangles: OnceLock<TriangleMesh>,
    hull: OnceLock<Option<Hull>>,
}

impl Mesh {
    /// Its triangles, for rays. The first call takes some 0.4 µs a triangle (0.1 s for 200,000).
    pub fn triangles(&self) -> &TriangleMesh {
        self.on_demand.triangles.get_or_init(|| {
            // Whoever writes numbers that are not finite into a model gets meshes that no ray hits.
            let mesh = TriangleMesh::new(self.vertices.clone(), self.faces.clone());
            mesh.unwrap_or_default()
        })
    }

    /// Its hull, whether it collides or not. `None` where it is flat.
    pub fn any_hull(&self) -> Option<&Hull> {
        let make = || {
            let surface = convex_hull(&self.vertices, None).ok()?;
            Some(Hull::new(&surface, &self.vertices))
        };
        let spare = || self.on_demand.hull.get_or_init(make).as_ref();
        self.hull.as_ref().or_else(spare)
    }
}

/// Terrain; its numbers are structure, as those of a [`Mesh`].
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
