//! Bounding spheres of geoms that contain all points where they could be in contact.

use super::Candidate;
use crate::model::{Model, Params};
use crate::stages::Positions;
use clench_collide::{ShapeKind, allowance};
use clench_math::{Real, Vec3, kernel};

/// A sphere around a geom's origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoundingSphere<T> {
    pub(super) center: Vec3<T>,
    /// The radius that contains the shape; 0 for a plane.
    radius: T,
    /// The radius plus the geom's share of margin and gap.
    pub(super) reach: T,
}

/// Updates the spheres of the given geoms. Spheres of geoms that were never updated have zero radius.
#[kernel]
pub(super) fn update<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    geoms: impl Iterator<Item = usize>,
    spheres: &mut Vec<BoundingSphere<T>>,
) {
    let allowance = allowance::<T>();
    let none = BoundingSphere {
        center: Vec3::ZERO,
        radius: T::ZERO,
        reach: T::ZERO,
    };
    spheres.resize(pos.geom_xpos.len(), none);
    for g in geoms {
        let radius = params.geom_rbound[g] * allowance;
        let margin = own_margin(model, params, g) * allowance;
        spheres[g] = BoundingSphere {
            center: pos.geom_xpos[g],
            radius,
            reach: radius + margin,
        };
    }
}

/// Returns a geom's share of the distance within which contacts are listed.
#[inline(always)]
pub(super) fn own_margin<T: Real>(model: &Model, params: &Params<T>, geom: usize) -> T {
    let margin = if model.override_contacts {
        params.override_margin * T::new(0.5)
    } else {
        params.geom_margin[geom]
    };
    margin + params.geom_gap[geom]
}

/// Returns the lanes in which two geoms may be in contact. `range` is the listing distance of an explicit pair.
#[inline(always)]
pub(super) fn may_touch<T: Real>(
    candidate: &Candidate,
    spheres: &[BoundingSphere<T>],
    pos: &Positions<T>,
    range: impl FnOnce() -> T,
) -> T::Mask {
    let [a, b] = candidate.geoms.map(|g| g as usize);
    let (first, second) = (&spheres[a], &spheres[b]);
    let reach = match candidate.pair {
        None => first.reach + second.reach,
        Some(_) => first.radius + second.radius + range() * allowance(),
    };
    let offset = second.center - first.center;
    if candidate.kinds[0] == ShapeKind::Plane {
        pos.geom_xmat[a].column(2).dot(offset).le(reach)
    } else {
        // Negative margins may make the reach negative: no point touches then.
        offset.norm_squared().le(reach * reach.max(T::ZERO))
    }
}
