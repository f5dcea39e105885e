//! The linear maps of positions that frames with scales make.
//!
//! A frame with pose (p, Q) and scales S takes a point x in it to p + Q S x. In a frame within it, at (q, R) and with scales T, a point
//! goes through S R T, which is R (Rᵀ S R) T: the orientation stays a rotation, and the frame within has the map Rᵀ S R T. That is
//! a shear where R does not keep the axes along which S differs. MuJoCo 4.0 has the same rule; its tolerances were found beside it.

use clench_math::{Mat3, Quat, Vec3};

/// The largest sine of the angle between an axis and what it is mapped to, and the largest relative difference of factors
/// that are to be equal.
const TOLERANCE: f64 = 0.0349;

/// What becomes of positions, in the axes of a frame, a body or a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stretch {
    /// All directions have the same factor.
    Uniform(f64),
    /// Factors differ between directions.
    General(Mat3<f64>),
}

impl Stretch {
    /// Positions stay as they are.
    pub(crate) const NONE: Stretch = Stretch::Uniform(1.0);

    /// A factor for each axis.
    pub(crate) fn along_axes(factors: Vec3<f64>) -> Self {
        Stretch::of(Mat3::diagonal(factors))
    }

    fn of(matrix: Mat3<f64>) -> Self {
        let factor = matrix.rows[0].x;
        let uniform = Mat3::diagonal(Vec3::new(factor, factor, factor));
        match matrix == uniform {
            true => Stretch::Uniform(factor),
            false => Stretch::General(matrix),
        }
    }

    pub(crate) fn to_matrix(self) -> Mat3<f64> {
        match self {
            Stretch::Uniform(factor) => Mat3::diagonal(Vec3::new(factor, factor, factor)),
            Stretch::General(matrix) => matrix,
        }
    }

    pub(crate) fn apply(self, point: Vec3<f64>) -> Vec3<f64> {
        match self {
            Stretch::Uniform(factor) => point * factor,
            Stretch::General(matrix) => matrix * point,
        }
    }

    /// The point that is mapped to this one.
    pub(crate) fn undo(self, point: Vec3<f64>) -> Vec3<f64> {
        match self {
            Stretch::Uniform(factor) => point * (1.0 / factor),
            Stretch::General(matrix) => {
                // Cramer's rule.
                let [a, b, c] = [0, 1, 2].map(|k| matrix.column(k));
                let solved = [b.cross(c), c.cross(a), a.cross(b)].map(|area| area.dot(point));
                Vec3::from_array(solved) * (1.0 / matrix.determinant())
            }
        }
    }

    /// The normal of a surface, not of unit length, whose normal was this before.
    pub(crate) fn normal(self, normal: Vec3<f64>) -> Vec3<f64> {
        match self {
            Stretch::Uniform(factor) => normal * (1.0 / factor),
            Stretch::General(matrix) => Stretch::General(matrix.transpose()).undo(normal),
        }
    }

    /// The same map in axes that are turned like this.
    pub(crate) fn turned(self, axes: Quat<f64>) -> Self {
        match self {
            Stretch::Uniform(_) => self,
            Stretch::General(matrix) => {
                let axes = axes.to_matrix();
                Stretch::of(axes.transpose() * (matrix * axes))
            }
        }
    }

    /// This map after another one in the same axes.
    pub(crate) fn after(self, inner: Stretch) -> Self {
        match (self, inner) {
            (Stretch::Uniform(outer), Stretch::Uniform(inner)) => Stretch::Uniform(outer * inner),
            (Stretch::Uniform(factor), Stretch::General(matrix))
            | (Stretch::General(matrix), Stretch::Uniform(factor)) => {
                Stretch::of(Mat3::diagonal(Vec3::new(factor, factor, factor)) * matrix)
            }
            (Stretch::General(outer), Stretch::General(inner)) => Stretch::of(outer * inner),
        }
    }

    /// The factor of lengths along each axis.
    pub(crate) fn factors(self) -> Vec3<f64> {
        match self {
            Stretch::Uniform(factor) => Vec3::new(factor, factor, factor),
            Stretch::General(matrix) => {
                Vec3::from_array([0, 1, 2].map(|k| matrix.column(k).norm()))
            }
        }
    }

    /// The factor of lengths along a direction; `None` where it turns that.
    pub(crate) fn factor_along(self, direction: Vec3<f64>) -> Option<f64> {
        let matrix = match self {
            Stretch::Uniform(factor) => return Some(factor),
            Stretch::General(matrix) => matrix,
        };
        let (unit, length) = direction.normalize();
        let (image, factor) = (matrix * unit).normalize();
        // A direction of no length is refused with the joint that has it.
        (length == 0.0 || unit.cross(image).norm() <= TOLERANCE).then_some(factor)
    }

    /// Whether it turns none of the first axes.
    pub(crate) fn keeps_axes(self, count: usize) -> bool {
        let axes = &Mat3::IDENTITY.rows[..count];
        axes.iter().all(|&axis| self.factor_along(axis).is_some())
    }
}

/// What frames with scales make of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deformation {
    /// What becomes of positions in its axes.
    pub(crate) stretch: Stretch,
    /// Whether it stretches between two points that were mapped, and so has its length already.
    pub(crate) segment: bool,
}

/// Whether factors are as good as equal.
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
        let outer = Stretch::along_axes(Vec3::new(1.0, 2.0, 3.0));
        let inner = Stretch::along_axes(Vec3::new(3.0, 2.0, 1.0));
        let turn = Quat::from_f64([0.9, 0.1, -0.3, 0.2]).normalize();
        let point = Vec3::new(0.3, -0.4, 0.5);
        let together = outer.turned(turn).after(inner);
        let expected = outer.apply(turn.rotate(inner.apply(point)));
        assert!(close(turn.rotate(together.apply(point)), expected));
        assert!(close(together.undo(together.apply(point)), point));
    }

    #[test]
    fn normals_stay_perpendicular_to_what_they_were_perpendicular_to() {
        let turn = Quat::from_f64([0.9, 0.1, -0.3, 0.2]).normalize();
        let map = Stretch::along_axes(Vec3::new(1.0, 2.0, 3.0)).turned(turn);
        let [tangent, normal] = [Vec3::new(1.0, 2.0, 0.0), Vec3::new(-2.0, 1.0, 0.7)];
        assert!(map.apply(tangent).dot(map.normal(normal)).abs() < 1e-12);
    }

    #[test]
    fn factors_that_undo_each_other_are_uniform() {
        let [a, b] = [Vec3::new(1.0, 2.0, 4.0), Vec3::new(4.0, 2.0, 1.0)].map(Stretch::along_axes);
        assert_eq!(a.after(b), Stretch::Uniform(4.0));
        assert!(
            a.turned(Quat::from_f64([1.0, 0.0, 0.0, 1.0]).normalize())
                .keeps_axes(3)
        );
        assert!(
            !a.turned(Quat::from_f64([1.0, 0.0, 0.0, 0.5]).normalize())
                .keeps_axes(1)
        );
    }
}
