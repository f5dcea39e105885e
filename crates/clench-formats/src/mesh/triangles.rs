//! What a mesh file holds, and numbers as its readers find them.

use clench_math::Vec3;

/// What a mesh file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Triangles {
    /// Vertices, in the file's unit, each finite.
    pub vertices: Vec<Vec3<f64>>,
    /// Triangles; none for a cloud of points.
    pub faces: Vec<[u32; 3]>,
    /// Two tangents at each vertex, or none.
    pub tangents: Vec<[Vec3<f64>; 2]>,
    /// Places in a picture, across and down: one a vertex, or those that `face_texcoords` names; or none.
    pub texcoords: Vec<[f32; 2]>,
    /// Which of these each corner of each triangle has; none stands for those of the vertices.
    pub face_texcoords: Vec<[u32; 3]>,
}

/// The numbers of a run of little-endian bytes.
pub(super) fn floats(bytes: &[u8]) -> impl Iterator<Item = f32> {
    let words = bytes.as_chunks::<4>().0;
    words.iter().copied().map(f32::from_le_bytes)
}

/// Points from their coordinates, one after the other.
pub(super) fn points(coordinates: impl Iterator<Item = f32>) -> Vec<Vec3<f64>> {
    let coordinates: Vec<f64> = coordinates.map(f64::from).collect();
    let (points, _) = coordinates.as_chunks::<3>();
    points.iter().copied().map(Vec3::from_array).collect()
}
