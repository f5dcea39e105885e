//! Meshes as their author gives them.

use crate::model::Origin;
use clench_math::{Quat, Vec3};

/// The mass distribution of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MeshInertia {
    /// Evenly over its convex hull.
    Convex,
    /// Evenly over the enclosed volume; its triangles must have consistent orientation.
    Exact,
    /// Evenly over the pyramids from its centroid to each triangle, with those that face inwards counted as if they
    /// faced outwards. MuJoCo's default: too large for a mesh that is not convex.
    #[default]
    Legacy,
    /// Evenly over its surface.
    Shell,
}

/// A mesh: triangles that geoms refer to by name.
///
/// Each vertex v represents `scale · refquat⁻¹ (v − refpos)`. The convex hull collides.
#[derive(Clone, Debug)]
pub struct MeshSpec {
    /// Name.
    pub name: String,
    /// Vertices, at least four.
    pub vertices: Vec<Vec3<f64>>,
    /// Triangles, counter-clockwise seen from outside; empty for the convex hull.
    pub faces: Vec<[u32; 3]>,
    /// Texture coordinates, across and down: one per vertex, or those that `face_texcoords` indexes.
    pub texcoords: Vec<[f32; 2]>,
    /// The texture coordinates of each corner of each triangle; empty for those of the vertices.
    pub face_texcoords: Vec<[u32; 3]>,
    /// Two tangents at each vertex, along which a tactile sensor measures; or empty.
    pub tangents: Vec<[Vec3<f64>; 2]>,
    /// The position subtracted from the vertices.
    pub refpos: Vec3<f64>,
    /// Rotation that is undone on the vertices.
    pub refquat: Quat<f64>,
    /// Factors applied last; negative ones mirror.
    pub scale: Vec3<f64>,
    /// Its mass distribution.
    pub inertia: MeshInertia,
    /// Maximum number of vertices of the convex hull; `None` for any number.
    pub max_hull_vertices: Option<usize>,
    /// The reason why its file could not be read, an error if the mesh is used. Set only with `discardvisual`.
    pub unreadable: Option<String>,
    /// The source location.
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
            unreadable: None,
            origin: None,
        }
    }
}

impl MeshSpec {
    /// Creates the convex hull of points, m.
    pub fn hull(name: impl Into<String>, points: &[[f64; 3]]) -> Self {
        MeshSpec {
            name: name.into(),
            vertices: points.iter().copied().map(Vec3::from_array).collect(),
            inertia: MeshInertia::Convex,
            ..MeshSpec::default()
        }
    }
    /// Creates a mesh of triangles between vertices (m), counter-clockwise seen from outside, that enclose its mass.
    pub fn triangles(name: impl Into<String>, vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> Self {
        MeshSpec {
            faces: faces.to_vec(),
            inertia: MeshInertia::Exact,
            ..MeshSpec::hull(name, vertices)
        }
    }
    /// Scales it along each axis; negative factors mirror.
    #[must_use]
    pub fn scaled(mut self, scale: [f64; 3]) -> Self {
        self.scale = Vec3::from_array(scale);
        self
    }
}
