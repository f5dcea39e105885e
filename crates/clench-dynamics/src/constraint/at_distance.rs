//! The rows of one constraint as functions of its distance and velocity, for derivatives. R, aref and the shape of the
//! cost depend on these alone; J is missing.

use super::contact::soft_rows;
use super::context::SoftnessLimits;
use super::{friction, limit, min_timeconst};
use crate::contact::Contact;
use crate::model::{JointKind, Model, Params};
use crate::record::ConstraintSource;
use crate::settings::StepSettings;
use clench_math::{Mat3, Real, Vec3};
use clench_solver::Cost;

/// The maximum rows of a block.
pub const MAX_DIM: usize = 6;

/// The rows of a block without J.
#[derive(Clone, Copy, Debug)]
pub struct RowsAtDistance<T> {
    /// The shape of the cost.
    pub cost: Cost,
    /// The number of rows.
    pub dim: usize,
    /// The derivative of −aref by the velocity of each row.
    pub damping: [T; MAX_DIM],
    /// The reference acceleration of each row.
    pub aref: [T; MAX_DIM],
    /// The regularization of each row.
    pub r: [T; MAX_DIM],
    /// The shape of each row, see `clench_solver::BlockMut::shape`.
    pub shape: [T; MAX_DIM],
}

/// Returns the rows of a constraint at a distance, whose rows have the given velocities; `None` for a constraint with
/// more than one coordinate, or of coordinates that are not those of joints. `contact` is that of a contact. The
/// integrator must not evaluate constraints at the end of the step, and friction must not stick.
pub fn rows_at_distance<T: Real<Value = f64>>(
    (model, params, settings): (&Model, &Params<f64>, &StepSettings),
    (source, contact): (ConstraintSource, Option<&Contact<f64>>),
    distance: T,
    velocities: &[T],
) -> Option<RowsAtDistance<T>> {
    let number = T::from_value;
    let limits = SoftnessLimits {
        settings,
        min_timeconst: number(min_timeconst(params, settings, false)),
        impratio: T::new(settings.impratio),
        sticks: false,
        timestep: None,
    };
    let (cost, dim, rows) = match source {
        ConstraintSource::Contact(_) => {
            let contact = Contact {
                dist: distance,
                ..Contact::from_values(contact?)
            };
            let weight = |geom: usize| params.body_invweight0[model.geoms[geom].body][0];
            let a0 = weight(contact.geoms[0]) + weight(contact.geoms[1]);
            let (_, cost, rows) = soft_rows(&limits, &contact, number(a0));
            (cost, contact.dim, rows)
        }
        ConstraintSource::JointLimit(j) => match model.joints[j].kind {
            JointKind::Hinge | JointKind::Slide => {
                let solref = params.jnt_solref[j].map(number);
                let solimp = params.jnt_solimp[j].map(number);
                let a0 = number(params.dof_invweight0[model.joints[j].dof]);
                let margin = number(params.jnt_margin[j]);
                let (_, row) = limit::soft_row(&limits, (solref, solimp, a0), distance, margin);
                (Cost::OneSided, 1, [row; MAX_DIM])
            }
            JointKind::Ball | JointKind::Free => return None,
        },
        ConstraintSource::DofFriction(i) => {
            let solref = params.dof_solref[i].map(number);
            let solimp = params.dof_solimp[i].map(number);
            let a0 = number(params.dof_invweight0[i]);
            let loss = number(params.dof_frictionloss[i]);
            let (_, row) = friction::soft_row(limits.min_timeconst, (solref, solimp, a0), loss);
            (Cost::Huber, 1, [row; MAX_DIM])
        }
        ConstraintSource::Equality(_)
        | ConstraintSource::Dynamic { .. }
        | ConstraintSource::TendonFriction(_)
        | ConstraintSource::TendonLimit(_) => return None,
    };
    let mut found = RowsAtDistance {
        cost,
        dim,
        damping: rows.map(|row| row.damping),
        aref: [T::ZERO; MAX_DIM],
        r: rows.map(|row| row.r),
        shape: rows.map(|row| row.shape),
    };
    for ((aref, row), &velocity) in found.aref.iter_mut().zip(&rows).zip(velocities) {
        *aref = row.at_velocity(velocity) + row.r * row.pull;
    }
    Some(found)
}

impl<T: Real> Contact<T> {
    /// Returns a contact with the values of another.
    pub fn from_values(contact: &Contact<T::Value>) -> Self {
        let vector = |v: Vec3<T::Value>| {
            let [x, y, z] = v.to_array().map(T::from_value);
            Vec3::new(x, y, z)
        };
        let [normal, first, second] = contact.frame.rows.map(vector);
        Contact {
            geoms: contact.geoms,
            active: contact.active,
            dim: contact.dim,
            dist: T::from_value(contact.dist),
            pos: vector(contact.pos),
            frame: Mat3::from_rows(normal, first, second),
            includemargin: T::from_value(contact.includemargin),
            friction: contact.friction.map(T::from_value),
            solref: contact.solref.map(T::from_value),
            solreffriction: contact.solreffriction.map(T::from_value),
            solimp: contact.solimp.map(T::from_value),
            adhesion: T::from_value(contact.adhesion),
            surfacevel: contact.surfacevel.map(T::from_value),
            block: contact.block,
        }
    }
}
