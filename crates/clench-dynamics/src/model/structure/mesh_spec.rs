//! Meshes, as their author gives them.

use crate::model::Origin;
use clench_math::{Quat, Vec3};

/// How the mass of a mesh is spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MeshInertia {
    /// Evenly over its convex hull.
    Convex,
    /// Evenly over what it encloses; its triangles must agree on where outside is.
    Exact,
    /// Evenly over the pyramids from its centroid to each triangle, those that face inwards counted as if they faced outwards.
    /// MuJoCo's default: too much where a mesh is not convex.
    #[default]
    Legacy,
    /// Evenly over its surface.
    Shell,
}

/// A mesh: triangles that geoms refer to by name.
///
/// Each vertex v stands for `scale · refquat⁻¹ (v − refpos)`. What collides is the convex hull.
#[derive(Clone, Debug)]
pub struct MeshSpec {
    /// Name.
    pub name: String,
    /// Vertices, at least four.
    pub vertices: Vec<Vec3<f64>>,
    /// Triangles, counter-clockwise seen from outside; none stands for the convex hull.
    pub faces: Vec<[u32; 3]>,
    /// Places in a picture that lies on the mesh, across and down: one a vertex, or those that `face_texcoords` names.
    pub texcoords: Vec<[f32; 2]>,
    /// Which of these each corner of each triangle has; none stands for those of the vertices.
    pub face_texcoords: Vec<[u32; 3]>,
    /// Two tangents at each vertex, along which a tactile sensor measures; or none.
    pub tangents: Vec<[Vec3<f64>; 2]>,
    /// Subtracted from the vertices.
    pub refpos: Vec3<f64>,
    /// Turned back from the vertices.
    pub refquat: Quat<f64>,
    /// Multiplied, last; negative numbers mirror.
    pub scale: Vec3<f64>,
    /// How its mass is spread.
    pub inertia: MeshInertia,
    /// Most vertices of the convex hull; `None` for any number.
    pub max_hull_vertices: Option<usize>,
    /// Where it was written.
    pub origin: Option<Origin>,
}

impl Default for MeshSpec {
    fn default() -> Self {
        MeshSpec {
            name: String::new(),
            vertices: Vec::new(),
            faces: Vec::new(),
            texcoords: Vec::new(),
            face_texcoords: Vec::new(),
            tangents: Vec::new(),
            refpos: Vec3::ZERO,
            refquat: Quat::IDENTITY,
            scale: Vec3::new(1.0, 1.0, 1.0),
            inertia: MeshInertia::default(),
            max_hull_vertices: None,
            origin: None,
        }
    }
}

impl MeshSpec {
    /// The convex hull of points, m.
    pub fn hull(name: impl Into<String>, points: &[[f64; 3]]) -> Self {
        MeshSpec {
            name: name.into(),
            vertices: points.iter().copied().map(Vec3::from_array).collect(),
            inertia: MeshInertia::Convex,
            ..MeshSpec::default()
        }
    }
    /// Triangles between vertices (m), counter-clockwise seen from outside, that enclose its mass.
    pub fn triangles(name: impl Into<String>, vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> Self {
        MeshSpec {
            faces: faces.to_vec(),
            inertia: MeshInertia::Exact,
            ..MeshSpec::hull(name, vertices)
        }
    }
    /// Its size, along each axis; negative numbers mirror.
    #[must_use]
    pub fn scaled(mut self, scale: [f64; 3]) -> Self {
        self.scale = Vec3::from_array(scale);
        self
    }
}
