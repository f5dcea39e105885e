//! Tendon paths for rendering.

use clench_dynamics::dynamics::tendon_path::each_span;
use clench_dynamics::model::{Model, Params};
use clench_dynamics::stages::Positions;
use clench_math::{Real, Scalar, Vec3};

/// A straight segment of a tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonLine {
    /// The tendon.
    pub tendon: usize,
    /// Its end points in the world, m.
    pub ends: [[f32; 3]; 2],
}

/// Returns the straight segments of all spatial tendons of lane 0. An arc around a geom is replaced by its chord.
pub(crate) fn tendon_lines<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
) -> Vec<TendonLine> {
    let point = |v: Vec3<T>| v.to_array().map(|x| x.lane(0).to_f64() as f32);
    let mut lines = Vec::new();
    for (t, tendon) in model.tendons.iter().enumerate() {
        if !tendon.is_spatial() {
            continue;
        }
        let mut add = |ends| lines.push(TendonLine { tendon: t, ends });
        let mut last: Option<([f32; 3], usize)> = None;
        each_span(model, params, pos, tendon, |span| {
            if span.pull.norm_squared().lane(0).to_f64() == 0.0 {
                return;
            }
            let [from, to] = span.points.map(point);
            if let Some((end, body)) = last
                && end != from
                && body == span.bodies[0]
            {
                add([end, from]);
            }
            add([from, to]);
            last = Some((to, span.bodies[1]));
        });
    }
    lines
}
