//! Spatial tendons: strings through sites, around or through spheres and cylinders, in branches whose lengths are
//! divided.
//!
//! A straight span of unit direction u between the points p and q has the length |q − p|, with the rate u · (q̇ − ṗ).
//! The ends of a string's part on the surface of a geom count as fixed to it: the string is the shortest, so to first
//! order its length does not depend on the contact points. Thus a tendon's gradient is that of its straight spans, each
//! between points of two bodies.

use crate::dynamics::chains::{BodyPoint, Chains, Side};
use crate::dynamics::wrap::{Obstacle, WrapShape, wrap};
use crate::model::{Model, Params, Section, Tendon};
use crate::stages::{Positions, Velocities};
use clench_collide::ShapeKind;
use clench_math::{Real, Vec3, kernel};

/// Points closer than this (m) define no direction (MuJoCo's `mjMINVAL`).
const MIN_DISTANCE: f64 = 1e-15;

/// A straight part of a tendon between two bodies.
#[derive(Clone, Copy, Debug)]
pub struct Span<T> {
    /// The bodies of its ends.
    pub bodies: [usize; 2],
    /// Its ends, in the world.
    pub points: [Vec3<T>; 2],
    /// The unit vector from the first to the second, divided by the branch's divisor; zero in lanes without this span.
    pub pull: Vec3<T>,
}

/// Calls `show` with a tendon's spans between different bodies, and returns its length.
#[inline(always)]
pub fn each_span<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    tendon: &Tendon,
    mut show: impl FnMut(Span<T>),
) -> T {
    let mut length = T::ZERO;
    for section in tendon.sections() {
        let divisor = section.divisor.map_or(T::ONE, |i| params.wrap_coef[i]);
        length += section_spans(
            model,
            params,
            pos,
            &section,
            #[inline(always)]
            |mut span| {
                span.pull = span.pull * (T::ONE / divisor);
                if span.bodies[0] != span.bodies[1] {
                    show(span);
                }
            },
        ) / divisor;
    }
    length
}

/// Calls `show` with the spans of a section, and returns its length.
#[inline(always)]
fn section_spans<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    section: &Section,
    mut show: impl FnMut(Span<T>),
) -> T {
    let sites = section.sites;
    let ends = sites.map(|site| pos.site_xpos[site]);
    let bodies = sites.map(|site| model.sites[site].body);
    let (direct, distance) = (ends[1] - ends[0]).normalize();
    let Some((geom, side)) = section.obstacle else {
        show(Span {
            bodies,
            points: ends,
            pull: direct,
        });
        return distance;
    };
    let obstacle = Obstacle {
        shape: match model.geoms[geom].kind {
            ShapeKind::Cylinder => WrapShape::Cylinder,
            // No tendon wraps around the other shapes: the builder refuses them.
            ShapeKind::Sphere
            | ShapeKind::Plane
            | ShapeKind::HeightField
            | ShapeKind::Capsule
            | ShapeKind::Ellipsoid
            | ShapeKind::Box
            | ShapeKind::Mesh => WrapShape::Sphere,
        },
        centre: pos.geom_xpos[geom],
        axes: pos.geom_xmat[geom],
        radius: params.geom_size[geom].x,
        side: side.map(|side| pos.site_xpos[side]),
    };
    let wrapped = wrap(ends, &obstacle);
    let (touches, body) = (wrapped.touches, model.geoms[geom].body);
    let (before, length_before) = (wrapped.points[0] - ends[0]).normalize();
    let (after, length_after) = (ends[1] - wrapped.points[1]).normalize();
    let only = |lanes: T::Mask, pull: Vec3<T>| Vec3::select(lanes, pull, Vec3::ZERO);
    show(Span {
        bodies,
        points: ends,
        pull: only(!touches, direct),
    });
    show(Span {
        bodies: [bodies[0], body],
        points: [ends[0], wrapped.points[0]],
        pull: only(touches, before),
    });
    show(Span {
        bodies: [body, bodies[1]],
        points: [wrapped.points[1], ends[1]],
        pull: only(touches, after),
    });
    T::select(
        touches,
        length_before + wrapped.length + length_after,
        distance,
    )
}

/// Writes the length of a spatial tendon and its gradient.
#[inline(always)]
pub(crate) fn spatial_tendon<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &mut Positions<T>,
    t: usize,
) {
    let range = model.tendon_dofs.range(t);
    let dofs = model.tendon_dofs.dofs(t);
    let mut gradient = std::mem::take(&mut pos.ten_jacobian);
    let row = &mut gradient[range];
    row.fill(T::ZERO);
    let length = each_span(
        model,
        params,
        pos,
        &model.tendons[t],
        #[inline(always)]
        |span| {
            add_span(model, pos, &span, dofs, row);
        },
    );
    pos.ten_jacobian = gradient;
    pos.ten_length[t] = length;
}

/// Adds the gradient of a span's length to a row over `dofs`.
#[inline(always)]
fn add_span<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    span: &Span<T>,
    dofs: &[u32],
    row: &mut [T],
) {
    let chains = Chains::new(model, span.bodies).without_common();
    for (part, side) in chains.parts() {
        let (end, pull) = match side {
            Side::Second => (1, span.pull),
            Side::First | Side::Both => (0, -span.pull),
        };
        let offset = BodyPoint::new(model, pos, span.bodies[end], span.points[end]).offset;
        let mut column = 0;
        for &dof in part {
            while dofs[column] < dof {
                column += 1;
            }
            row[column] += pull.dot(pos.cdof[dof as usize].velocity_at(offset));
        }
    }
}

/// Computes d²length/dt² of tendon `t` at zero dof acceleration, J̇ v, for tendons without obstacles: a span of length
/// s, whose ends have the relative velocity w and acceleration c, adds u·c + (w² − (u·w)²) / s.
#[kernel]
pub fn bias_acceleration<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    vel: &Velocities<T>,
    qvel: &[T],
    t: usize,
) -> T {
    let mut sum = T::ZERO;
    let tendon = &model.tendons[t];
    if !tendon.is_spatial() {
        return sum;
    }
    each_span(
        model,
        params,
        pos,
        tendon,
        #[inline(always)]
        |span| {
            let ends: [BodyPoint<T>; 2] =
                [0, 1].map(|i| BodyPoint::new(model, pos, span.bodies[i], span.points[i]));
            let (mut velocity, mut acceleration) = ([Vec3::ZERO; 2], [Vec3::ZERO; 2]);
            for (i, end) in ends.iter().enumerate() {
                velocity[i] = vel.cvel[span.bodies[i]].velocity_at(end.offset);
                acceleration[i] = end.bias_acceleration(model, vel, qvel).linear;
            }
            let apart = velocity[1] - velocity[0];
            let (unit, distance) = (span.points[1] - span.points[0]).normalize();
            let none = distance.lt(T::new(MIN_DISTANCE));
            let inverse = T::ONE / T::select(none, T::ONE, distance);
            let across = (apart.norm_squared() - unit.dot(apart).squared()) * inverse;
            let share = span.pull.dot(unit);
            let along = unit.dot(acceleration[1] - acceleration[0]);
            sum += share * (along + T::select(none, T::ZERO, across));
        },
    );
    sum
}
