//! The shape and pose of a geom.

use crate::model::{Model, Params};
use crate::stages::Positions;
use clench_collide::{Mesh, Pose, Shape, ShapeKind, Terrain};
use clench_math::Real;

/// Returns the shape of a geom.
#[inline(always)]
pub fn shape<'a, T: Real>(model: &'a Model, params: &Params<T>, geom: usize) -> Shape<'a, T> {
    let size = params.geom_size[geom];
    match model.geoms[geom].kind {
        ShapeKind::Mesh => Shape::Mesh(Mesh {
            hull: model.hull(geom),
            extent: size,
        }),
        ShapeKind::HeightField => Shape::HeightField(Terrain {
            field: model.heights(geom),
            size,
        }),
        kind => Shape::new(kind, size),
    }
}

/// Returns the pose of a geom.
#[inline(always)]
pub(super) fn pose<T: Real>(pos: &Positions<T>, geom: usize) -> Pose<T> {
    Pose {
        position: pos.geom_xpos[geom],
        rotation: pos.geom_xmat[geom],
    }
}
