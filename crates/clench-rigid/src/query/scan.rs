//! Many rays and terrain heights at once, for example for a lidar or a walking policy.

use super::cast::HIT;
use super::table::Query;
use crate::Precision;
use crate::sim::Sim;
use clench_dynamics::error::SimError;
use clench_dynamics::geometry::{RayFilter, RayHit};
use clench_dynamics::model::FrameObject;
use clench_math::Vec3;

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
        let mut hits = Vec::new();
        self.answer(Query::Rays { frame, filter }, rays, &mut hits)?;
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
        let mut heights = Vec::new();
        self.answer(Query::Heights { geom, frame }, places, &mut heights)?;
        Ok(heights)
    }
}
