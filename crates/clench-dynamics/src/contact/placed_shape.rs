//! The shape and pose of a geom.

use crate::model::{Model, Params};
use crate::stages::Positions;
use clench_collide::{HeightField, Mesh, Pose, Shape, ShapeKind, Terrain};
use clench_math::{Mask, Real};

/// Returns the shape of a geom. In a shared layout its mesh or height field is that of the first lane; see
/// `AssetLanes`.
#[inline(always)]
pub fn shape<'a, T: Real>(model: &'a Model, params: &Params<T>, geom: usize) -> Shape<'a, T> {
    shape_in(model, params, geom, 0)
}

/// Returns the shape of a geom with the mesh or height field of a lane.
#[inline(always)]
pub(crate) fn shape_in<'a, T: Real>(
    model: &'a Model,
    params: &Params<T>,
    geom: usize,
    lane: usize,
) -> Shape<'a, T> {
    let size = params.geom_size[geom];
    match model.geoms[geom].kind {
        ShapeKind::Mesh => Shape::Mesh(Mesh {
            hull: mesh_in(model, params, geom, lane)
                .and_then(|mesh| model.meshes[mesh].hull.as_ref()),
            extent: size,
        }),
        ShapeKind::HeightField => Shape::HeightField(Terrain {
            field: heights_in(model, params, geom, lane),
            size,
        }),
        kind => Shape::new(kind, size),
    }
}

/// Returns the mesh of a geom in a lane.
#[inline(always)]
pub(crate) fn mesh_in<T: Real>(
    model: &Model,
    params: &Params<T>,
    geom: usize,
    lane: usize,
) -> Option<usize> {
    match model.geom_assets.is_empty() {
        true => model.geoms[geom].mesh,
        false if model.geoms[geom].kind == ShapeKind::Mesh => asset(model, params, geom, lane),
        false => None,
    }
}

/// Returns the height field of a geom in a lane.
#[inline(always)]
pub fn heights_in<'a, T: Real>(
    model: &'a Model,
    params: &Params<T>,
    geom: usize,
    lane: usize,
) -> Option<&'a HeightField> {
    let field = match model.geom_assets.is_empty() {
        true => model.geoms[geom].height_field,
        false if model.geoms[geom].kind == ShapeKind::HeightField => {
            asset(model, params, geom, lane)
        }
        false => None,
    };
    field.map(|field| &model.height_fields[field].shape)
}

/// Returns the mesh or height field of a geom of a shared layout in a lane.
fn asset<T: Real>(model: &Model, params: &Params<T>, geom: usize, lane: usize) -> Option<usize> {
    let own = params.lane_models.get(lane).map_or(0, |&own| own as usize);
    model.geom_assets[own][geom].map(|asset| asset as usize)
}

/// The bits of all lanes.
pub(crate) const ALL_LANES: u32 = u32::MAX;

/// The sets of lanes in which two geoms have the same meshes or height fields, as bits, each with its first lane. All
/// lanes are one set, unless several models share the layout.
pub(crate) struct AssetLanes<'a> {
    model: &'a Model,
    lane_models: &'a [u32],
    geoms: [usize; 2],
    done: u32,
}

impl<'a> AssetLanes<'a> {
    #[inline(always)]
    pub(crate) fn new<T>(model: &'a Model, params: &'a Params<T>, geoms: [usize; 2]) -> Self {
        AssetLanes {
            model,
            lane_models: &params.lane_models,
            geoms,
            done: 0,
        }
    }

    /// Returns the set of the first lane of several models that is in no set yet.
    #[inline(never)]
    fn next_set(&mut self) -> Option<(u32, usize)> {
        let assets = |lane: usize| {
            let own = &self.model.geom_assets[self.lane_models[lane] as usize];
            self.geoms.map(|geom| own[geom])
        };
        let first = self.done.trailing_ones() as usize;
        let left = first..self.lane_models.len();
        let same = left.filter(|&lane| assets(lane) == assets(first));
        let lanes = same.fold(0, |lanes, lane| lanes | 1 << lane);
        self.done |= lanes;
        (lanes != 0).then_some((lanes, first))
    }
}

impl Iterator for AssetLanes<'_> {
    type Item = (u32, usize);

    #[inline(always)]
    fn next(&mut self) -> Option<(u32, usize)> {
        if !self.model.geom_assets.is_empty() {
            return self.next_set();
        }
        let first = self.done == 0;
        self.done = ALL_LANES;
        first.then_some((ALL_LANES, 0))
    }
}

/// Returns the mask of lanes given as bits.
#[inline(never)]
pub(crate) fn mask_of<T: Real>(bits: u32) -> T::Mask {
    let mut mask = T::Mask::splat(false);
    for lane in 0..T::LANES {
        mask.set_lane(lane, bits >> lane & 1 == 1);
    }
    mask
}

/// Returns the lanes in which an environment has the geom.
#[inline(always)]
pub(crate) fn exists<T: Real>(params: &Params<T>, geom: usize) -> T::Mask {
    params.geom_rbound[geom].ge(T::ZERO)
}

/// Returns the pose of a geom.
#[inline(always)]
pub(super) fn pose<T: Real>(pos: &Positions<T>, geom: usize) -> Pose<T> {
    Pose {
        position: pos.geom_xpos[geom],
        rotation: pos.geom_xmat[geom],
    }
}
