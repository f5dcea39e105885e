//! The linear maps of positions by frames with scales.
//!
//! A frame with pose (p, Q) and scales S maps a point x in it to p + Q S x. In a nested frame at (q, R) with scales T,
//! a point is mapped by S R T, which is R (Rᵀ S R) T: the orientation remains a rotation, and the nested frame has the
//! map Rᵀ S R T. That is a shear if R does not preserve the axes along which S differs. MuJoCo 4.0 has the same rule;
//! its tolerances were determined by comparison.

use clench_math::{Mat3, Quat, Vec3};

/// The maximum sine of the angle between an axis and its image, and the maximum relative difference of factors that
/// must be equal.
const TOLERANCE: f64 = 0.0349;

/// A linear map of positions, in the axes of a frame, a body or a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LinearMap {
    /// The same factor in all directions.
    Uniform(f64),
    /// A map whose factors depend on the direction.
    General(Mat3<f64>),
}

impl LinearMap {
    /// The identity.
    pub(crate) const NONE: LinearMap = LinearMap::Uniform(1.0);

    /// Creates a map from a factor for each axis.
    pub(crate) fn along_axes(factors: Vec3<f64>) -> Self {
        LinearMap::of(Mat3::diagonal(factors))
    }

    fn of(matrix: Mat3<f64>) -> Self {
        let factor = matrix.rows[0].x;
        let uniform = Mat3::diagonal(Vec3::new(factor, factor, factor));
        match matrix == uniform {
            true => LinearMap::Uniform(factor),
            false => LinearMap::General(matrix),
        }
    }

    pub(crate) fn to_matrix(self) -> Mat3<f64> {
        match self {
            LinearMap::Uniform(factor) => Mat3::diagonal(Vec3::new(factor, factor, factor)),
            LinearMap::General(matrix) => matrix,
        }
    }

    pub(crate) fn apply(self, point: Vec3<f64>) -> Vec3<f64> {
        match self {
            LinearMap::Uniform(factor) => point * factor,
            LinearMap::General(matrix) => matrix * point,
        }
    }

    /// Returns the point that is mapped to this one.
    pub(crate) fn undo(self, point: Vec3<f64>) -> Vec3<f64> {
        match self {
            LinearMap::Uniform(factor) => point * (1.0 / factor),
            LinearMap::General(matrix) => {
                // Cramer's rule.
                let [a, b, c] = [0, 1, 2].map(|k| matrix.column(k));
                let solved = [b.cross(c), c.cross(a), a.cross(b)].map(|area| area.dot(point));
                Vec3::from_array(solved) * (1.0 / matrix.determinant())
            }
        }
    }

    /// Maps the normal of a surface; the result does not have unit length.
    pub(crate) fn normal(self, normal: Vec3<f64>) -> Vec3<f64> {
        match self {
            LinearMap::Uniform(factor) => normal * (1.0 / factor),
            LinearMap::General(matrix) => LinearMap::General(matrix.transpose()).undo(normal),
        }
    }

    /// Returns the same map in rotated axes.
    pub(crate) fn rotated(self, axes: Quat<f64>) -> Self {
        match self {
            LinearMap::Uniform(_) => self,
            LinearMap::General(matrix) => {
                let axes = axes.to_matrix();
                LinearMap::of(axes.transpose() * (matrix * axes))
            }
        }
    }

    /// Composes this map with an inner one in the same axes.
    pub(crate) fn after(self, inner: LinearMap) -> Self {
        match (self, inner) {
            (LinearMap::Uniform(outer), LinearMap::Uniform(inner)) => {
                LinearMap::Uniform(outer * inner)
            }
            (LinearMap::Uniform(factor), LinearMap::General(matrix))
            | (LinearMap::General(matrix), LinearMap::Uniform(factor)) => {
                LinearMap::of(Mat3::diagonal(Vec3::new(factor, factor, factor)) * matrix)
            }
            (LinearMap::General(outer), LinearMap::General(inner)) => LinearMap::of(outer * inner),
        }
    }

    /// Returns the factor of lengths along each axis.
    pub(crate) fn factors(self) -> Vec3<f64> {
        match self {
            LinearMap::Uniform(factor) => Vec3::new(factor, factor, factor),
            LinearMap::General(matrix) => {
                Vec3::from_array([0, 1, 2].map(|k| matrix.column(k).norm()))
            }
        }
    }

    /// Returns the factor of lengths along a direction; `None` if the map rotates it.
    pub(crate) fn factor_along(self, direction: Vec3<f64>) -> Option<f64> {
        let matrix = match self {
            LinearMap::Uniform(factor) => return Some(factor),
            LinearMap::General(matrix) => matrix,
        };
        let (unit, length) = direction.normalize();
        let (image, factor) = (matrix * unit).normalize();
        // A zero direction is rejected with the joint that has it.
        (length == 0.0 || unit.cross(image).norm() <= TOLERANCE).then_some(factor)
    }

    /// Returns true if the first `count` axes are not rotated.
    pub(crate) fn keeps_axes(self, count: usize) -> bool {
        let axes = &Mat3::IDENTITY.rows[..count];
        axes.iter().all(|&axis| self.factor_along(axis).is_some())
    }
}

/// The deformation of a shape by frames with scales.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deformation {
    /// The linear map of positions in its axes.
    pub(crate) linear_map: LinearMap,
    /// True if the shape lies between two mapped points, and so already has its length.
    pub(crate) segment: bool,
}

/// Returns true if the factors are nearly equal.
pub(crate) fn nearly_equal(factors: &[f64]) -> bool {
    let largest = factors.iter().copied().fold(0.0, f64::max);
    let least = (1.0 - TOLERANCE) * largest;
    factors.iter().all(|&factor| factor >= least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Vec3<f64>, b: Vec3<f64>) -> bool {
        (a - b).norm() < 1e-12
    }

    #[test]
    fn a_frame_in_a_frame_maps_through_both() {
        let outer = LinearMap::along_axes(Vec3::new(1.0, 2.0, 3.0));
        let inner = LinearMap::along_axes(Vec3::new(3.0, 2.0, 1.0));
        let rotation = Quat::from_f64([0.9, 0.1, -0.3, 0.2]).normalize();
        let point = Vec3::new(0.3, -0.4, 0.5);
        let together = outer.rotated(rotation).after(inner);
        let expected = outer.apply(rotation.rotate(inner.apply(point)));
        assert!(close(rotation.rotate(together.apply(point)), expected));
        assert!(close(together.undo(together.apply(point)), point));
    }

    #[test]
    fn normals_stay_perpendicular_to_surfaces() {
        let rotation = Quat::from_f64([0.9, 0.1, -0.3, 0.2]).normalize();
        let map = LinearMap::along_axes(Vec3::new(1.0, 2.0, 3.0)).rotated(rotation);
        let [tangent, normal] = [Vec3::new(1.0, 2.0, 0.0), Vec3::new(-2.0, 1.0, 0.7)];
        assert!(map.apply(tangent).dot(map.normal(normal)).abs() < 1e-12);
    }

    #[test]
    fn factors_that_undo_each_other_are_uniform() {
        let [a, b] =
            [Vec3::new(1.0, 2.0, 4.0), Vec3::new(4.0, 2.0, 1.0)].map(LinearMap::along_axes);
        assert_eq!(a.after(b), LinearMap::Uniform(4.0));
        assert!(
            a.rotated(Quat::from_f64([1.0, 0.0, 0.0, 1.0]).normalize())
                .keeps_axes(3)
        );
        assert!(
            !a.rotated(Quat::from_f64([1.0, 0.0, 0.0, 0.5]).normalize())
                .keeps_axes(1)
        );
    }
}
