//! Height fields to collide, and the shapes that touch them.

use super::Random;
use clench_collide::{Contacts, HeightField, Pose, Shape, ShapeKind, collide};
use std::sync::OnceLock;

/// The shapes that may stand on a field, except hulls.
pub const KINDS: [ShapeKind; 5] = [
    ShapeKind::Sphere,
    ShapeKind::Capsule,
    ShapeKind::Ellipsoid,
    ShapeKind::Cylinder,
    ShapeKind::Box,
];

/// Returns a field of 1 m by 80 cm with random heights, on 20 cm of ground.
pub fn rough(random: &mut Random, rows: usize, columns: usize, elevation: f64) -> HeightField {
    let heights = (0..rows * columns).map(|_| random.unit()).collect();
    HeightField::new(rows, columns, heights, [0.5, 0.4, elevation, 0.2]).unwrap()
}

/// Returns the contacts of a field at the origin and a shape.
pub fn touch(
    field: &HeightField,
    shape: &Shape<f64>,
    pose: &Pose<f64>,
    margin: f64,
) -> Contacts<f64> {
    let mut out = Contacts::new();
    collide(
        &Shape::height_field(field),
        &Pose::IDENTITY,
        shape,
        pose,
        margin,
        &mut out,
    );
    out
}

/// Returns the smallest distance of the contacts.
pub fn deepest(contacts: &Contacts<f64>) -> f64 {
    let distances = contacts.as_slice().iter().map(|c| c.distance);
    distances.fold(f64::INFINITY, f64::min)
}

/// Returns flat, gentle and steep fields that live as long as the tests: some huge, some tiny, some a thousand times as
/// high as wide.
pub fn degenerate() -> &'static [HeightField] {
    static FIELDS: OnceLock<Vec<HeightField>> = OnceLock::new();
    FIELDS.get_or_init(|| {
        let mut random = Random(79);
        let lengths = [1e-6, 1e-3, 0.1, 0.3, 1e3];
        (0..30)
            .map(|k| {
                let (rows, columns) = ([2, 3, 7][k % 3], [2, 5][k % 2]);
                let height = |place: usize| match k % 4 {
                    0 => 0.0,
                    1 => (place % columns) as f64,
                    _ => random.unit(),
                };
                let heights = (0..rows * columns).map(height).collect();
                let size = [0, 1, 2, 3].map(|_| random.pick(&lengths));
                HeightField::new(rows, columns, heights, size).unwrap()
            })
            .collect()
    })
}
