//! Checks of user input and of the results of a step. A mask covers the usual case, that every lane is valid. The
//! invalid number is searched only if there is one.

use crate::contact::{Contact, Excess};
use crate::error::{Fault, SimError};
pub use crate::error::{check_count, check_length};
use crate::joint_description::{joint_of, massless};
use crate::model::Model;
use crate::state::bounds::{Limit, OCCASIONAL, each_input, first_beyond, within};
pub use crate::state::bounds::{beyond_bounds, has_occasional};
use crate::state::{FIELDS, State};
use crate::workspace::Workspace;
use clench_math::{Clock, Mask, Mat3, Real, Scalar, kernel};
use clench_solver::Status;

/// Checks that the values of an argument have the right length and are finite.
pub fn check_values<T: Scalar>(
    field: &'static str,
    values: &[T],
    expected: usize,
) -> Result<(), SimError> {
    check_length(field, values.len(), expected)?;
    match first_beyond(values, 0, Limit::Finite) {
        None => Ok(()),
        Some((index, value)) => Err(SimError::Parameter {
            field,
            index,
            value,
            range: "finite",
        }),
    }
}

/// Checks that a state has the lengths of the model.
pub fn check_lengths<T: Real>(model: &Model, s: &State<T>) -> Result<(), SimError> {
    if s.fits(model) {
        return Ok(());
    }
    for (field, found) in FIELDS.iter().zip(s.lengths()) {
        check_length(field.name, found, field.numbers(model))?;
    }
    Ok(())
}

/// Passes the computed quantities that must be within limits to `visit`.
#[inline(always)]
fn each_computed<T: Real>(ws: &Workspace<T>, mut visit: impl FnMut(&'static str, Limit, &[T])) {
    visit("qacc", Limit::Near, &ws.qacc);
    visit("qfrc_constraint", Limit::Finite, &ws.qfrc_constraint);
}

/// Passes the numbers of the state that a step must leave within limits to `visit`.
#[inline(always)]
fn each_moved<T: Real>(state: &State<T>, mut visit: impl FnMut(&'static str, Limit, &[T])) {
    visit("qvel", Limit::Near, &state.qvel);
    visit("qpos", Limit::Near, &state.qpos);
    visit("act", Limit::Finite, &state.act);
}

/// Returns the lanes whose state a step can start from. If `occasional` is false, all [occasional
/// inputs](has_occasional) are zero.
#[kernel]
pub fn good_inputs<T: Real>(s: &State<T>, occasional: bool) -> T::Mask {
    let mut good = T::Mask::splat(true);
    for lane in 0..T::LANES {
        good.set_lane(lane, s.time.lane(lane).is_finite());
    }
    each_input(
        s,
        |group| occasional || group != OCCASIONAL,
        #[inline(always)]
        |_, limit, _, values| good &= within(values, limit),
    );
    good
}

/// Returns the fault of the state of a lane that is not good.
pub fn input_fault<T: Real>(model: &Model, s: &State<T>, lane: usize) -> Fault {
    let time = s.time.lane(lane);
    let mut found = (!time.is_finite()).then_some(("time", 0, time));
    let every_group = |_| true;
    each_input(s, every_group, |field, limit, start, values| {
        if found.is_none()
            && let Some((i, value)) = first_beyond(values, lane, limit)
        {
            found = Some((field, start + i, value));
        }
    });
    let (field, index, value) = found.unwrap_or(("time", 0, time));
    if value.is_finite() {
        let place = joint_of(model, field, index);
        return Fault::Diverged {
            time,
            field,
            index,
            value,
            place,
        };
    }
    Fault::NotFinite {
        field,
        index,
        value,
    }
}

/// Returns the lanes in which a step or forward pass succeeded: accelerations, constraint forces and state within
/// limits.
#[inline(always)]
pub fn good_results<T: Real>(state: &State<T>, ws: &Workspace<T>) -> T::Mask {
    well_computed(ws) & well_moved(state)
}

/// Returns the lanes in which accelerations and constraint forces are within limits.
#[kernel]
pub fn well_computed<T: Real>(ws: &Workspace<T>) -> T::Mask {
    let mut good = !ws.singular & !ws.solver.stats().failed() & ws.collision.excess.le(T::ZERO);
    each_computed(
        ws,
        #[inline(always)]
        |_, limit, values| good &= within(values, limit),
    );
    good
}

/// Returns the lanes in which the state is within limits.
#[kernel]
pub fn well_moved<T: Real>(state: &State<T>) -> T::Mask {
    let mut good = T::Mask::splat(true);
    each_moved(
        state,
        #[inline(always)]
        |_, limit, values| good &= within(values, limit),
    );
    good
}

/// Returns the fault of a step from `time` in a lane that is not good. The state can be in lanes, or be the first of
/// them.
pub fn result_fault<S: Real, T: Real>(
    model: &Model,
    time: f64,
    state: &State<S>,
    ws: &Workspace<T>,
    lane: usize,
) -> Fault {
    if ws.singular.lane(lane) {
        let place = massless(model, ws, lane);
        return Fault::Singular { time, place };
    }
    let excess = ws.collision.excess.lane(lane).to_f64();
    if excess > 0.0 || ws.solver.stats().status(lane) == Status::TooLarge {
        let (what, limit, remedy) = Excess::from_code(excess).describe(model);
        return Fault::OverBudget {
            time,
            what,
            limit,
            remedy,
        };
    }
    let mut found = None;
    let mut record = |field, first: Option<(usize, f64)>| {
        found = found.or(first.map(|(index, value)| (field, index, value)));
    };
    each_computed(ws, |field, limit, values| {
        record(field, first_beyond(values, lane, limit));
    });
    each_moved(state, |field, limit, values| {
        record(field, first_beyond(values, lane, limit));
    });
    // If every number is within limits, the solver encountered one that was not.
    let (field, index, value) = found.unwrap_or(("gap", 0, f64::NAN));
    Fault::Diverged {
        time,
        field,
        index,
        value,
        place: joint_of(model, field, index),
    }
}

/// Checks a contact that the user provides.
pub fn check_contact<T: Scalar>(model: &Model, contact: &Contact<T>) -> Result<(), &'static str> {
    if contact.geoms.iter().any(|&g| g >= model.geoms.len()) {
        return Err("it names a geom that the model does not have");
    }
    if contact.geoms[0] == contact.geoms[1] {
        return Err("both of its geoms are the same");
    }
    if !matches!(contact.dim, 1 | 3 | 4 | 6) {
        return Err("its dimension is not 1, 3, 4 or 6");
    }
    if contact.dim > 1 && !contact.friction.iter().all(|&mu| mu > T::ZERO) {
        return Err("a friction coefficient is not positive");
    }
    let finite = [contact.dist, contact.includemargin, contact.adhesion]
        .into_iter()
        .chain(contact.pos.to_array())
        .chain(contact.frame.rows.into_iter().flat_map(|r| r.to_array()))
        .chain(contact.friction)
        .chain(contact.solref)
        .chain(contact.solreffriction)
        .chain(contact.solimp)
        .chain(contact.surfacevel)
        .all(|x| x.is_finite());
    if !finite {
        return Err("it holds a number that is not finite");
    }
    check_frame(&contact.frame)
}

/// Tolerance of the dot products of the axes of a user's contact frame: large enough for frames that were computed in
/// single precision or printed with six digits.
const FRAME_ERROR: f64 = 1e-5;

/// Checks for three orthogonal unit vectors, right-handed.
fn check_frame<T: Scalar>(frame: &Mat3<T>) -> Result<(), &'static str> {
    let [normal, first, second] = frame.rows;
    let near =
        |product: T, expected: f64| (product - T::new(expected)).abs() <= T::new(FRAME_ERROR);
    let units = frame.rows.iter().all(|axis| near(axis.norm_squared(), 1.0));
    let across = near(normal.dot(first), 0.0)
        && near(normal.dot(second), 0.0)
        && near(first.dot(second), 0.0);
    if !(units && across) {
        return Err("the axes of its frame are not orthonormal");
    }
    if normal.cross(first).dot(second) < T::ZERO {
        return Err("the axes of its frame are not right-handed");
    }
    Ok(())
}
