//! Checks of what users hand in and of what a step produced. The usual case, that all is well in every lane, is told by a
//! mask; which number is wrong is looked for only where one is.

use crate::contact::Contact;
use crate::error::{Fault, SimError};
use crate::model::Model;
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::{Mask, Real, Scalar, kernel};

/// The right length and only finite numbers.
pub(crate) fn check_values<T: Scalar>(
    field: &'static str,
    values: &[T],
    expected: usize,
) -> Result<(), SimError> {
    check_length(field, values.len(), expected)?;
    match first_not_finite(values, 0) {
        None => Ok(()),
        Some((index, value)) => Err(SimError::Fault(Fault::NotFinite {
            field,
            index,
            value,
        })),
    }
}

pub(crate) fn check_length(
    field: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), SimError> {
    if found == expected {
        return Ok(());
    }
    Err(SimError::WrongLength {
        field,
        found,
        expected,
    })
}

fn first_not_finite<T: Real>(values: &[T], lane: usize) -> Option<(usize, f64)> {
    let value = |i: usize| values[i].lane(lane).to_f64();
    let index = (0..values.len()).find(|&i| !value(i).is_finite())?;
    Some((index, value(index)))
}

/// A state of the model's lengths.
pub(crate) fn check_lengths<T: Real>(model: &Model, s: &State<T>) -> Result<(), SimError> {
    let expected = model.state_lengths();
    for ((field, found), (_, expected)) in s.lengths().into_iter().zip(expected) {
        check_length(field, found, expected)?;
    }
    Ok(())
}

/// Shows every number of a state to `look`: field, index of the first number in the field, numbers.
#[inline(always)]
fn each_input<T: Real>(s: &State<T>, mut look: impl FnMut(&'static str, usize, &[T])) {
    look("time", 0, &[s.time]);
    look("qpos", 0, &s.qpos);
    look("qvel", 0, &s.qvel);
    look("act", 0, &s.act);
    look("ctrl", 0, &s.ctrl);
    look("qfrc_applied", 0, &s.qfrc_applied);
    look("qacc_warmstart", 0, &s.qacc_warmstart);
    for (b, f) in s.xfrc_applied.iter().enumerate() {
        look("xfrc_applied", 6 * b, &f.linear.to_array());
        look("xfrc_applied", 6 * b + 3, &f.angular.to_array());
    }
    for (m, p) in s.mocap_pos.iter().enumerate() {
        look("mocap_pos", 3 * m, &p.to_array());
    }
    for (m, q) in s.mocap_quat.iter().enumerate() {
        look("mocap_quat", 4 * m, &q.to_array());
    }
}

/// Shows to `look` what a step must leave finite.
#[inline(always)]
fn each_result<T: Real>(
    state: &State<T>,
    ws: &Workspace<T>,
    mut look: impl FnMut(&'static str, &[T]),
) {
    look("qacc", &ws.qacc);
    look("qfrc_constraint", &ws.qfrc_constraint);
    look("qvel", &state.qvel);
    look("qpos", &state.qpos);
    look("act", &state.act);
}

/// The lanes in which all numbers are finite.
#[inline(always)]
fn finite<T: Real>(values: &[T]) -> T::Mask {
    let mut mask = T::Mask::splat(true);
    for x in values {
        mask &= x.is_finite();
    }
    mask
}

/// The lanes whose state a step can start from.
#[kernel]
pub(crate) fn good_inputs<T: Real>(s: &State<T>) -> T::Mask {
    let mut good = T::Mask::splat(true);
    each_input(
        s,
        #[inline(always)]
        |_, _, values| good &= finite(values),
    );
    good
}

/// What is wrong with the state of a lane that is not good.
pub(crate) fn input_fault<T: Real>(s: &State<T>, lane: usize) -> Fault {
    let mut found = ("time", 0, s.time.lane(lane).to_f64());
    each_input(s, |field, start, values| {
        if found.2.is_finite()
            && let Some((i, value)) = first_not_finite(values, lane)
        {
            found = (field, start + i, value);
        }
    });
    let (field, index, value) = found;
    Fault::NotFinite {
        field,
        index,
        value,
    }
}

/// The lanes in which a step or forward went well: finite accelerations and constraint forces, and a finite state.
#[kernel]
pub(crate) fn good_results<T: Real>(state: &State<T>, ws: &Workspace<T>) -> T::Mask {
    let mut good = !ws.singular & !ws.solver.stats().failed();
    each_result(
        state,
        ws,
        #[inline(always)]
        |_, values| good &= finite(values),
    );
    good
}

/// What is wrong with what a step from `time` produced in a lane that is not good.
pub(crate) fn result_fault<T: Real>(
    time: f64,
    state: &State<T>,
    ws: &Workspace<T>,
    lane: usize,
) -> Fault {
    if ws.singular.lane(lane) {
        return Fault::Singular { time };
    }
    // Where every number is finite, the solver met one that was not.
    let mut found = ("gap", 0, f64::NAN);
    each_result(state, ws, |field, values| {
        if found.0 == "gap"
            && let Some((index, value)) = first_not_finite(values, lane)
        {
            found = (field, index, value);
        }
    });
    let (field, index, value) = found;
    Fault::Diverged {
        time,
        field,
        index,
        value,
    }
}

/// A contact that a user hands in.
pub(crate) fn check_contact<T: Scalar>(
    model: &Model,
    contact: &Contact<T>,
) -> Result<(), &'static str> {
    if contact.geoms.iter().any(|&g| g >= model.geoms.len()) {
        return Err("it names a geom that the model does not have");
    }
    if !matches!(contact.dim, 1 | 3 | 4 | 6) {
        return Err("its dimension is not 1, 3, 4 or 6");
    }
    if contact.dim > 1 && !contact.friction.iter().all(|&mu| mu > T::ZERO) {
        return Err("a friction coefficient is not positive");
    }
    let finite = [contact.dist, contact.includemargin]
        .into_iter()
        .chain(contact.pos.to_array())
        .chain(contact.frame.rows.into_iter().flat_map(|r| r.to_array()))
        .chain(contact.friction)
        .chain(contact.solref)
        .chain(contact.solreffriction)
        .chain(contact.solimp)
        .all(|x| x.is_finite());
    if !finite {
        return Err("it holds a number that is not finite");
    }
    Ok(())
}
