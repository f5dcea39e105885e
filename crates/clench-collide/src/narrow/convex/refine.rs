//! Local maximization of the gap by Newton's method.
//!
//! With the gap's gradient w − g n across the direction n and its Hessian −(H_A + H_B + g 1), a step is the t across n
//! with
//!
//! ```text
//! (H_A + H_B + g 1) t = w − g n,      n ← (n + t) / |n + t|.
//! ```
//!
//! If an edge (or face) of a body touches, the support function has a crease there and n stays across that edge, which
//! leaves one unknown, or none. Near the axis of a cylinder the gap of its flat cap is tried as well, since the support
//! function of a disc is not smooth there.
//!
//! Every direction's gap is a lower bound of the signed distance, so results are compared by their gaps alone.

use super::pair::{Gap, Pair, Vertex, across};
use arrayvec::ArrayVec;
use clench_math::{Scalar, Vec3};

/// The maximum number of steps. Newton's method converges quadratically or not at all.
pub(crate) const MAX_STEPS: usize = 12;
/// The maximum number of halvings of a step that decreases the gap.
pub(crate) const MAX_HALVINGS: usize = 3;
/// The maximum rotation of a step, rad.
pub(crate) const MAX_ROTATION: f64 = 0.3;
/// The rotation of the last step, in double precision; the next one's would be of the order of its square.
const CONVERGED_ROTATION: f64 = 2e-6;

/// The orthonormal directions of the touching edges: none, one edge, or two that span a face (or cross).
pub(super) struct ActiveEdges<S> {
    directions: ArrayVec<Vec3<S>, 2>,
}

impl<S: Scalar> ActiveEdges<S> {
    /// Computes the span of the edges between the corners of some vertices.
    pub(super) fn of(pair: &Pair<S>, vertices: &[Vertex<S>]) -> Self {
        let mut active = ActiveEdges {
            directions: ArrayVec::new(),
        };
        let corners = |v: &Vertex<S>| (pair.a.corner(v.a), pair.b.corner(v.b));
        let (a, b) = corners(&vertices[0]);
        for vertex in &vertices[1..] {
            let (other_a, other_b) = corners(vertex);
            active.extend(other_a - a);
            active.extend(pair.rotation * (other_b - b));
        }
        active
    }

    fn extend(&mut self, edge: Vec3<S>) {
        let length = edge.norm();
        if self.directions.is_full() || length <= S::MIN_POSITIVE {
            return;
        }
        let rest = self.across(edge);
        let left = rest.norm();
        if left > length * S::EPSILON.sqrt() * S::new(64.0) {
            self.directions.push(rest * (S::ONE / left));
        }
    }

    fn across(&self, v: Vec3<S>) -> Vec3<S> {
        self.directions.iter().fold(v, |v, &f| v - f * f.dot(v))
    }

    /// Returns the direction across the edges that is nearest to `n`; `n` if there is none.
    fn project(&self, n: Vec3<S>) -> Vec3<S> {
        let across = match self.directions[..] {
            [f, g] => {
                let normal = f.cross(g);
                normal * normal.dot(n)
            }
            _ => self.across(n),
        };
        let length = across.norm();
        if length > S::new(0.5) {
            across * (S::ONE / length)
        } else {
            n
        }
    }

    /// Returns true if leaving the edge, to either side, decreases the gap. (Not tested for two edges.)
    fn hold(&self, pair: &Pair<S>, n: Vec3<S>) -> bool {
        let [f] = self.directions[..] else {
            return true;
        };
        let along =
            |side: Vec3<S>| side.dot(pair.vertex_against(n, n + side * S::EPSILON.sqrt()).w);
        along(f) <= pair.tolerance && along(-f) <= pair.tolerance
    }

    /// Returns the vertices at the direction `n`: one for each touching corner.
    pub(super) fn vertices(&self, pair: &Pair<S>, n: Vec3<S>) -> ArrayVec<Vertex<S>, 4> {
        let tilt = S::EPSILON.sqrt();
        let beside = |side| pair.vertex_against(n, n + side * tilt);
        let mut vertices = ArrayVec::new();
        match self.directions[..] {
            [] => vertices.push(pair.vertex(n)),
            [f] => vertices.extend([f, -f].map(beside)),
            [f, g, ..] => vertices.extend([f + g, g - f, -f - g, f - g].map(beside)),
        }
        vertices
    }
}

impl<S: Scalar> Gap<S> {
    /// Refines the direction if it is not exact and a curved body touches the feature spanned by some vertices.
    pub(super) fn refine_inexact(&mut self, pair: &Pair<S>, vertices: &[Vertex<S>]) {
        if pair.curved && !self.is_exact {
            let active = ActiveEdges::of(pair, vertices);
            self.improve(refine(pair, self.normal, &active), pair.tolerance);
        }
    }
}

/// Returns the largest gap near a direction.
pub(super) fn refine<S: Scalar>(pair: &Pair<S>, start: Vec3<S>, active: &ActiveEdges<S>) -> Gap<S> {
    let start = active.project(start);
    if active.directions.is_full() {
        return pair.gap(start);
    }
    match cap(pair, start) {
        Some(Cap::Touches(gap)) => gap,
        Some(Cap::Passes(start)) => climb(pair, start, active),
        None => climb(pair, start, active),
    }
}

/// The gap near the axis of a flat cap.
enum Cap<S> {
    /// The gap across it, the largest nearby.
    Touches(Gap<S>),
    /// The start direction of a search: the gap is larger next to the axis.
    Passes(Vec3<S>),
}

/// Returns the best cap that approximately faces `n`, if the gap across it is larger than that of `n`.
fn cap<S: Scalar>(pair: &Pair<S>, n: Vec3<S>) -> Option<Cap<S>> {
    let mut best = None;
    let mut found = None;
    let z = Vec3::new(S::ZERO, S::ZERO, S::ONE);
    let caps = [(&pair.a, z), (&pair.b, pair.rotation.column(2))];
    for (k, (body, axis)) in caps.into_iter().enumerate() {
        let Some(radius) = body.cap() else { continue };
        let cosine = axis.dot(n);
        if cosine.abs() < S::new(MAX_ROTATION.cos()) {
            continue;
        }
        let axis = axis * S::ONE.copysign(cosine);
        let vertex = pair.vertex(axis);
        let gap = axis.dot(vertex.w);
        if gap <= *best.get_or_insert_with(|| pair.gap(n).gap) {
            continue;
        }
        best = Some(gap);
        // From the middle of the cap to the other body's point: within the disc, or the gap increases towards it.
        let to_middle = if k == 0 {
            vertex.a - body.corner(vertex.a)
        } else {
            pair.rotation * (body.corner(vertex.b) - vertex.b)
        };
        let lateral = vertex.w + to_middle;
        let lateral = lateral - axis * axis.dot(lateral);
        let (toward, distance) = lateral.normalize();
        let passes = distance > radius * (S::ONE + S::new(1e-9)) && distance > S::new(1e-15);
        found = Some(if passes {
            // Next to the axis, since on it no point of the circle is distinguished.
            let start = axis + toward * S::EPSILON.sqrt();
            let [bend] = pair.curvature(start, [(toward, toward)]);
            let rotation = (distance - radius) / (bend + gap).max(pair.tolerance);
            let rotation = rotation.clamp(S::EPSILON.sqrt(), S::new(MAX_ROTATION));
            Cap::Passes((axis + toward * rotation).normalize().0)
        } else {
            Cap::Touches(Gap {
                normal: axis,
                gap,
                is_exact: true,
            })
        });
    }
    found
}

/// Runs Newton's iteration; a step that decreases the gap is halved.
fn climb<S: Scalar>(pair: &Pair<S>, start: Vec3<S>, active: &ActiveEdges<S>) -> Gap<S> {
    let last = S::new(CONVERGED_ROTATION).max(S::EPSILON * S::new(256.0));
    let mut w = pair.vertex(start).w;
    let mut best = Gap {
        normal: start,
        gap: start.dot(w),
        is_exact: false,
    };
    for _ in 0..MAX_STEPS {
        let Some((mut rotation, down)) = step(pair, &best, w, active) else {
            return best;
        };
        let size = rotation.norm();
        if size > S::new(MAX_ROTATION) {
            rotation = rotation * (S::new(MAX_ROTATION) / size);
        }
        let mut halvings = 0;
        let before = best.gap;
        loop {
            let (tried, _) = (best.normal + rotation).normalize();
            w = pair.vertex(tried).w;
            let gap = tried.dot(w);
            if gap >= best.gap - pair.tolerance * S::new(1e-3) {
                (best.normal, best.gap) = (tried, gap);
                break;
            }
            if halvings == MAX_HALVINGS {
                return best;
            }
            halvings += 1;
            rotation = rotation * S::new(0.5);
        }
        // If a cap's circle touches, next to the axis, even the smallest rotation changes the gap.
        if size <= last && best.gap - before <= pair.tolerance {
            best.is_exact = down && active.hold(pair, best.normal);
            return best;
        }
    }
    best
}

/// Returns the step t, and true if the gap is concave there; `None` if it is convex in both directions.
fn step<S: Scalar>(
    pair: &Pair<S>,
    at: &Gap<S>,
    w: Vec3<S>,
    active: &ActiveEdges<S>,
) -> Option<(Vec3<S>, bool)> {
    let (n, gap) = (at.normal, at.gap);
    if let [f] = active.directions[..] {
        let e = n.cross(f);
        let [bend] = pair.curvature(n, [(e, e)]);
        let bend = bend + gap;
        return (bend > S::ZERO).then(|| (e * (e.dot(w) / bend), true));
    }
    let (e, f) = across(n);
    let [ee, ef, ff] = pair.curvature(n, [(e, e), (e, f), (f, f)]);
    let half = S::new(0.5);
    let mean = (ee + ff) * half + gap;
    let spread = (((ee - ff) * half).squared() + ef * ef).sqrt();
    let (least, largest) = (mean - spread, mean + spread);
    if largest <= S::ZERO {
        return None;
    }
    // Around an axis that both bodies share the gap is constant; on a saddle, increase the distance from it.
    let floor = largest * S::new(1e-6);
    let shift = (floor - least).max(S::ZERO);
    let (ee, ff) = (ee + gap + shift, ff + gap + shift);
    let inverse = S::ONE / (ee * ff - ef * ef);
    let (we, wf) = (e.dot(w), f.dot(w));
    let rotation = e * ((ff * we - ef * wf) * inverse) + f * ((ee * wf - ef * we) * inverse);
    Some((rotation, least > -floor))
}
