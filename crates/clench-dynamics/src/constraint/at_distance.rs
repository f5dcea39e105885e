//! The rows of one constraint as functions of its distance and velocity, for derivatives. R, aref and the shape of the
//! cost depend on these alone; J is missing.

use super::contact::soft_rows;
use super::context::SoftnessLimits;
use super::row::Row;
use super::{Softness, dynamic, friction, limit, min_timeconst};
use crate::contact::Contact;
use crate::model::{Coupled, JointKind, Model, Params};
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
/// more than one coordinate. `contact` is that of a contact. The integrator must not evaluate constraints at the end of
/// the step, and friction must not stick.
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
    let limited = |(solref, solimp, a0): ([f64; 2], [f64; 5], f64), margin: f64| {
        let of = (solref.map(number), solimp.map(number), number(a0));
        let (_, row) = limit::soft_row(&limits, of, distance, number(margin));
        (Cost::OneSided, 1, [row; MAX_DIM])
    };
    let rubbing = |(solref, solimp, a0): ([f64; 2], [f64; 5], f64), loss: f64| {
        let of = (solref.map(number), solimp.map(number), number(a0));
        let (_, row) = friction::soft_row(limits.min_timeconst, of, number(loss));
        (Cost::Huber, 1, [row; MAX_DIM])
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
            JointKind::Hinge | JointKind::Slide | JointKind::Ball => {
                let a0 = params.dof_invweight0[model.joints[j].dof];
                let of = (params.jnt_solref[j], params.jnt_solimp[j], a0);
                limited(of, params.jnt_margin[j])
            }
            JointKind::Free => return None,
        },
        ConstraintSource::TendonLimit(t) => {
            let (solref, solimp) = (params.tendon_solref_lim[t], params.tendon_solimp_lim[t]);
            let of = (solref, solimp, params.tendon_invweight0[t]);
            limited(of, params.tendon_margin[t])
        }
        ConstraintSource::DofFriction(i) => {
            let a0 = params.dof_invweight0[i];
            let of = (params.dof_solref[i], params.dof_solimp[i], a0);
            rubbing(of, params.dof_frictionloss[i])
        }
        ConstraintSource::TendonFriction(t) => {
            let (solref, solimp) = (params.tendon_solref_fri[t], params.tendon_solimp_fri[t]);
            let of = (solref, solimp, params.tendon_invweight0[t]);
            rubbing(of, params.tendon_frictionloss[t])
        }
        ConstraintSource::Equality(equality) => {
            let joint = |j: usize| params.dof_invweight0[model.joints[j].dof];
            let tendon = |t: usize| params.tendon_invweight0[t];
            let a0 = match model.equalities[equality].target.coupled() {
                Coupled::Joints(follower, leader) => joint(follower) + leader.map_or(0.0, joint),
                Coupled::Tendons(follower, leader) => tendon(follower) + leader.map_or(0.0, tendon),
                Coupled::Points(_) | Coupled::Frames(_) => return None,
            };
            let soft = equality_softness((params, settings), source, distance)?;
            let row = Row::new(&soft, distance, T::ZERO, number(a0));
            (Cost::Quadratic, 1, [row; MAX_DIM])
        }
        ConstraintSource::Dynamic { .. } => return None,
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

/// Returns the softness of an equality, or of a constraint that was added at run time, at a violation; `None` for other
/// constraints.
pub fn equality_softness<T: Real<Value = f64>>(
    (params, settings): (&Params<f64>, &StepSettings),
    source: ConstraintSource,
    violation: T,
) -> Option<Softness<T>> {
    let number = T::from_value;
    let (solref, solimp) = match source {
        ConstraintSource::Equality(e) => (params.eq_solref[e], params.eq_solimp[e]),
        ConstraintSource::Dynamic { .. } => dynamic::softness(),
        ConstraintSource::DofFriction(_)
        | ConstraintSource::TendonFriction(_)
        | ConstraintSource::JointLimit(_)
        | ConstraintSource::TendonLimit(_)
        | ConstraintSource::Contact(_) => return None,
    };
    let min_timeconst = number(min_timeconst(params, settings, false));
    let (solref, solimp) = (solref.map(number), solimp.map(number));
    Some(Softness::new(solref, solimp, violation, min_timeconst))
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
