//! The smallest distance between two sets of geoms. Each lane is searched separately.

use super::read::Reading;
use clench_collide::{Bound, Pose, Separation, Shape, distance, near};
use clench_dynamics::model::{Sensor, SensorKind};
use clench_dynamics::sensor_group;
use clench_math::{Real, Vec3};
use std::ops::Range;

impl<T: Real> Reading<'_, T> {
    /// Writes a distance, its direction or its end points, up to the cutoff.
    pub(super) fn read_distance(&self, sensor: &Sensor, sets: &[Range<usize>; 2], out: &mut [T]) {
        for lane in 0..T::LANES {
            let limit = T::Scalar::new(sensor.cutoff);
            let nearest = self.nearest(sets, limit, lane);
            let mut write = |numbers: &[T::Scalar]| {
                for (to, &from) in out.iter_mut().zip(numbers) {
                    to.set_lane(lane, from);
                }
            };
            match (sensor.kind, nearest) {
                (SensorKind::Distance, found) => write(&[found.map_or(limit, |f| f.distance)]),
                (SensorKind::Normal, Some(found)) => write(&direction(&found).to_array()),
                (SensorKind::FromTo, Some(found)) => {
                    let points = found.points.map(Vec3::to_array);
                    write(points.as_flattened());
                }
                (SensorKind::Normal | SensorKind::FromTo, None) => {
                    write(&[<T::Scalar as Real>::ZERO; 6]);
                }
                // The builder gives the other kinds other targets.
                (
                    sensor_group!(whole)
                    | sensor_group!(element)
                    | sensor_group!(frame)
                    | sensor_group!(others),
                    _,
                ) => write(&[<T::Scalar as Real>::ZERO; 6]),
            }
        }
    }

    /// Returns the nearest pair of geoms of two sets, the first of equals; `None` beyond the limit.
    fn nearest(
        &self,
        [first, second]: &[Range<usize>; 2],
        limit: T::Scalar,
        lane: usize,
    ) -> Option<Separation<T::Scalar>> {
        let mut best: Option<Separation<T::Scalar>> = None;
        for a in first.clone() {
            let (shape_a, pose_a) = self.solid(a, lane);
            let bound = Bound::new(&shape_a, &pose_a);
            for b in second.clone() {
                let (shape_b, pose_b) = self.solid(b, lane);
                let reach = best.map_or(limit, |best| best.distance);
                if near(&bound, &Bound::new(&shape_b, &pose_b), reach)
                    && let Some(found) = distance(&shape_a, &pose_a, &shape_b, &pose_b, reach)
                    && best.is_none_or(|best| found.distance < best.distance)
                {
                    best = Some(found);
                }
            }
        }
        best
    }

    /// Returns a geom in one lane; a mesh has a hull even if it does not collide.
    pub(super) fn solid(
        &self,
        geom: usize,
        lane: usize,
    ) -> (Shape<'_, T::Scalar>, Pose<T::Scalar>) {
        let (shape, pose) = (self.geoms().solid(geom), self.geoms().pose(geom));
        (shape.lane(lane), pose.lane(lane))
    }
}

/// Returns the direction from the first end to the second, as in MuJoCo: against the normal if the geoms overlap.
fn direction<T: Real>(found: &Separation<T>) -> Vec3<T> {
    let overlap = found.distance.lt(T::ZERO);
    Vec3::select(overlap, -found.normal, found.normal)
}
