//! Contact: two bodies touch at a point, with a normal n from the first to the second and two tangents.
//!
//! ```text
//! rows of J:  (∂p₂ − ∂p₁) along n, t₁, t₂;  (∂ω₂ − ∂ω₁) along n (spin), t₁, t₂ (roll)        condim 1, 3, 4, 6 take the first
//! normal:     r = dist − includemargin, aref = −b v − k d r         friction:  r = 0, aref = −b v
//!                                                   with `stiction`:  r = φ, aref = −b v − k d φ,  φ from the module `stiction`
//! ```
//!
//! A contact is active if dist < includemargin. A frictionless contact is one one-sided row with R = A₀ (1 − d) / d,
//! where A₀ is the sum of the bodies' translational inverse weights. A contact with friction is one block of condim
//! rows:
//!
//! ```text
//! pyramid:    edges y_n ± μ_i y_i, all with R = 2 (μ₁² / impratio) (1 + μ₁²) A₀ (1 − d) / d
//! elliptic:   R_n = A₀ (1 − d) / d,   R_1 = R_n / impratio,   R_j = R_1 μ₁² / μ_j²,   shape μ = μ₁ √(R_1 / R_n)
//! Coulomb:    the same R
//! ```
//!
//! If surfaces have a velocity of their own (`surfacevel`), friction rows include it in v. A contact that adheres with
//! a force δ adds R δ to aref (each edge of a pyramid its share), while δ also pulls the bodies together as a passive
//! force: the sum is the same contact, which can pull with up to δ (MuJoCo, *Computation*, "Adhesion"). Within the gap
//! it also adheres, without friction.
//!
//! The pyramid's R makes its friction as stiff as the elliptic cone's. Elliptic friction rows may have their own
//! damping (`solreffriction`); the rows of a pyramid share that of the normal, since its edges mix them.

use super::Softness;
use super::assembly::Assembly;
use super::context::{ConstraintContext, SoftnessLimits};
use super::row::Row;
use crate::contact::Contact;
use crate::dynamics::chains::{BodyPoint, Chains, Side};
use crate::options::{ContactModel, FrictionCone};
use crate::record::{BlockRecord, ConstraintSource};
use clench_math::{Mask, Real, kernel};
use clench_solver::Cost;

/// The maximum rows of a contact.
const MAX_DIM: usize = 6;

/// Appends a block for `contact`, the `index`-th of the workspace, if it acts in any lane and any dof is between the
/// bodies.
#[kernel]
pub(super) fn push<T: Real>(
    context: &ConstraintContext<T>,
    out: &mut Assembly<T>,
    index: usize,
    contact: &mut Contact<T>,
) {
    contact.block = None;
    let body = |i: usize| context.model.geoms[contact.geoms[i]].body;
    let bodies = [body(0), body(1)];
    let active = contact.acts() & context.sleep.is_either_awake(bodies);
    if !active.any() {
        return;
    }
    let chains = Chains::new(context.model, bodies).without_common();
    chains.collect(out.dofs());
    if out.dofs().is_empty() {
        return;
    }
    let weight = |body: usize| context.params.body_invweight0[body][0];
    let a0 = weight(bodies[0]) + weight(bodies[1]);
    let (soft, cost, mut rows) = soft_rows(&context.limits(), contact, a0);
    if let Some(stiction) = context.stiction {
        let displacement = stiction.displacement(index);
        for (row, phi) in rows[1..contact.dim].iter_mut().zip(displacement) {
            (row.pos, row.aref) = (phi, -row.stiffness * phi);
        }
    }
    let block = BlockRecord {
        source: ConstraintSource::Contact(index),
        active,
        margin: contact.includemargin,
        impedance: soft.impedance,
    };
    contact.block = Some(out.problem.nblock());
    out.push(
        cost,
        block,
        &rows[..contact.dim],
        #[inline(always)]
        |_, jacobian| fill(context, contact, bodies, &chains, jacobian),
    );
}

/// Computes the softness of a contact between bodies of inverse weight `a0`, its cost, and its rows.
#[inline(always)]
pub(super) fn soft_rows<T: Real>(
    limits: &SoftnessLimits<'_, T>,
    contact: &Contact<T>,
    a0: T,
) -> (Softness<T>, Cost, [Row<T>; MAX_DIM]) {
    let soft = Softness::new(
        contact.solref,
        contact.solimp,
        contact.dist - contact.includemargin,
        limits.min_timeconst,
    );
    let resolved = limits.resolved(soft, contact.solref);
    let (cost, rows) = rows(limits, contact, [&soft, &resolved], a0);
    (soft, cost, rows)
}

/// Computes the rows of a contact from its softness before and after the limit of `resolved`. Friction of an elliptic
/// cone has no spring and keeps its damping.
#[inline(always)]
fn rows<T: Real>(
    limits: &SoftnessLimits<'_, T>,
    contact: &Contact<T>,
    [soft, resolved]: [&Softness<T>; 2],
    a0: T,
) -> (Cost, [Row<T>; MAX_DIM]) {
    let mut normal = Row::new(resolved, contact.dist, contact.includemargin, a0);
    let slip = Row {
        pos: T::ZERO,
        aref: T::ZERO,
        ..normal
    };
    normal.pull = contact.adhesion;
    let mut rows = [slip; MAX_DIM];
    rows[0] = normal;
    if contact.dim == 1 {
        return (Cost::OneSided, rows);
    }
    for (row, &drift) in rows[1..].iter_mut().zip(&contact.surfacevel) {
        row.drift = drift;
    }
    let impratio = limits.impratio;
    let mu = contact.friction;
    if limits.settings.contact_model == ContactModel::Convex
        && limits.settings.friction_cone == FrictionCone::Pyramidal
    {
        let mu2 = mu[0] * mu[0];
        let r = soft.regularization(a0 + mu2 * a0);
        let r = T::new(2.0) * (mu2 / impratio) * r;
        for (j, row) in rows.iter_mut().enumerate() {
            row.r = r;
            row.shape = if j == 0 { T::ZERO } else { mu[j - 1] };
        }
        rows[0].pull = contact.adhesion / T::new(2.0 * (contact.dim as f64 - 1.0));
        return (Cost::Pyramid, rows);
    }
    let r1 = normal.r / impratio;
    let sticks = limits.sticks;
    let (stiffness, damping) = if sticks { resolved } else { soft }.friction_spring(
        contact.solreffriction,
        contact.solimp,
        limits.min_timeconst,
    );
    for (row, &mu_j) in rows[1..].iter_mut().zip(&mu) {
        row.stiffness = if sticks { stiffness } else { T::ZERO };
        row.damping = damping;
        row.r = r1 * mu[0] * mu[0] / (mu_j * mu_j);
        row.shape = mu_j;
    }
    match limits.settings.contact_model {
        ContactModel::Convex => {
            rows[0].shape = mu[0] * (r1 / normal.r).sqrt();
            (Cost::Elliptic, rows)
        }
        ContactModel::Coulomb => (Cost::Coulomb, rows),
    }
}

/// Writes the velocity of the second body minus that of the first, by columns.
#[inline(always)]
fn fill<T: Real>(
    context: &ConstraintContext<T>,
    contact: &Contact<T>,
    bodies: [usize; 2],
    chains: &Chains,
    jacobian: &mut [T],
) {
    let axes = &contact.frame.rows;
    let (dim, ndof) = (contact.dim, jacobian.len() / contact.dim);
    let mut column = 0;
    for (dofs, side) in chains.parts() {
        let (body, sign) = match side {
            Side::Second => (bodies[1], T::ONE),
            _ => (bodies[0], -T::ONE),
        };
        let offset = BodyPoint::new(context.model, context.position, body, contact.pos).offset;
        for &dof in dofs {
            let motion = context.position.cdof[dof as usize];
            let velocity = motion.velocity_at(offset) * sign;
            jacobian[column] = axes[0].dot(velocity);
            if dim > 1 {
                jacobian[ndof + column] = axes[1].dot(velocity);
                jacobian[2 * ndof + column] = axes[2].dot(velocity);
            }
            let angular = motion.angular * sign;
            for row in 3..dim {
                jacobian[row * ndof + column] = axes[row - 3].dot(angular);
            }
            column += 1;
        }
    }
}
