//! Many rays and terrain heights at once, for example for a lidar or a walking policy.

use super::cast::{HIT, RAY, cast, sample};
use super::check_object;
use crate::sim::Sim;
use crate::validity::Computed;
use crate::{Model, Precision};
use clench_dynamics::check::{check_count, check_values};
use clench_dynamics::error::{SimError, no_such};
use clench_dynamics::geometry::{RayFilter, RayHit};
use clench_dynamics::model::FrameObject;
use clench_math::{Real, Scalar, Vec3};

/// Returns an error unless rays and frame are valid.
pub(crate) fn check_rays<S: Scalar>(
    model: &Model,
    frame: Option<FrameObject>,
    rays: &[S],
) -> Result<(), SimError> {
    frame.map_or(Ok(()), |frame| check_object(model, frame))?;
    check_count("rays", rays.len(), RAY)?;
    check_values("rays", rays, rays.len())
}

/// Returns an error unless positions, geom and frame are valid.
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
    /// Returns the first hit of each ray (k, 6: origin, direction), see [`ray`](Self::ray). With a `frame`, rays are in
    /// its coordinates and move with it.
    ///
    /// # Errors
    /// Returns an error if a length is wrong, a value is not finite, or there is no such object, or as
    /// [`refresh`](Self::refresh) does.
    pub fn rays(
        &mut self,
        rays: &[T],
        frame: Option<FrameObject>,
        filter: &RayFilter,
    ) -> Result<Vec<Option<RayHit<T>>>, SimError> {
        check_rays(self.model(), frame, rays)?;
        self.require(Computed::Positions)?;
        let rays = Vec::from_iter(rays.iter().copied().map(T::SingleEnv::splat));
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

    /// Returns the world height of a height field's surface at each position (k, 2: x, y), m; beyond its edges, that at
    /// the nearest edge point. With a `frame`, positions are relative to its position, along its horizontally projected
    /// x axis. Exact if the field's z axis points upwards.
    ///
    /// # Errors
    /// Returns an error if the geom is not a height field, or as [`rays`](Self::rays) does.
    pub fn heights(
        &mut self,
        geom: usize,
        places: &[T],
        frame: Option<FrameObject>,
    ) -> Result<Vec<T>, SimError> {
        check_places(self.model(), geom, frame, places)?;
        self.require(Computed::Positions)?;
        let places = Vec::from_iter(places.iter().copied().map(T::SingleEnv::splat));
        let mut heights = Vec::new();
        sample(self.geoms(), geom, frame, &places, &mut heights);
        Ok(heights.iter().map(|height| height.lane(0)).collect())
    }
}
