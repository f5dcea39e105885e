//! The box.

use super::core::Core;
use super::feature::{EDGE_SINE, Feature};
use super::solid::{Homogeneous, Solid, about_axes, within};
use crate::hull::FACE_COSINE;
use crate::ray::chord::Chord;
use crate::ray::line::Line;
use clench_math::{Double, Real, Scalar, Vec3};

/// A box about the local axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid<T> {
    /// Half the lengths along x, y and z, m.
    pub half_lengths: Vec3<T>,
}

impl<T: Real> Solid<T> for Cuboid<T> {
    type InDouble = Cuboid<Double<T>>;

    #[inline(always)]
    fn lane_in_double(&self, lane: usize) -> Self::InDouble {
        Cuboid {
            half_lengths: self.half_lengths.lane_in_double(lane),
        }
    }

    #[inline(always)]
    fn size(&self) -> Vec3<T> {
        self.half_lengths
    }

    #[inline(always)]
    fn bounding_radius(&self) -> T {
        self.half_lengths.norm()
    }

    /// Returns Σ hᵢ |dᵢ|.
    #[inline(always)]
    fn reach_along(&self, d: Vec3<T>) -> T {
        let h = self.half_lengths;
        h.x * d.x.abs() + h.y * d.y.abs() + h.z * d.z.abs()
    }

    #[inline(always)]
    fn contains(&self, point: Vec3<T>) -> T::Mask {
        within(point, self.half_lengths)
    }

    #[inline(always)]
    fn hit(&self, line: &Line<T>) -> (T, Vec3<T>) {
        let mut chord = Chord::whole();
        for axis in 0..3 {
            chord = chord.slab(
                line,
                axis,
                -self.half_lengths[axis],
                self.half_lengths[axis],
            );
        }
        chord.first()
    }
}

impl<S: Scalar> Core<S> for Cuboid<S> {
    #[inline]
    fn support(&self, _: Vec3<S>, side: Vec3<S>) -> Vec3<S> {
        let h = self.half_lengths;
        Vec3::new(
            h.x.copysign(side.x),
            h.y.copysign(side.y),
            h.z.copysign(side.z),
        )
    }

    #[inline]
    fn corner_along(&self, d: Vec3<S>, side: Vec3<S>) -> (Vec3<S>, u32) {
        let corner = self.support(d, side);
        let [x, y, z] = corner.to_array().map(|x| u32::from(x < S::ZERO));
        (corner, x | y << 1 | z << 2)
    }

    fn feature(&self, d: Vec3<S>) -> Feature<S> {
        let (size, corner) = (self.half_lengths, self.support(d, d));
        let Some(axis) = (0..3).find(|i| d[*i].abs() >= S::new(FACE_COSINE)) else {
            return match (0..3).find(|i| d[*i].abs() <= S::new(EDGE_SINE)) {
                Some(axis) => Feature::edge(d, corner, axis),
                None => Feature::corner(d, corner),
            };
        };
        let sign = S::ONE.copysign(d[axis]);
        let mut normal = Vec3::ZERO;
        normal[axis] = sign;
        let mut face = Feature::along(normal);
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let mut corner = corner;
            corner[next] = size[next] * S::new(u) * sign;
            corner[last] = size[last] * S::new(v);
            face.corners.push(corner);
        }
        face
    }

    fn nearest(&self, point: impl FnOnce() -> Vec3<S>) -> Option<Vec3<S>> {
        let (p, h) = (point(), self.half_lengths);
        Some(Vec3::new(
            p.x.clamp(-h.x, h.x),
            p.y.clamp(-h.y, h.y),
            p.z.clamp(-h.z, h.z),
        ))
    }

    fn edge_axes(&self) -> &'static [usize] {
        &[0, 1, 2]
    }

    fn face_axes(&self) -> &'static [usize] {
        &[0, 1, 2]
    }
}

impl Homogeneous for Cuboid<f64> {
    fn measure(&self, shell: bool) -> f64 {
        let Vec3 { x: a, y: b, z: c } = self.half_lengths;
        match shell {
            false => a * b * c * 8.0,
            true => 8.0 * (a * b + b * c + c * a),
        }
    }

    /// Sums six faces for the shell. With half lengths a, b, c the two faces across x have mass m bc/(ab + bc + ca) and
    /// second moments a², b²/3, c²/3 per mass, and so on.
    fn moments(&self, mass: f64, shell: bool) -> Vec3<f64> {
        let size = self.half_lengths;
        if !shell {
            return about_axes(size.scale_by(size) * (mass / 3.0));
        }
        let faces = Vec3::new(size.y * size.z, size.z * size.x, size.x * size.y);
        let faces = faces * (mass / (faces.x + faces.y + faces.z));
        let mut second = Vec3::ZERO;
        for axis in 0..3 {
            second[axis] = size[axis] * size[axis] * (faces[axis] + (mass - faces[axis]) / 3.0);
        }
        about_axes(second)
    }
}
