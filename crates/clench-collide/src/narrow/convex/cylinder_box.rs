//! The largest gap of a cylinder and a box that overlap, among the few directions that can have it.
//!
//! Where two bodies overlap, the shortest way out ends at a smooth point of the boundary of their difference: exactly one
//! direction n leads across it. With a cylinder of axis z and a box of axes b that leaves
//!
//! ```text
//! b, z         a face of the box; a cap                z × b       an edge of the box across the side of the cylinder
//! n across z   a corner of the box on the side         n across b  an edge of the box on the rim
//! ```
//!
//! A corner on the side matters only where all of the box is beside the axis, and then it is the corner nearest to it. Seen
//! along b the rim is an ellipse, the edge a point, and n the normal of the ellipse that goes through that point. Most edges need
//! not be asked: between two directions that have no larger gap than is known already, none is larger if the chord from
//! where the one touches the ellipse to where the other does is as deep.
//!
//! If the bodies are apart some of these directions show it, but then the largest gap may be along another.

use super::{
    best::Best,
    ellipse::Ellipse,
    pair::{Gap, Pair},
};
use clench_math::{Scalar, Vec3};

/// The largest gap if that is not positive, else one that is.
pub(super) fn largest_gap<S: Scalar>(pair: &Pair<S>) -> Gap<S> {
    let (view, mirror) = View::new(pair);
    let mut best = Best::new(pair.tolerance);
    view.search(&mut best);
    Gap {
        normal: pair.rotation * best.normal.scale_by(mirror),
        gap: best.gap,
        settled: true,
    }
}

/// Both bodies in the frame of the box, mirrored so that the cylinder's axis has no negative coordinate.
struct View<S> {
    axis: Vec3<S>,
    /// From the middle of the cylinder to that of the box.
    offset: Vec3<S>,
    /// Half lengths of the box.
    sides: Vec3<S>,
    radius: S,
    half: S,
    /// The sines of the angles between the axis and those of the box, and their inverses.
    sines: [S; 3],
    inverse: [S; 3],
}

impl<S: Scalar> View<S> {
    /// The view, and −1 where an axis is mirrored.
    fn new(pair: &Pair<S>) -> (Self, Vec3<S>) {
        let axis = pair.rotation.rows[2];
        let mirror = Vec3::from_array(axis.to_array().map(|x| S::ONE.copysign(x)));
        let axis = axis.scale_by(mirror);
        let sines = [0, 1, 2].map(|i| {
            let (j, k) = others(i);
            (axis[j] * axis[j] + axis[k] * axis[k]).sqrt()
        });
        let view = View {
            axis,
            offset: pair.rotation.transpose_mul(pair.offset).scale_by(mirror),
            sides: pair.b.size(),
            radius: pair.a.size().x,
            half: pair.a.size().y,
            inverse: sines.map(|sine| S::ONE / sine),
            sines,
        };
        (view, mirror)
    }

    /// Tries all directions until one shows that the bodies are apart.
    fn search(&self, best: &mut Best<S>) {
        self.faces(best);
        if best.gap > S::ZERO {
            return;
        }
        let sides = [0, 1, 2].map(|i| Side::new(self, i));
        let mut beside = false;
        for side in sides.iter().flatten() {
            beside |= side.gaps(self, best);
        }
        if beside {
            self.corner(best);
        }
        for side in sides.iter().flatten() {
            if best.gap > S::ZERO {
                return;
            }
            side.rims(self, best);
        }
    }

    /// The faces of the box and the caps.
    #[inline]
    fn faces(&self, best: &mut Best<S>) {
        for i in 0..3 {
            let reach = self.sides[i] + self.half * self.axis[i] + self.radius * self.sines[i];
            best.offer(self.offset[i].abs() - reach, || {
                let mut normal = Vec3::ZERO;
                normal[i] = S::ONE.copysign(self.offset[i]);
                normal
            });
        }
        let along = self.axis.dot(self.offset);
        let gap = along.abs() - self.half - self.sides.dot(self.axis);
        best.offer(gap, || self.axis * S::ONE.copysign(along));
    }

    /// The corner of the box that is nearest to the axis, against the side of the cylinder.
    fn corner(&self, best: &mut Best<S>) {
        let mut least = (S::INFINITY, Vec3::ZERO);
        for signs in 0..8 {
            let side = |i: usize| match signs >> i & 1 {
                0 => self.offset[i] - self.sides[i],
                _ => self.offset[i] + self.sides[i],
            };
            let moment = self.axis.cross(Vec3::new(side(0), side(1), side(2)));
            let square = moment.norm_squared();
            if square < least.0 {
                least = (square, moment);
            }
        }
        let (normal, distance) = least.1.cross(self.axis).normalize();
        if distance > S::ZERO {
            best.offer(self.gap(normal), || normal);
        }
    }

    /// The gap along any unit direction.
    fn gap(&self, n: Vec3<S>) -> S {
        let of_box = n.x.abs() * self.sides.x + n.y.abs() * self.sides.y + n.z.abs() * self.sides.z;
        let of_cylinder =
            self.half * n.dot(self.axis).abs() + self.radius * n.cross(self.axis).norm();
        n.dot(self.offset) - of_box - of_cylinder
    }
}

/// The axes after an axis, in turn.
#[inline]
fn others(i: usize) -> (usize, usize) {
    ((i + 1) % 3, (i + 2) % 3)
}

/// Both bodies seen along an axis b of the box: with coordinates along the cylinder's axis, as it is seen, and across it.
struct Side<S> {
    /// Which axis of the box.
    looking: usize,
    /// The unit directions of those coordinates, in the view.
    along: Vec3<S>,
    across: Vec3<S>,
    /// Of the middle of the box.
    offset: (S, S),
    /// How far the box reaches.
    reach: (S, S),
}

impl<S: Scalar> Side<S> {
    /// Nothing if the axes are parallel: then all is seen along the others.
    #[inline]
    fn new(view: &View<S>, looking: usize) -> Option<Self> {
        if view.sines[looking] <= S::EPSILON {
            return None;
        }
        let (j, k) = others(looking);
        let inverse = view.inverse[looking];
        let (mut along, mut across) = (Vec3::ZERO, Vec3::ZERO);
        (along[j], along[k]) = (view.axis[j] * inverse, view.axis[k] * inverse);
        (across[j], across[k]) = (-along[k], along[j]);
        Some(Side {
            looking,
            along,
            across,
            offset: (along.dot(view.offset), across.dot(view.offset)),
            reach: (
                along[j] * view.sides[j] + along[k] * view.sides[k],
                along[k] * view.sides[j] + along[j] * view.sides[k],
            ),
        })
    }

    /// The directions across and along the axis. Whether the box is beside it.
    #[inline]
    fn gaps(&self, view: &View<S>, best: &mut Best<S>) -> bool {
        let (along, across) = self.offset;
        let i = self.looking;
        let beside = across.abs() - self.reach.1;
        best.offer(beside - view.radius, || {
            self.across * S::ONE.copysign(across)
        });
        let length = view.half * view.sines[i] + view.radius * view.axis[i];
        best.offer_inexact(along.abs() - self.reach.0 - length, || {
            self.along * S::ONE.copysign(along)
        });
        beside > S::ZERO
    }

    /// Edges along b on the rims. Coordinates from here on are in radii, x across the cylinder's axis and y along it. Between
    /// these two directions lies one of those of the box: a quarter of an ellipse is made of two arcs, a lower one from x and an
    /// upper one to y. Of the four edges one has two upper arcs, its opposite too, and each of the others a lower arc at
    /// either rim.
    fn rims(&self, view: &View<S>, best: &mut Best<S>) {
        let (i, (j, k)) = (self.looking, others(self.looking));
        let cosine = view.axis[i];
        if view.radius <= S::ZERO || cosine <= S::EPSILON {
            return;
        }
        let unit = S::ONE / view.radius;
        let (z_j, z_k) = (self.along[j], self.along[k]);
        // Where on the ellipse the faces across j and k touch.
        let on_j = (z_k * view.inverse[j], cosine * z_j * view.inverse[j]);
        let on_k = (z_j * view.inverse[k], cosine * z_k * view.inverse[k]);
        let ellipse = Ellipse::new(cosine, view.sines[i]);
        let ends = [on_j, on_k].map(|(x, y)| (x, cosine * y));
        let cap = view.half * view.sines[i];
        for sign in [S::ONE, -S::ONE] {
            let (along, across) = (self.offset.0 * sign, self.offset.1 * sign);
            let mut look = |side: S, up: S, point: (S, S), from: (S, S), to: (S, S)| {
                let point = (point.0 * unit, point.1 * unit);
                if ellipse.chord_is_deep(from, to, point, best.depth() * unit) {
                    return;
                }
                if let Some((x, y)) = ellipse.normal_through(point) {
                    let normal = self.across * (x * side * sign) + self.along * (y * up * sign);
                    best.offer(view.gap(normal), || normal);
                }
            };
            // The edge at the lower end of the box, seen along the axis.
            let x = across - (z_j * view.sides[k] - z_k * view.sides[j]);
            let side = S::ONE.copysign(x);
            let point = (x.abs(), along - self.reach.0 - cap);
            let end = if x < S::ZERO { ends[0] } else { ends[1] };
            look(side, S::ONE, point, end, (S::ZERO, cosine));
            // The edge nearest to the axis, if the box is beside it.
            let x = across - self.reach.1;
            if x > S::ZERO {
                let y = along + (z_j * view.sides[j] - z_k * view.sides[k]);
                look(S::ONE, S::ONE, (x, y - cap), (S::ONE, S::ZERO), ends[1]);
                look(S::ONE, -S::ONE, (x, -y - cap), (S::ONE, S::ZERO), ends[0]);
            }
        }
    }
}
