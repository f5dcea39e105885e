//! Ray casts and terrain heights for an environment in lanes.

use clench_collide::Ray;
use clench_dynamics::contact::heights_in;
use clench_dynamics::dynamics::frames::Frames;
use clench_dynamics::geometry::{Geoms, RayFilter};
use clench_dynamics::model::FrameObject;
use clench_math::{Real, Scalar, Vec3, kernel};

/// The number of values of a ray: its origin, its direction.
pub(crate) const RAY: usize = 6;

/// The number of values of a hit: the geom, or −1; the distance, or infinity; the normal.
pub(crate) const HIT: usize = 5;

/// Appends the first hit of each ray, [`HIT`] values per ray. With a frame, rays are in its coordinates.
#[kernel]
pub(crate) fn cast<T: Real>(
    geoms: Geoms<'_, T>,
    frame: Option<FrameObject>,
    rays: &[T],
    filter: &RayFilter,
    out: &mut Vec<T>,
) {
    let frames = Frames::of(geoms);
    for numbers in rays.chunks_exact(RAY) {
        let mut line = Ray {
            origin: Vec3::from_slice(numbers),
            direction: Vec3::from_slice(&numbers[3..]),
        };
        if let Some(frame) = frame {
            let rotation = frames.rotation(frame);
            line.origin = frames.position(frame) + rotation * line.origin;
            line.direction = rotation * line.direction;
        }
        let (geom, hit) = geoms.first_hit(&line, filter);
        let found = hit.distance.lt(T::splat(T::Scalar::INFINITY));
        out.push(T::select(found, geom, -T::ONE));
        out.push(hit.distance);
        out.extend(hit.normal.to_array());
    }
}

/// Appends the world height of a height field's surface at each position (x, y); NaN in environments of a shared layout
/// without the field. With a frame, positions are relative to its own, along its horizontally projected x axis.
#[kernel]
pub(crate) fn sample<T: Real>(
    geoms: Geoms<'_, T>,
    geom: usize,
    frame: Option<FrameObject>,
    places: &[T],
    out: &mut Vec<T>,
) {
    let frames = Frames::of(geoms);
    let (mut origin, mut ahead) = (Vec3::ZERO, Vec3::new(T::ONE, T::ZERO, T::ZERO));
    if let Some(frame) = frame {
        origin = frames.position(frame);
        let x = frames.rotation(frame).column(0);
        ahead = Vec3::new(x.x, x.y, T::ZERO).normalize().0;
    }
    let pose = geoms.pose(geom);
    for place in places.chunks_exact(2) {
        let (along, across) = (place[0], place[1]);
        let world = Vec3::new(
            origin.x + ahead.x * along - ahead.y * across,
            origin.y + ahead.y * along + ahead.x * across,
            pose.position.z,
        );
        let mut local = pose.rotation.transpose_mul(world - pose.position);
        for lane in 0..T::LANES {
            let (x, y) = (local.x.lane(lane).to_f64(), local.y.lane(lane).to_f64());
            let field = heights_in(geoms.model, geoms.params, geom, lane);
            let height = field.map_or(f64::NAN, |field| field.height_at(x, y));
            local.z.set_lane(lane, T::Scalar::new(height));
        }
        out.push((pose.position + pose.rotation * local).z);
    }
}
