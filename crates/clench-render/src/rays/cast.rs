//! The rays of a picture, as many at a time as the processor's registers hold.

use super::eye::{Eye, Window};
use super::target::Target;
use clench::collide::{Hit, Pose, Ray, Shape, ShapeKind, Terrain, UnitRay, ray};
use clench::math::{Instructions, LaneTask, Mask, Mat3, Real, Scalar, Vec3, kernel};
use std::ops::Range;

/// The step from a back side of a shape to the next hit, over its distance and the shape's radius.
const STEP: f64 = 1e-7;

/// The distances and geom indices of some rows of a picture.
#[derive(Default)]
pub(super) struct Facts {
    rows: Range<usize>,
    pub(super) depth: Vec<f64>,
    pub(super) geoms: Vec<f64>,
}

impl Facts {
    /// Replaces the picture by some rows of that of a camera.
    pub(super) fn draw(&mut self, targets: &[Target], eye: &Eye, rows: Range<usize>) {
        let pixels = eye.size[0] * rows.len();
        self.rows = rows;
        self.depth.clear();
        self.depth.resize(pixels, f64::INFINITY);
        self.geoms.clear();
        self.geoms.resize(pixels, -1.0);
        let facts = self;
        let drawing = Drawing {
            targets,
            eye,
            facts,
        };
        let drawn = f64::in_lanes(Instructions::widest(), drawing);
        debug_assert!(drawn.is_some(), "the widest instructions are available");
    }
}

/// All rays of a picture.
struct Drawing<'a> {
    targets: &'a [Target<'a>],
    eye: &'a Eye,
    facts: &'a mut Facts,
}

impl LaneTask<f64> for Drawing<'_> {
    type Output = ();

    fn run<T: Real<Scalar = f64>>(self) {
        for target in self.targets {
            match target.branches() {
                true => cast::<f64>(target, self.eye, self.facts),
                false => cast::<T>(target, self.eye, self.facts),
            }
        }
    }
}

/// Casts the rays that can hit a shape.
#[kernel]
fn cast<T: Real<Scalar = f64>>(target: &Target, eye: &Eye, facts: &mut Facts) {
    let shape = Aim::<T>::at(target, eye);
    let center = target.pose.position;
    let window = match target.radius {
        Some(radius) => eye.window(center, radius),
        None => eye.whole(),
    };
    let Window { rows, columns } = window;
    let mut lanes = T::ZERO;
    for lane in 0..T::LANES {
        lanes.set_lane(lane, lane as f64);
    }
    let [width, height] = eye.size.map(|side| side as f64);
    let [right, up, back] = eye.axes.map(Vec3::<T>::splat);
    let position = Vec3::<T>::splat(eye.position);
    let [near, far] = [eye.near, eye.far].map(T::new);
    let ([wide, high], [middle, level]) = (eye.pixel, eye.center);
    let drawn = facts.rows.clone();
    for row in rows.start.max(drawn.start)..rows.end.min(drawn.end) {
        let across = up * T::new(high * (height - 2.0 * row as f64 - 1.0) + level);
        for start in columns.clone().step_by(T::LANES) {
            let count = T::LANES.min(eye.size[0] - start);
            let first = (row - drawn.start) * eye.size[0] + start;
            let column = lanes + lanes + T::new(2.0 * start as f64 + 1.0 - width);
            let aside = right * (column * T::new(wide) + T::new(middle)) + across;
            let (from, direction) = match eye.parallel {
                true => (position + aside, -back),
                false => (position, aside - back),
            };
            // Distances are along the viewing direction, behind the near plane.
            let line = Ray {
                origin: from + direction * near,
                direction,
            };
            let depth = &mut facts.depth[first..first + count];
            let mut nearest = [T::ZERO];
            T::as_scalars_mut(&mut nearest)[..count].copy_from_slice(depth);
            let within = nearest[0].min(far) - near;
            let may_hit = shape.may_hit(&line, within);
            if !may_hit.any() {
                continue;
            }
            let distance = shape.front(&line);
            // Of two geoms at one distance the later is seen, as in pictures of a device.
            let nearer = may_hit & distance.le(within) & distance.is_finite();
            if !nearer.any() {
                continue;
            }
            nearest[0] = T::select(nearer, distance + near, nearest[0]);
            depth.copy_from_slice(&T::as_scalars(&nearest)[..count]);
            let geoms = &mut facts.geoms[first..first + count];
            let mut geom = [T::ZERO];
            T::as_scalars_mut(&mut geom)[..count].copy_from_slice(geoms);
            geom[0] = T::select(nearer, T::new(f64::from(target.geom)), geom[0]);
            geoms.copy_from_slice(&T::as_scalars(&geom)[..count]);
        }
    }
}

/// A shape in lanes, one for each ray.
struct Aim<'a, T: Real> {
    target: &'a Target<'a>,
    shape: Shape<'a, T>,
    pose: Pose<T>,
    radius: Option<T>,
}

impl<'a, T: Real<Scalar = f64>> Aim<'a, T> {
    #[inline(always)]
    fn at(target: &'a Target<'a>, eye: &Eye) -> Self {
        let size = Vec3::splat(target.size);
        let mut rotation = target.pose.rotation;
        // Unlike other rays, those of a picture hit a plane from below too.
        let [ahead, side, normal] = [0, 1, 2].map(|k| rotation.column(k));
        let above = match eye.parallel {
            true => normal.dot(eye.axes[2]),
            false => normal.dot(eye.position - target.pose.position),
        };
        if target.kind == ShapeKind::Plane && above < 0.0 {
            rotation = Mat3::from_columns(ahead, -side, -normal);
        }
        let [x, y, z] = rotation.rows.map(Vec3::<T>::splat);
        Aim {
            target,
            shape: match target.kind {
                ShapeKind::HeightField => Shape::HeightField(Terrain {
                    field: target.field,
                    size,
                }),
                kind => Shape::new(kind, size),
            },
            pose: Pose {
                position: Vec3::splat(target.pose.position),
                rotation: Mat3::from_rows(x, y, z),
            },
            radius: target.radius.map(T::new),
        }
    }

    #[inline(always)]
    fn may_hit(&self, line: &Ray<T>, within: T) -> T::Mask {
        match self.radius {
            Some(radius) => UnitRay::of(line).may_intersect(self.pose.position, radius, within),
            None => T::Mask::splat(true),
        }
    }

    /// Returns the distance of the first front side: as in the pictures of a device, a camera in a shape looks out. A
    /// round starts beyond the back side of the one before. Planes have no radius, and no back side.
    #[inline(always)]
    fn front(&self, line: &Ray<T>) -> T {
        let step = self.radius.unwrap_or(T::ZERO);
        let mut passed = T::ZERO;
        loop {
            let hit = self.hit(&Ray {
                origin: line.origin + line.direction * passed,
                direction: line.direction,
            });
            let distance = passed + hit.distance;
            let back = hit.normal.dot(line.direction).gt(T::ZERO);
            if !back.any() {
                return distance;
            }
            passed = T::select(back, distance + (distance + step) * T::new(STEP), passed);
        }
    }

    #[inline(always)]
    fn hit(&self, line: &Ray<T>) -> Hit<T> {
        match self.target.mesh {
            Some(mesh) => mesh.ray(&self.pose, line),
            None => ray(&self.shape, &self.pose, line),
        }
    }
}
