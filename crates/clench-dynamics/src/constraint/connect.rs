//! Connect: keeps two points, one on each body, coincident.
//!
//! ```text
//! r = p₁ − p₂        J = ∂p₁/∂q − ∂p₂/∂q        r̈ = J a + J̇ v   ⇒   aref = −b J v − k d r − J̇ v
//! ```
//!
//! J̇ v is the acceleration of the points at zero dof acceleration: the spatial bias acceleration of each body, shifted
//! to the point, plus ω × ṗ. The impedance depends on the norm of the violation; A₀ is the sum of the bodies'
//! translational inverse weights.

use super::anchor_frames::{AnchorFrames, FrameConstraint};
use super::assembly::Assembly;
use super::context::ConstraintContext;
use super::row::Row;
use crate::dynamics::chains::{BodyPoint, Chains, Side};
use clench_math::{Motion, Real, Vec3, kernel};
use clench_solver::Cost;

#[kernel]
pub(super) fn push<T: Real>(
    context: &ConstraintContext<T>,
    out: &mut Assembly<T>,
    constraint: &FrameConstraint<T>,
) {
    let bodies = constraint.frames.bodies;
    let chains = Chains::new(context.model, bodies);
    chains.collect(out.dofs());
    if out.dofs().is_empty() {
        return;
    }
    let anchors = Anchors::new(context, &constraint.frames);
    let violation = anchors.separation;
    let bias = anchors.bias[0].linear - anchors.bias[1].linear;
    let (soft, block) = constraint.soften(context, violation.norm());
    let a0 = bodies.map(|b| context.params.body_invweight0[b][0]);
    let mut rows = [Row::default(); 3];
    for (i, row) in rows.iter_mut().enumerate() {
        *row = Row::new(&soft, violation[i], T::ZERO, a0[0] + a0[1]);
        row.aref -= bias[i];
    }
    out.push(
        Cost::Quadratic,
        block,
        &rows,
        #[inline(always)]
        |_, jacobian| {
            anchors.fill_translation(context, &chains, jacobian);
        },
    );
}

/// The anchor points of a connect or weld.
pub(super) struct Anchors<T> {
    /// The first point minus the second, m.
    pub separation: Vec3<T>,
    /// The acceleration of each body, linear at its point, at zero dof acceleration.
    pub bias: [Motion<T>; 2],
    /// Each point relative to the reference point of its body's tree.
    offsets: [Vec3<T>; 2],
}

impl<T: Real> Anchors<T> {
    #[inline(always)]
    pub(super) fn new(context: &ConstraintContext<T>, frames: &AnchorFrames<T>) -> Self {
        let [body1, body2] = frames.bodies;
        let [world1, world2] = frames.points(context.position);
        let first = BodyPoint::new(context.model, context.position, body1, world1);
        let second = BodyPoint::new(context.model, context.position, body2, world2);
        Anchors {
            separation: world1 - world2,
            bias: [
                first.bias_acceleration(context.model, context.velocity, &context.state.qvel),
                second.bias_acceleration(context.model, context.velocity, &context.state.qvel),
            ],
            offsets: [first.offset, second.offset],
        }
    }

    /// Fills rows 0 to 2 of a Jacobian: the velocity of the first point minus that of the second.
    #[inline(always)]
    pub(super) fn fill_translation(
        &self,
        context: &ConstraintContext<T>,
        chains: &Chains,
        jacobian: &mut [T],
    ) {
        let ndof = chains.iter().count();
        let [first, second] = self.offsets;
        for (column, (dof, side)) in chains.iter().enumerate() {
            let axis = context.position.cdof[dof];
            let velocity = match side {
                Side::Both => axis.velocity_at(first) - axis.velocity_at(second),
                Side::First => axis.velocity_at(first),
                Side::Second => -axis.velocity_at(second),
            };
            for i in 0..3 {
                jacobian[i * ndof + column] = velocity[i];
            }
        }
    }
}
