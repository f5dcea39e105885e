//! The features between which the depth of two overlapping polyhedra is measured.
//!
//! They alone determine the direction and the gap, so these do not depend on the course of a search.

use super::pair::{Gap, Pair, Vertex};
use super::polyhedron::{Polyhedra, Polyhedron};
use clench_math::{Real, Scalar, Vec3};

/// The features by their numbers. If several are equally deep, because they are parallel, the first kind is taken.
#[derive(Clone, Copy, Debug)]
pub(super) enum Touching {
    /// A face of the first body and the corner of the second that is furthest inside.
    FaceOfA(u32),
    /// A face of the second body and the corner of the first that is furthest inside.
    FaceOfB(u32),
    /// An edge of each, by its ends in order.
    Edges { a: [u32; 2], b: [u32; 2] },
}

/// The difference of gaps up to which they are equal, relative to the smaller body. Corners of a face differ from its
/// plane by rounding of 24-bit coordinates.
const TIE: f64 = 1e-7;

/// Returns the difference of gaps up to which features of different kinds are equally deep.
pub(super) fn tie<S: Scalar>(pair: &Pair<S>) -> S {
    Real::max(pair.tolerance, pair.smallest * S::new(TIE))
}

/// Returns the faces at a corner of each body that are most nearly perpendicular to a direction, given in both frames.
fn faces_across<S: Scalar>(
    bodies: &Polyhedra<S>,
    corners: [u32; 2],
    directions: [Vec3<S>; 2],
) -> [Option<Touching>; 2] {
    let [a, b] = [0, 1].map(|k| bodies[k].face_across(corners[k], directions[k]));
    [a.map(Touching::FaceOfA), b.map(Touching::FaceOfB)]
}

/// A gap and the points between which it is measured.
pub(super) type Measured<S> = (Gap<S>, Vertex<S>);

impl Touching {
    /// Returns the features of the deepest direction, given the gap that a search found and the triangle of the
    /// difference across it. `None` if they are not unique.
    pub(super) fn of<S: Scalar>(
        pair: &Pair<S>,
        bodies: &Polyhedra<S>,
        found: &Gap<S>,
        triangle: &[Vertex<S>; 3],
    ) -> Option<(Self, Measured<S>)> {
        let [a, b] = pair.vertex(found.normal).corners;
        let inward = -pair.rotation.transpose_mul(found.normal);
        let [face_a, face_b] = faces_across(bodies, [a, b], [found.normal, inward]);
        let furthest = Touching::Edges {
            a: bodies[0].furthest_edge(a, found.normal),
            b: bodies[1].furthest_edge(b, inward),
        };
        let [a, b] = [0, 1].map(|k| two_of(triangle.map(|vertex| vertex.corners[k])));
        let across = a.zip(b).map(|(a, b)| Touching::Edges { a, b });
        let candidates = [face_a, face_b, Some(furthest), across].map(|touching| {
            let touching = touching?;
            Some((touching, touching.measure(pair, bodies)?))
        });
        let gaps = candidates.iter().flatten().map(|(_, (gap, _))| gap.gap);
        let least = gaps.fold(found.gap, S::max) - tie(pair);
        let deepest = |(_, (gap, _)): &&(Self, Measured<S>)| gap.gap >= least;
        candidates.iter().flatten().find(deepest).copied()
    }

    /// Returns the gap along the direction that the features define. `None` if the bodies do not overlap along it, or
    /// edges are not the furthest along it.
    fn measure<S: Scalar>(&self, pair: &Pair<S>, bodies: &Polyhedra<S>) -> Option<Measured<S>> {
        let found = match *self {
            Touching::FaceOfA(face) => at_face_of_a(pair, bodies, face),
            Touching::FaceOfB(face) => at_face_of_b(pair, bodies, face),
            Touching::Edges { a, b } => between_edges(pair, bodies, a, b)?,
        };
        (-found.0.gap > pair.tolerance).then_some(found)
    }

    /// Returns the same, `None` also if features of an earlier kind may be as deep.
    pub(super) fn measure_first<S: Scalar>(
        &self,
        pair: &Pair<S>,
        bodies: &Polyhedra<S>,
    ) -> Option<Measured<S>> {
        let found = self.measure(pair, bodies)?;
        let inward = -pair.rotation.transpose_mul(found.0.normal);
        let faces = faces_across(bodies, found.1.corners, [found.0.normal, inward]);
        let earlier = match self {
            Touching::FaceOfA(_) => &[][..],
            Touching::FaceOfB(_) => &faces[..1],
            Touching::Edges { .. } => &faces[..],
        };
        let least = found.0.gap - S::new(2.0) * tie(pair);
        let as_deep = |touching: &Touching| {
            let other = touching.measure(pair, bodies);
            other.is_some_and(|(gap, _)| gap.gap >= least)
        };
        (!earlier.iter().flatten().any(as_deep)).then_some(found)
    }

    /// Returns true if a corner of each body belongs to the features, or is as far along their direction.
    pub(super) fn include<S: Scalar>(
        &self,
        pair: &Pair<S>,
        bodies: &Polyhedra<S>,
        (gap, between): &Measured<S>,
        [a, b]: [u32; 2],
    ) -> bool {
        let level = |from: Vec3<S>| gap.normal.dot(from).abs() <= pair.tolerance;
        match self {
            Touching::FaceOfA(face) => {
                let from = || pair.rotation * (bodies[1].corner(b) - between.b);
                bodies[0].is_on(*face, a) && level(from())
            }
            Touching::FaceOfB(face) => {
                bodies[1].is_on(*face, b) && level(bodies[0].corner(a) - between.a)
            }
            Touching::Edges { a: ends, b: others } => ends.contains(&a) && others.contains(&b),
        }
    }

    /// Returns true if the bodies have these features.
    pub(super) fn exist<S: Scalar>(&self, bodies: &Polyhedra<S>) -> bool {
        let within = |numbers: &[u32], count: usize| numbers.iter().all(|&k| (k as usize) < count);
        match self {
            Touching::FaceOfA(face) => within(&[*face], bodies[0].face_count()),
            Touching::FaceOfB(face) => within(&[*face], bodies[1].face_count()),
            Touching::Edges { a, b } => {
                within(a, bodies[0].corner_count()) && within(b, bodies[1].corner_count())
            }
        }
    }
}

fn at_face_of_a<S: Scalar>(pair: &Pair<S>, bodies: &Polyhedra<S>, face: u32) -> Measured<S> {
    let (normal, offset) = bodies[0].plane(face);
    let inward = -pair.rotation.transpose_mul(normal);
    let (b, corner) = pair.b.corner_along(inward, inward);
    let at = pair.offset + pair.rotation * b;
    let gap = normal.dot(at) - offset;
    measured(normal, gap, (at - normal * gap, 0), (b, corner))
}

fn at_face_of_b<S: Scalar>(pair: &Pair<S>, bodies: &Polyhedra<S>, face: u32) -> Measured<S> {
    let (outward, offset) = bodies[1].plane(face);
    let normal = -(pair.rotation * outward);
    let (a, corner) = pair.a.corner_along(normal, normal);
    let gap = normal.dot(pair.offset - a) - offset;
    let b = pair.rotation.transpose_mul(a + normal * gap - pair.offset);
    measured(normal, gap, (a, corner), (b, 0))
}

/// Returns the gap across two edges, `None` if other corners of the bodies may be as far along it.
fn between_edges<S: Scalar>(
    pair: &Pair<S>,
    [body_a, body_b]: &Polyhedra<S>,
    a: [u32; 2],
    b: [u32; 2],
) -> Option<Measured<S>> {
    let [p, q] = a.map(|k| body_a.corner(k));
    let [r, s] = b.map(|k| pair.offset + pair.rotation * body_b.corner(k));
    let (across, w) = ((q - p).cross(s - r), r - p);
    let (normal, length) = across.normalize();
    let gap = normal.dot(w);
    let (normal, gap) = (normal * -S::ONE.copysign(gap), -gap.abs());
    let margin = S::new(2.0) * tie(pair);
    let are_furthest = |body: &Polyhedron<S>, ends: [u32; 2], along: Vec3<S>| {
        ends.iter().all(|&end| {
            let least = along.dot(body.corner(end)) - margin;
            body.all_neighbors(end, |k| {
                ends.contains(&k) || along.dot(body.corner(k)) < least
            })
        })
    };
    let inward = -pair.rotation.transpose_mul(normal);
    if !are_furthest(body_a, a, normal) || !are_furthest(body_b, b, inward) {
        return None;
    }
    let share = w.cross(s - r).dot(across) / length.squared();
    let on_a = p + (q - p) * share;
    let on_b = pair
        .rotation
        .transpose_mul(on_a + normal * gap - pair.offset);
    Some(measured(normal, gap, (on_a, a[0]), (on_b, b[0])))
}

fn measured<S: Scalar>(
    normal: Vec3<S>,
    gap: S,
    (a, of_a): (Vec3<S>, u32),
    (b, of_b): (Vec3<S>, u32),
) -> Measured<S> {
    let found = Gap {
        normal,
        gap,
        is_exact: false,
    };
    let (w, corners) = (normal * gap, [of_a, of_b]);
    (found, Vertex { w, a, b, corners })
}

/// Returns the numbers in order if there are two different ones.
fn two_of(numbers: [u32; 3]) -> Option<[u32; 2]> {
    let least = numbers.into_iter().fold(u32::MAX, u32::min);
    let largest = numbers.into_iter().fold(0, u32::max);
    let two = least < largest && numbers.into_iter().all(|k| k == least || k == largest);
    two.then_some([least, largest])
}
