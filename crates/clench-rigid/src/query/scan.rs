//! Many rays at once, and heights of terrain at many places: what a lidar or a walking policy looks at.

use super::cast::{HIT, RAY, cast, sample};
use super::check_object;
use crate::known::Extent;
use crate::sim::Sim;
use crate::{Model, Precision};
use clench_dynamics::check::{check_count, check_values};
use clench_dynamics::error::{SimError, no_such};
use clench_dynamics::geometry::{RayFilter, RayHit};
use clench_dynamics::model::FrameObject;
use clench_math::{Real, Scalar, Vec3};

/// Rays that can be cast: whole ones, finite, in the frame of an object that the model has.
pub(crate) fn check_rays<S: Scalar>(
    model: &Model,
    frame: Option<FrameObject>,
    rays: &[S],
) -> Result<(), SimError> {
    frame.map_or(Ok(()), |frame| check_object(model, frame))?;
    check_count("rays", rays.len(), RAY)?;
    check_values("rays", rays, rays.len())
}

/// Places where heights can be asked for, of a geom that is a height field.
pub(crate) fn check_places<S: Scalar>(
    model: &Model,
    geom: usize,
    frame: Option<FrameObject>,
    places: &[S],
) -> Result<(), SimError> {
    if geom >= model.geoms.len() {
        return Err(no_such("geom", geom, model.geoms.len()));
    }
    if model.heights(geom).is_none() {
        return Err(SimError::NoHeightField { geom });
    }
    frame.map_or(Ok(()), |frame| check_object(model, frame))?;
    check_count("places", places.len(), 2)?;
    check_values("places", places, places.len())
}

impl<T: Precision> Sim<T> {
    /// What each of some rays (k, 6: origin, direction) hits first, as [`ray`](Self::ray) says. With a `frame` they are in its
    /// coordinates, so that they move with it.
    ///
    /// # Errors
    /// A wrong length, numbers that are not finite, an object that the model does not have; else as [`refresh`](Self::refresh).
    pub fn rays(
        &mut self,
        rays: &[T],
        frame: Option<FrameObject>,
        filter: &RayFilter,
    ) -> Result<Vec<Option<RayHit<T>>>, SimError> {
        check_rays(self.model(), frame, rays)?;
        self.require(Extent::Positions)?;
        let rays = Vec::from_iter(rays.iter().copied().map(T::Alone::splat));
        let mut hits = Vec::new();
        cast(self.geoms(), frame, &rays, filter, &mut hits);
        let hits = Vec::from_iter(hits.iter().map(|number| number.lane(0)));
        let hit = |numbers: &[T]| {
            (numbers[0] >= T::ZERO).then(|| RayHit {
                geom: numbers[0].to_f64() as usize,
                distance: numbers[1],
                normal: Vec3::from_slice(&numbers[2..]),
            })
        };
        Ok(hits.chunks_exact(HIT).map(hit).collect())
    }

    /// The height, in the world, of the surface of a height field over each of some places (k, 2: x, y), m; beyond its edges that
    /// over the nearest place on them. With a `frame` places are from its position, along its x axis as seen from above. Exact
    /// where the field's z axis points upwards, as terrain's does.
    ///
    /// # Errors
    /// A geom that is no height field; else as [`rays`](Self::rays).
    pub fn heights(
        &mut self,
        geom: usize,
        places: &[T],
        frame: Option<FrameObject>,
    ) -> Result<Vec<T>, SimError> {
        check_places(self.model(), geom, frame, places)?;
        self.require(Extent::Positions)?;
        let places = Vec::from_iter(places.iter().copied().map(T::Alone::splat));
        let mut heights = Vec::new();
        sample(self.geoms(), geom, frame, &places, &mut heights);
        Ok(heights.iter().map(|height| height.lane(0)).collect())
    }
}
