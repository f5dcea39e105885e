//! The content of mesh files, and number decoding for their readers.

use clench_math::Vec3;

/// The content of a mesh file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Triangles {
    /// The vertices, in the file's unit, all finite.
    pub vertices: Vec<Vec3<f64>>,
    /// The triangles; empty for a point cloud.
    pub faces: Vec<[u32; 3]>,
    /// Two tangents at each vertex, or none.
    pub tangents: Vec<[Vec3<f64>; 2]>,
    /// Texture coordinates, across and down: one per vertex, or indexed by `face_texcoords`; or none.
    pub texcoords: Vec<[f32; 2]>,
    /// The texture coordinates of the corners of each triangle; if empty, the indices of `faces` apply.
    pub face_texcoords: Vec<[u32; 3]>,
}

/// Decodes little-endian numbers.
pub(super) fn floats(bytes: &[u8]) -> impl Iterator<Item = f32> {
    let words = bytes.as_chunks::<4>().0;
    words.iter().copied().map(f32::from_le_bytes)
}

/// Groups consecutive coordinates into points.
pub(super) fn points(coordinates: impl Iterator<Item = f32>) -> Vec<Vec3<f64>> {
    let coordinates: Vec<f64> = coordinates.map(f64::from).collect();
    let (points, _) = coordinates.as_chunks::<3>();
    points.iter().copied().map(Vec3::from_array).collect()
}
