//! The derivatives of constraint forces at a constant acceleration.
//!
//! The residual of a row is y = J a − aref, in which aref depends on the distance r and the velocity of the row. So the
//! force f(y, r) of a block changes by ∂f/∂y dy + ∂f/∂r dr, both found in dual numbers (`slopes`). The motion of the
//! rows is that of a contact (`contact`), of two frames (`frames`) or of a coordinate of joints and tendons (`rows`).

use super::contact::Contacts;
use super::frames::Frames;
use super::row_forces::RowForces;
use super::rows::Rows;
use super::slopes::Slopes;
use super::step::Step;
use clench_dynamics::dynamics::force_derivatives::ForceDerivatives;
use clench_dynamics::dynamics::inverse_derivatives::InverseDerivatives;
use clench_dynamics::model::EqualityTarget;
use clench_dynamics::record::ConstraintSource;
use clench_solver::{Block, Cost, Response};

/// Scratch memory of these derivatives.
#[derive(Clone, Debug, Default)]
pub(super) struct Blocks {
    contacts: Contacts,
    frames: Frames,
    rows: Rows,
    pub forces: RowForces,
}

/// A kind of constraint by the motion of its rows.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Contact(usize),
    /// Points or frames of two bodies.
    Frames,
    Row,
}

impl Blocks {
    /// Subtracts the derivatives of constraint forces by position and velocity from `gradient`. `inverse` holds the
    /// motion of the step. Returns false if a constraint is of a kind that is not covered.
    pub(super) fn run(
        &mut self,
        step: &Step<'_>,
        (response, inverse): (&Response<f64>, &InverseDerivatives<f64>),
        gradient: &mut ForceDerivatives<'_, f64>,
    ) -> bool {
        let plain = step.plain;
        // It also acts within the gap, where the force of the constraint is zero.
        if plain.contacts.iter().any(|contact| contact.adhesion != 0.0) {
            return false;
        }
        self.contacts.find_accelerations(step);
        let forces = &mut self.forces;
        forces.clear(plain.problem.nrow());
        for (block, record) in plain.problem.blocks().zip(&plain.record.blocks) {
            let y = &response.residual()[block.rows()];
            if block.d[0] <= 0.0 || is_idle(&block, y) {
                continue;
            }
            let (source, force) = (record.source, &response.force()[block.rows()]);
            match kind(step, source) {
                Kind::Contact(i) => {
                    let contact = &plain.contacts[i];
                    let slopes = Slopes::new(step, &block, (source, Some(contact)), y);
                    let Some(slopes) = slopes else {
                        return false;
                    };
                    forces.set_slopes(&block, &slopes.by_residual);
                    let slopes = (force, &slopes, &mut *forces);
                    (self.contacts).subtract(step, &block, contact, slopes, gradient);
                }
                Kind::Frames => {
                    let forces = (y, force, &mut *forces);
                    (self.frames).subtract((step, inverse), &block, source, forces, gradient);
                }
                Kind::Row => {
                    let Some(slopes) = Slopes::new(step, &block, (source, None), y) else {
                        return false;
                    };
                    forces.set_slopes(&block, &slopes.by_residual);
                    let slopes = (force[0], &slopes, &mut *forces);
                    (self.rows).subtract(step, &block, source, slopes, gradient);
                }
            }
        }
        true
    }
}

/// Returns the kind of a constraint.
fn kind(step: &Step<'_>, source: ConstraintSource) -> Kind {
    match source {
        ConstraintSource::Contact(i) => Kind::Contact(i),
        ConstraintSource::Dynamic { .. } => Kind::Frames,
        ConstraintSource::Equality(equality) => match step.model.equalities[equality].target {
            EqualityTarget::Connect { .. } | EqualityTarget::Weld { .. } => Kind::Frames,
            EqualityTarget::Joint { .. } | EqualityTarget::Tendon { .. } => Kind::Row,
        },
        ConstraintSource::DofFriction(_)
        | ConstraintSource::TendonFriction(_)
        | ConstraintSource::JointLimit(_)
        | ConstraintSource::TendonLimit(_) => Kind::Row,
    }
}

/// Returns true if a block at the residual `y` is within the piece of its cost on which the force is zero, as most
/// limits are.
fn is_idle(block: &Block<'_, f64>, y: &[f64]) -> bool {
    match block.cost {
        Cost::OneSided => y[0] > 0.0,
        Cost::Quadratic | Cost::Huber | Cost::Pyramid | Cost::Elliptic | Cost::Coulomb => false,
    }
}
