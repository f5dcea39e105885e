//! The signed distance of two shapes.

use crate::compiled::compiled_collide;
use crate::contact::Contacts;
use crate::narrow::{Collide, PairMemory, SeparatingAxis, collide_again, supported};
use crate::pose::Pose;
use crate::shape::{Shape, Terrain};
use clench_math::{Mat3, Real, Scalar, Vec3};

/// The shortest connection between two shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Separation<S> {
    /// The signed distance, m; if negative, the distance to move apart for separation.
    pub distance: S,
    /// The unit vector from the first shape to the second along which the distance is measured.
    pub normal: Vec3<S>,
    /// The nearest point of each shape, or the deepest if they overlap, in world coordinates, m: `points[1] -
    /// points[0]` is `distance * normal`. If many are equally near, as on parallel faces, these are some of them.
    pub points: [Vec3<S>; 2],
}

/// Computes the signed distance of two shapes, in either order. Returns `None` if they are further apart than `limit`
/// metres (which may be infinite), if a number is not finite, or if the distance is undefined: between two planes, two
/// height fields, or a plane and a height field.
///
/// The distance is accurate to rounding or 1e-7 of the smaller shape's size, its points to 1e-6. A mesh is represented
/// by its convex hull. The depth of a shape in a height field is at least its depth in the ground below any single
/// triangle.
///
/// ```
/// use clench_collide::{Pose, Shape, ShapeKind, distance};
/// use clench_math::Vec3;
///
/// let ball = Shape::new(ShapeKind::Sphere, Vec3::new(0.1, 0.0, 0.0));
/// let cube = Shape::new(ShapeKind::Box, Vec3::new(0.5, 0.5, 0.5));
/// let beside = Pose { position: Vec3::new(0.7, 0.2, 0.0), ..Pose::IDENTITY };
///
/// let near = distance(&cube, &Pose::IDENTITY, &ball, &beside, 1.0).expect("0.1 m apart");
/// assert!((near.distance - 0.1_f64).abs() < 1e-12);
/// assert!((near.points[0] - Vec3::new(0.5, 0.2, 0.0)).norm() < 1e-12);
/// assert_eq!(distance(&cube, &Pose::IDENTITY, &ball, &beside, 0.05), None);
/// ```
pub fn distance<S: Scalar>(
    a: &Shape<S>,
    pose_a: &Pose<S>,
    b: &Shape<S>,
    pose_b: &Pose<S>,
    limit: S,
) -> Option<Separation<S>> {
    if S::IS_DUAL {
        return find(compiled_collide(), (a, pose_a), (b, pose_b), limit);
    }
    let found = find_in_double(
        &double_shape(a),
        &double_pose(pose_a),
        &double_shape(b),
        &double_pose(pose_b),
        limit.to_f64(),
    )?;
    Some(Separation {
        distance: S::new(found.distance),
        normal: Vec3::from_f64(found.normal.to_array()),
        points: found.points.map(|point| Vec3::from_f64(point.to_array())),
    })
}

fn double_vector<S: Scalar>(v: Vec3<S>) -> Vec3<f64> {
    Vec3::from_array(v.to_array().map(S::to_f64))
}

fn double_shape<'a, S: Scalar>(shape: &Shape<'a, S>) -> Shape<'a, f64> {
    shape.resized(double_vector(shape.size()))
}

fn double_pose<S: Scalar>(pose: &Pose<S>) -> Pose<f64> {
    let [x, y, z] = pose.rotation.rows.map(double_vector);
    Pose {
        position: double_vector(pose.position),
        rotation: Mat3::from_rows(x, y, z),
    }
}

/// Searches in double precision; compiled once.
fn find_in_double(
    a: &Shape<f64>,
    pose_a: &Pose<f64>,
    b: &Shape<f64>,
    pose_b: &Pose<f64>,
    limit: f64,
) -> Option<Separation<f64>> {
    find(collide_again, (a, pose_a), (b, pose_b), limit)
}

/// Searches among the contacts that `collide` finds.
fn find<S: Scalar>(
    collide: Collide<S>,
    (a, pose_a): (&Shape<S>, &Pose<S>),
    (b, pose_b): (&Shape<S>, &Pose<S>),
    limit: S,
) -> Option<Separation<S>> {
    if a.kind() > b.kind() {
        let found = find(collide, (b, pose_b), (a, pose_a), limit)?;
        let [second, first] = found.points;
        return Some(Separation {
            normal: -found.normal,
            points: [first, second],
            ..found
        });
    }
    if !supported(a.kind(), b.kind()) {
        return None;
    }
    let mut contacts = Contacts::new();
    let search = |reach: S, contacts: &mut Contacts<S>| {
        let mut axis = SeparatingAxis::default();
        let memory = &mut PairMemory::of_axis(&mut axis);
        collide(a, pose_a, b, pose_b, reach, memory, contacts);
    };
    let mut reach = Real::max(limit, S::ZERO);
    if let Shape::HeightField(Terrain {
        field: Some(field), ..
    }) = a
    {
        // Near cells first. No point of the field is further away than the sum.
        let size = b.bounding_radius();
        let radius = S::new(field.radius());
        let furthest = radius + size + (pose_b.position - pose_a.position).norm();
        let limit = Real::min(reach, furthest);
        reach = Real::max(size, furthest * S::new(MIN_SEARCH_SHARE));
        while reach < limit {
            search(reach, &mut contacts);
            if !contacts.as_slice().is_empty() {
                break;
            }
            reach *= S::new(SEARCH_GROWTH);
        }
        reach = limit;
    }
    if contacts.as_slice().is_empty() {
        search(reach, &mut contacts);
    }
    let mut points = contacts.as_slice().iter();
    let mut best = points.next()?;
    for point in points {
        if point.distance < best.distance {
            best = point;
        }
    }
    let (normal, half) = (best.frame.rows[0], S::new(0.5) * best.distance);
    let finite = Real::is_finite(best.position.norm_squared() + best.distance);
    (finite && best.distance <= limit).then(|| Separation {
        distance: best.distance,
        normal,
        points: [best.position - normal * half, best.position + normal * half],
    })
}

/// The initial search radius over a height field, as a fraction of the distance to its furthest point.
pub(crate) const MIN_SEARCH_SHARE: f64 = 1e-3;

/// The factor by which the search radius grows.
pub(crate) const SEARCH_GROWTH: f64 = 4.0;
