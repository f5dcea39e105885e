//! Height fields to collide: made once, since their shapes are borrowed for as long as the tests run.

use super::Random;
use clench_collide::HeightField;
use std::sync::OnceLock;

/// Flat, gentle and wild ones, some huge, some tiny, some a thousand times as high as wide.
pub fn troubled() -> &'static [HeightField] {
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
