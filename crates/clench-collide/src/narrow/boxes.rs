//! Bounding boxes of two shapes: a quick test, in all lanes at once, before a slow method that runs per lane.
//!
//! Boxes are apart if a face normal of either separates them (Gottschalk, Lin & Manocha 1996; the nine cross products
//! of edges would find few more). A sphere is its own bound.

use super::placed::AnyPlaced;
use super::separating_axis::SeparatingAxis;
use crate::broad::allowance;
use crate::shape::{Shape, Sphere};
use clench_math::{Real, Vec3};

/// Returns the lanes in which the boxes of two bounded shapes are at most `margin` apart along all of their face
/// normals; the first may be a sphere. In the others, `axis` becomes the normal along which they are furthest apart.
#[inline(always)]
pub(super) fn boxes_near<T: Real>(
    a: AnyPlaced<T>,
    b: AnyPlaced<T>,
    margin: T,
    axis: &mut SeparatingAxis<T>,
) -> T::Mask {
    if let Shape::Sphere(Sphere { radius }) = a.shape {
        return box_near(b, a.pose.position, radius + margin);
    }
    let (half_a, half_b) = (a.shape.half_lengths(), b.shape.half_lengths());
    let rotation = a.pose.rotation.transpose() * b.pose.rotation;
    let offset = b.pose.position - a.pose.position;
    let (along_a, along_b) = (
        a.pose.rotation.transpose_mul(offset),
        b.pose.rotation.transpose_mul(offset),
    );
    let mut near = margin.le(T::new(f64::INFINITY));
    let (mut largest, mut direction) = (T::new(f64::NEG_INFINITY), Vec3::ZERO);
    for i in 0..3 {
        let mut unit = Vec3::ZERO;
        unit[i] = T::ONE;
        let own = (along_a[i], half_a[i], rotation.rows[i], half_b, unit);
        let column = rotation.column(i);
        let other = (along_b[i], half_b[i], column, half_a, column);
        for (distance, own, axis, other, normal) in [own, other] {
            let across = axis.x.abs() * other.x + axis.y.abs() * other.y + axis.z.abs() * other.z;
            let reach = (own + across) * allowance() + margin;
            let gap = distance.abs() - reach;
            near &= distance.abs().le(reach);
            let larger = gap.gt(largest);
            largest = T::select(larger, gap, largest);
            direction = Vec3::select(larger, normal * T::ONE.copysign(distance), direction);
        }
    }
    axis.renew(!near, direction);
    near
}

/// Returns the lanes in which the box of a shape is at most `reach` from a point.
#[inline(always)]
fn box_near<T: Real>(shape: AnyPlaced<T>, point: Vec3<T>, reach: T) -> T::Mask {
    let (local, half) = (shape.pose.local(point), shape.shape.half_lengths());
    // NaN is preserved, and is near nothing.
    let mut gap = Vec3::ZERO;
    for k in 0..3 {
        gap[k] = T::ZERO.max(local[k].abs() - half[k] * allowance());
    }
    let reach = T::ZERO.max(reach * allowance());
    gap.norm_squared().le(reach * reach)
}
