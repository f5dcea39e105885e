//! Where tendons run, for pictures.

use clench_dynamics::dynamics::tendon_path::each_span;
use clench_dynamics::model::{Model, Params};
use clench_dynamics::stages::Positions;
use clench_math::{Real, Scalar, Vec3};

/// A straight part of a tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonLine {
    /// The tendon.
    pub tendon: usize,
    /// Its ends in the world, m.
    pub ends: [[f32; 3]; 2],
}

/// The straight parts of all tendons of lane 0. Where a string lies on a geom, a chord stands for its arc.
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
