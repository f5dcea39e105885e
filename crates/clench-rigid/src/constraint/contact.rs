//! Contact: two bodies touch at a point, with a normal n from the first to the second and two tangents.
//!
//! ```text
//! rows of J:  (∂p₂ − ∂p₁) along n, t₁, t₂;  (∂ω₂ − ∂ω₁) along n (spin), t₁, t₂ (roll)        condim 1, 3, 4, 6 take the first
//! normal:     r = dist − includemargin, aref = −b v − k d r         friction:  r = 0, aref = −b v
//! ```
//!
//! A contact exists where dist < includemargin. Frictionless, it is one one-sided row with R = A₀ (1 − d) / d, where A₀ is
//! the sum of the bodies' translational inverse weights. With friction it is one block of condim rows:
//!
//! ```text
//! pyramid:    edges y_n ± μ_i y_i, all with R = 2 (μ₁² / impratio) (1 + μ₁²) A₀ (1 − d) / d
//! elliptic:   R_n = A₀ (1 − d) / d,   R_1 = R_n / impratio,   R_j = R_1 μ₁² / μ_j²,   shape μ = μ₁ √(R_1 / R_n)
//! ```
//!
//! The pyramid's R makes its friction as stiff as the elliptic cone's. Elliptic friction rows may have their own damping
//! (`solreffriction`); the rows of a pyramid share the normal's, since its edges mix them.

use super::assembly::{Assembly, BlockRecord, ConstraintSource, Row};
use super::chains::{BodyPoint, Chains, Side};
use super::{Scene, Softness};
use crate::contact::Contact;
use clench_math::{Mask, Real};
use clench_solver::{Cost, FrictionCone};

/// The most rows of a contact.
const MAX_DIM: usize = 6;

/// Makes a block of `contact`, the `index`-th of the workspace, where any lane touches and any dof is between the bodies.
pub(super) fn push<T: Real>(
    scene: &Scene<T>,
    out: &mut Assembly<T>,
    index: usize,
    contact: &mut Contact<T>,
) {
    contact.block = None;
    let active = contact.active & contact.dist.lt(contact.includemargin);
    if !active.any() {
        return;
    }
    let bodies = contact.geoms.map(|g| scene.model.geoms[g].body);
    let chains = Chains::new(scene, bodies).without_common();
    chains.collect(out.dofs());
    if out.dofs().is_empty() {
        return;
    }
    let soft = Softness::new(
        contact.solref,
        contact.solimp,
        contact.dist - contact.includemargin,
        scene.least_timeconst,
    );
    let weight = bodies.map(|b| scene.params.body_invweight0[b][0]);
    let (cost, rows) = rows(scene, contact, &soft, weight[0] + weight[1]);
    let block = BlockRecord {
        source: ConstraintSource::Contact(index),
        active,
        margin: contact.includemargin,
        impedance: soft.impedance,
    };
    contact.block = Some(out.problem.nblock());
    out.push(cost, block, &rows[..contact.dim], |_, jacobian| {
        fill(scene, contact, bodies, &chains, jacobian);
    });
}

fn rows<T: Real>(
    scene: &Scene<T>,
    contact: &Contact<T>,
    soft: &Softness<T>,
    a0: T,
) -> (Cost, [Row<T>; MAX_DIM]) {
    let normal = Row::new(soft, contact.dist, contact.includemargin, a0);
    let slip = Row {
        pos: T::ZERO,
        aref: T::ZERO,
        ..normal
    };
    let mut rows = [slip; MAX_DIM];
    rows[0] = normal;
    if contact.dim == 1 {
        return (Cost::OneSided, rows);
    }
    let impratio = scene.impratio;
    let mu = contact.friction;
    match scene.settings.solver.friction_cone {
        FrictionCone::Pyramidal => {
            let mu2 = mu[0] * mu[0];
            let r = soft.regularization(a0 + mu2 * a0);
            let r = T::new(2.0) * (mu2 / impratio) * r;
            for (j, row) in rows.iter_mut().enumerate() {
                row.r = r;
                row.shape = if j == 0 { T::ZERO } else { mu[j - 1] };
            }
            (Cost::Pyramid, rows)
        }
        FrictionCone::Elliptic => {
            let r1 = normal.r / impratio;
            let damping = soft.friction_damping(
                contact.solreffriction,
                contact.solimp,
                scene.least_timeconst,
            );
            rows[0].shape = mu[0] * (r1 / normal.r).sqrt();
            for (row, &mu_j) in rows[1..].iter_mut().zip(&mu) {
                row.damping = damping;
                row.r = r1 * mu[0] * mu[0] / (mu_j * mu_j);
                row.shape = mu_j;
            }
            (Cost::Elliptic, rows)
        }
    }
}

#[inline(always)]
fn fill<T: Real>(
    scene: &Scene<T>,
    contact: &Contact<T>,
    bodies: [usize; 2],
    chains: &Chains,
    jacobian: &mut [T],
) {
    let offsets = bodies.map(|body| BodyPoint::new(scene, body, contact.pos).offset);
    let axes = &contact.frame.rows;
    let ndof = jacobian.len() / contact.dim;
    for (column, (dof, side)) in chains.iter().enumerate() {
        let (motion, offset) = match side {
            Side::Second => (scene.position.cdof[dof], offsets[1]),
            _ => (-scene.position.cdof[dof], offsets[0]),
        };
        let velocity = motion.velocity_at(offset);
        for (i, axis) in axes.iter().enumerate().take(contact.dim) {
            jacobian[i * ndof + column] = axis.dot(velocity);
        }
        for (i, axis) in axes.iter().enumerate().take(contact.dim.saturating_sub(3)) {
            jacobian[(i + 3) * ndof + column] = axis.dot(motion.angular);
        }
    }
}
