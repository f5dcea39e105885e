//! The convex hull of a mesh.

use super::core::Core;
use super::feature::{Feature, MAX_CORNERS, most_level};
use super::solid::Solid;
use crate::hull::Hull;
use crate::ray::chord::Chord;
use crate::ray::line::Line;
use clench_math::{Double, Mask, Real, Scalar, Vec3};

/// The distance beyond the sampled corners, relative to the size, from which another corner is included.
pub(crate) const NOTICEABLE: f64 = 1e-7;
/// The tilt below which a face is level.
pub(crate) const LEVEL: f64 = 2e-3;
/// The direction, in the frame of the mesh, that decides between equally deep vertices and equally level faces. No edge
/// of a usual mesh is perpendicular to it.
pub(crate) const ASIDE: [f64; 3] = [0.8314, 0.4823, 0.2757];
/// The tilt towards [`ASIDE`] by which it decides, rad. It exceeds the rounding error of a normal.
pub(crate) const TIE: f64 = 1e-9;

/// The convex hull of a mesh, the same in every environment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mesh<'a, T> {
    /// The hull. A mesh whose points lie in a plane has none and touches nothing.
    pub hull: Option<&'a Hull>,
    /// Half the lengths of a box about the origin that encloses the hull, m.
    pub extent: Vec3<T>,
}

impl<'a, T: Real> Solid<T> for Mesh<'a, T> {
    type InDouble = Mesh<'a, Double<T>>;

    #[inline(always)]
    fn lane_in_double(&self, lane: usize) -> Self::InDouble {
        Mesh {
            hull: self.hull,
            extent: self.extent.lane_in_double(lane),
        }
    }

    #[inline(always)]
    fn size(&self) -> Vec3<T> {
        self.extent
    }

    #[inline(always)]
    fn bounding_radius(&self) -> T {
        self.extent.norm()
    }

    /// Returns the extent of the box: Σ hᵢ |dᵢ|.
    #[inline(always)]
    fn reach_along(&self, d: Vec3<T>) -> T {
        let h = self.extent;
        h.x * d.x.abs() + h.y * d.y.abs() + h.z * d.z.abs()
    }

    /// Tests against the planes of all faces.
    fn contains(&self, point: Vec3<T>) -> T::Mask {
        let Some(hull) = self.hull else {
            return T::Mask::splat(false);
        };
        let mut inside = T::Mask::splat(true);
        for face in 0..hull.face_count() {
            let height = Vec3::from_f64(hull.normal(face).to_array()).dot(point);
            inside &= height.le(T::new(hull.offset(face)));
        }
        inside
    }

    fn hit(&self, line: &Line<T>) -> (T, Vec3<T>) {
        line.in_each_lane(|line| hit(self.hull?, line))
    }
}

/// Clips the line to the planes of all faces.
fn hit(hull: &Hull, line: &Line<f64>) -> Option<(f64, Vec3<f64>)> {
    let mut chord = Chord::whole();
    let (infinity, none) = (f64::INFINITY, Vec3::ZERO);
    for face in 0..hull.face_count() {
        let normal = hull.normal(face);
        let rate = normal.dot(line.along);
        let above = normal.dot(line.origin) - hull.offset(face);
        let at = (-above / rate, normal);
        chord = if rate < 0.0 {
            chord.intersect(at, (infinity, none))
        } else if rate > 0.0 {
            chord.intersect((-infinity, none), at)
        } else if above > 0.0 {
            return None;
        } else {
            chord
        };
    }
    Some(chord.first())
}

impl<S: Scalar> Mesh<'_, S> {
    /// Returns the vertex of the hull that is furthest along `d`, with its index.
    #[inline]
    fn vertex(&self, d: Vec3<S>) -> Option<(usize, Vec3<S>)> {
        let hull = self.hull?;
        let vertex = hull.support(to_f64(d));
        Some((vertex, Vec3::from_f64(hull.vertices()[vertex].to_array())))
    }
}

impl<S: Scalar> Core<S> for Mesh<'_, S> {
    #[inline]
    fn support(&self, _: Vec3<S>, side: Vec3<S>) -> Vec3<S> {
        self.vertex(side).map_or(Vec3::ZERO, |(_, vertex)| vertex)
    }

    #[inline]
    fn corner_along(&self, _: Vec3<S>, side: Vec3<S>) -> (Vec3<S>, u32) {
        let found = self.vertex(side);
        found.map_or((Vec3::ZERO, 0), |(number, vertex)| (vertex, number as u32))
    }

    /// Returns the most nearly level face or edge at the furthest vertex, or the vertex if none is level enough. Of
    /// several furthest vertices or equally level faces it takes the one along [`ASIDE`], since the rounding of `d`
    /// must not decide: both ends of an edge touch an edge of another body.
    fn feature(&self, d: Vec3<S>) -> Feature<S> {
        let tilted = d + Vec3::from_f64(ASIDE) * S::new(TIE);
        let (Some(hull), Some((vertex, corner))) = (self.hull, self.vertex(tilted)) else {
            return Feature::corner(d, Vec3::ZERO);
        };
        if let Some(face) = hull.face_across(vertex, to_f64(tilted)) {
            let noticeable = self.bounding_radius() * S::new(NOTICEABLE);
            return face_feature(hull, face, vertex, d, noticeable);
        }
        let neighbors = hull.neighbors(vertex).iter().map(|&k| k as usize);
        let ends = neighbors.map(|k| (k, Vec3::from_f64(hull.vertices()[k].to_array())));
        let mut feature = Feature::corner(d, corner);
        if let Some((neighbor, end)) = most_level(corner, ends, d) {
            feature.corners.insert(usize::from(vertex < neighbor), end);
        }
        feature
    }
}

/// Returns a face of a hull. If corners are omitted, the furthest vertex is kept, except on a level face if it is not
/// noticeably further.
fn face_feature<S: Scalar>(
    hull: &Hull,
    face: usize,
    vertex: usize,
    d: Vec3<S>,
    noticeable: S,
) -> Feature<S> {
    let at = |v: u32| Vec3::from_f64(hull.vertices()[v as usize].to_array());
    let corners = hull.corners(face);
    let stride = corners.len().div_ceil(MAX_CORNERS - 1);
    let mut feature = Feature::along(Vec3::from_f64(hull.normal(face).to_array()));
    let level = (d - feature.normal).norm_squared() <= S::new(LEVEL * LEVEL);
    let sampled = corners.iter().step_by(stride).map(|&v| d.dot(at(v)));
    let furthest = sampled.fold(-S::INFINITY, S::max);
    let needed = !level || d.dot(at(vertex as u32)) > furthest + noticeable;
    for (k, &corner) in corners.iter().enumerate() {
        if k % stride == 0 || (needed && corner as usize == vertex) {
            feature.corners.push(at(corner));
        }
    }
    feature
}

fn to_f64<S: Scalar>(v: Vec3<S>) -> Vec3<f64> {
    Vec3::from_array(v.to_array().map(S::to_f64))
}
