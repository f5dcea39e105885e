//! The shape of a geom, and its pose.

use crate::model::{Model, Params};
use crate::workspace::Positions;
use clench_collide::{Pose, Shape};
use clench_math::Real;

/// The shape of a geom.
#[inline(always)]
pub(crate) fn shape<'a, T: Real>(
    model: &'a Model,
    params: &Params<T>,
    geom: usize,
) -> Shape<'a, T> {
    Shape {
        kind: model.geoms[geom].kind,
        size: params.geom_size[geom],
        asset: model.asset(geom),
    }
}

/// The pose of a geom.
#[inline(always)]
pub(super) fn pose<T: Real>(pos: &Positions<T>, geom: usize) -> Pose<T> {
    Pose {
        position: pos.geom_xpos[geom],
        rotation: pos.geom_xmat[geom],
    }
}
