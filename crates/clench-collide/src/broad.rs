//! Broad phase: which pairs of shapes are near enough to be worth asking about.

use crate::{Pose, Shape, ShapeKind, bounding_radius};
use clench_math::{Mask, Real, Scalar, kernel};

/// By how much bounding radii and margins are enlarged, a hair more than 1, so that rounding never rejects a pair in which the
/// narrow phase would find a point: what an environment gets must not depend on its neighbours in the lanes.
#[inline(always)]
pub fn allowance<T: Real>() -> T {
    T::ONE + T::new(1e-6).max(T::splat(T::Scalar::EPSILON) * T::new(64.0))
}

/// What the broad phase knows of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound<T> {
    /// Radius of a sphere about the shape's origin that holds it, m.
    pub radius: T,
    /// Whether it is a plane, which no sphere holds.
    pub plane: bool,
}

impl<T: Real> Bound<T> {
    /// The bound of a shape: [`bounding_radius`] with its [`allowance`].
    #[inline(always)]
    pub fn new(shape: &Shape<T>) -> Self {
        Bound {
            radius: bounding_radius(shape) * allowance(),
            plane: shape.kind == ShapeKind::Plane,
        }
    }
}

/// In which environments two shapes are near enough that they may be within `margin` metres of each other. Two planes
/// never are.
#[inline(always)]
pub fn near<T: Real>(
    a: &Bound<T>,
    pose_a: &Pose<T>,
    b: &Bound<T>,
    pose_b: &Pose<T>,
    margin: T,
) -> T::Mask {
    let offset = pose_b.position - pose_a.position;
    let margin = margin * allowance();
    match (a.plane, b.plane) {
        (false, false) => {
            let reach = a.radius + b.radius + margin;
            offset.norm_squared().le(reach * reach)
        }
        (true, false) => pose_a.axis().dot(offset).le(b.radius + margin),
        (false, true) => (-pose_b.axis().dot(offset)).le(a.radius + margin),
        (true, true) => T::Mask::splat(false),
    }
}

/// Sweep and prune, for scenes of so many shapes that listing all pairs would be too much.
///
/// Each shape's bounding sphere covers an interval of a coordinate axis; sorted by where they begin, only shapes whose
/// intervals overlap need be compared. The axis is the one along which the shapes spread most.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    /// Interval and index of each shape, sorted by where it begins. Planes are first: they reach everywhere.
    intervals: Vec<(f64, f64, u32)>,
}

impl Sweep {
    /// An empty sweep. Its buffer grows to the largest scene seen.
    pub fn new() -> Self {
        Sweep::default()
    }

    /// Replaces `pairs` by those (i, j), i < j, ascending, that `allowed` admits and that are [`near`] in any
    /// environment with the margin `margins[i] + margins[j]`.
    #[kernel]
    pub fn pairs<T: Real>(
        &mut self,
        bounds: &[Bound<T>],
        poses: &[Pose<T>],
        margins: &[T],
        mut allowed: impl FnMut(u32, u32) -> bool,
        pairs: &mut Vec<(u32, u32)>,
    ) {
        pairs.clear();
        self.sort(bounds, poses, margins);
        for (k, &(_, end, one)) in self.intervals.iter().enumerate() {
            for &(begin, _, other) in &self.intervals[k + 1..] {
                if begin > end {
                    break;
                }
                let (i, j) = (one.min(other), one.max(other));
                if !allowed(i, j) {
                    continue;
                }
                let (a, b) = (i as usize, j as usize);
                let margin = margins[a] + margins[b];
                if near(&bounds[a], &poses[a], &bounds[b], &poses[b], margin).any() {
                    pairs.push((i, j));
                }
            }
        }
        pairs.sort_unstable();
    }

    fn sort<T: Real>(&mut self, bounds: &[Bound<T>], poses: &[Pose<T>], margins: &[T]) {
        let axis = widest_axis(bounds, poses);
        self.intervals.clear();
        for (index, bound) in bounds.iter().enumerate() {
            let (mut begin, mut end) = (f64::NEG_INFINITY, f64::INFINITY);
            if !bound.plane {
                let center = poses[index].position[axis];
                (begin, end) = (f64::INFINITY, f64::NEG_INFINITY);
                for lane in 0..T::LANES {
                    let number = |x: T| x.lane(lane).to_f64();
                    let reach = number(bound.radius) + number(margins[index]);
                    begin = begin.min(number(center) - reach);
                    end = end.max(number(center) + reach);
                }
            }
            self.intervals.push((begin, end, index as u32));
        }
        self.intervals
            .sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
    }
}

/// The coordinate axis along which the shapes' centres vary most in the first environment.
fn widest_axis<T: Real>(bounds: &[Bound<T>], poses: &[Pose<T>]) -> usize {
    let mut count = 0.0;
    let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
    for (bound, pose) in bounds.iter().zip(poses) {
        if bound.plane {
            continue;
        }
        count += 1.0;
        for axis in 0..3 {
            let x = pose.position[axis].lane(0).to_f64();
            sum[axis] += x;
            squares[axis] += x * x;
        }
    }
    let spread = |axis: usize| count * squares[axis] - sum[axis] * sum[axis];
    (1..3).fold(0, |best, axis| {
        if spread(axis) > spread(best) {
            axis
        } else {
            best
        }
    })
}
