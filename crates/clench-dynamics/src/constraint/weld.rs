//! Weld: keeps two frames, one on each body, coincident.
//!
//! The first three rows are those of a connect. The other three are the imaginary part of ρ = q₂⁻¹ q₁, the relative
//! orientation (a unit quaternion, half the rotation vector for small errors), scaled by the torque scale s, a length:
//!
//! ```text
//! ρ̇ = ½ (0, u) ρ,   u = R₂ᵀ (ω₁ − ω₂)
//! r = s Im ρ        ṙ = s B u,   B u = ½ (w u + u × Im ρ),   w = Re ρ        J = s B R₂ᵀ (∂ω₁ − ∂ω₂)
//! r̈ = s (B u̇ + Ḃ u),   u̇ = R₂ᵀ (ω̇₁ − ω̇₂ − ω₂ × (ω₁ − ω₂))
//! ```
//!
//! J̇ v is r̈ with ω̇ the bias accelerations. The impedance depends on the norm of all six rows; A₀ is the sum of the
//! bodies' inverse weights, translational and rotational.

use super::anchor_frames::{AnchorFrames, FrameConstraint};
use super::assembly::Assembly;
use super::connect::Anchors;
use super::context::ConstraintContext;
use super::row::Row;
use crate::dynamics::chains::{Chains, Side};
use crate::stages::Positions;
use clench_math::{Quat, Real, Vec3, kernel};
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
    let [bias1, bias2] = anchors.bias;
    let translation = anchors.separation;
    let bias_translation = bias1.linear - bias2.linear;
    let relative = Relative::new(context.position, &constraint.frames);
    let rotation = relative.rho.imaginary() * relative.scale;
    let bias_rotation = relative.bias(context, bodies, [bias1.angular, bias2.angular]);
    let length = (translation.norm_squared() + rotation.norm_squared()).sqrt();
    let (soft, block) = constraint.soften(context, length);
    let mut rows = [Row::default(); 6];
    for (i, row) in rows.iter_mut().enumerate() {
        let (pos, bias, part) = match i {
            0..3 => (translation[i], bias_translation[i], 0),
            _ => (rotation[i - 3], bias_rotation[i - 3], 1),
        };
        let a0 = bodies.map(|b| context.params.body_invweight0[b][part]);
        *row = Row::new(&soft, pos, T::ZERO, a0[0] + a0[1]);
        row.aref -= bias;
    }
    out.push(
        Cost::Quadratic,
        block,
        &rows,
        #[inline(always)]
        |_, jacobian| {
            let (upper, lower) = jacobian.split_at_mut(jacobian.len() / 2);
            anchors.fill_translation(context, &chains, upper);
            relative.fill(context, &chains, lower);
        },
    );
}

/// Computes the torque on the first body, in world axes, of the forces f of the last three rows: Jᵀ f = R₂ s Bᵀ f, with
/// Bᵀ f = ½ (w f + Im ρ × f). The second body receives its negative.
#[kernel]
pub fn weld_torque<T: Real>(
    position: &Positions<T>,
    frames: &AnchorFrames<T>,
    f: Vec3<T>,
) -> Vec3<T> {
    let relative = Relative::new(position, frames);
    let half = T::new(0.5) * relative.scale;
    let turned = f * relative.rho.w + relative.rho.imaginary().cross(f);
    relative.to_second.conjugate().rotate(turned * half)
}

/// The relative orientation and derived quantities.
struct Relative<T> {
    rho: Quat<T>,
    /// From world axes to the second frame.
    to_second: Quat<T>,
    scale: T,
}

impl<T: Real> Relative<T> {
    #[inline(always)]
    fn new(position: &Positions<T>, frames: &AnchorFrames<T>) -> Self {
        let xquat = &position.xquat;
        let [body1, body2] = frames.bodies;
        let first = xquat[body1] * frames.quats[0];
        let to_second = (xquat[body2] * frames.quats[1]).conjugate();
        Relative {
            rho: to_second * first,
            to_second,
            scale: frames.torquescale,
        }
    }

    /// Computes B u.
    #[inline(always)]
    fn rate(&self, u: Vec3<T>) -> Vec3<T> {
        half_product(u, self.rho)
    }

    /// Computes J̇ v of the rows from the bodies' angular accelerations at zero dof acceleration.
    #[inline(always)]
    fn bias(
        &self,
        context: &ConstraintContext<T>,
        bodies: [usize; 2],
        [alpha1, alpha2]: [Vec3<T>; 2],
    ) -> Vec3<T> {
        let cvel = &context.velocity.cvel;
        let [omega1, omega2] = bodies.map(|b| cvel[b].angular);
        let omega = omega1 - omega2;
        let u = self.to_second.rotate(omega);
        let u_dot = self.to_second.rotate(alpha1 - alpha2 - omega2.cross(omega));
        let rho_dot = Quat::new(T::ZERO, u.x, u.y, u.z) * self.rho;
        let half = T::new(0.5);
        (self.rate(u_dot) + half_product(u, rho_dot) * half) * self.scale
    }

    #[inline(always)]
    fn fill(&self, context: &ConstraintContext<T>, chains: &Chains, jacobian: &mut [T]) {
        let ndof = chains.iter().count();
        for (column, (dof, side)) in chains.iter().enumerate() {
            let axis = context.position.cdof[dof].angular;
            let turn = match side {
                Side::Both => continue,
                Side::First => axis,
                Side::Second => -axis,
            };
            let rate = self.rate(self.to_second.rotate(turn)) * self.scale;
            for i in 0..3 {
                jacobian[i * ndof + column] = rate[i];
            }
        }
    }
}

/// Computes the imaginary part of ½ (0, u) q.
#[inline(always)]
fn half_product<T: Real>(u: Vec3<T>, q: Quat<T>) -> Vec3<T> {
    (u * q.w + u.cross(q.imaginary())) * T::new(0.5)
}
