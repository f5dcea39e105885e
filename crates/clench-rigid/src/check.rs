//! Checks of what users hand in and of what a step produced.

use crate::contact::Contact;
use crate::error::SimError;
use crate::model::Model;
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::Scalar;
use clench_solver::Status;

/// The right length and only finite numbers.
pub(crate) fn check_values<T: Scalar>(
    field: &'static str,
    values: &[T],
    expected: usize,
) -> Result<(), SimError> {
    check_length(field, values.len(), expected)?;
    match first_not_finite(values) {
        None => Ok(()),
        Some((index, value)) => Err(SimError::NotFinite {
            field,
            index,
            value,
        }),
    }
}

fn check_rows<T: Scalar, R: Copy, const N: usize>(
    field: &'static str,
    rows: &[R],
    expected: usize,
    numbers: impl Fn(R) -> [T; N],
) -> Result<(), SimError> {
    check_length(field, N * rows.len(), N * expected)?;
    for (i, &row) in rows.iter().enumerate() {
        if let Some((j, value)) = first_not_finite(&numbers(row)) {
            let index = N * i + j;
            return Err(SimError::NotFinite {
                field,
                index,
                value,
            });
        }
    }
    Ok(())
}

fn check_length(field: &'static str, found: usize, expected: usize) -> Result<(), SimError> {
    if found == expected {
        return Ok(());
    }
    Err(SimError::WrongLength {
        field,
        found,
        expected,
    })
}

fn first_not_finite<T: Scalar>(values: &[T]) -> Option<(usize, f64)> {
    let index = values.iter().position(|x| !x.is_finite())?;
    Some((index, values[index].to_f64()))
}

/// A state that a step can start from.
pub(crate) fn check_state<T: Scalar>(model: &Model, s: &State<T>) -> Result<(), SimError> {
    check_values("time", &[s.time], 1)?;
    for (field, values, expected) in [
        ("qpos", &s.qpos, model.nq),
        ("qvel", &s.qvel, model.nv),
        ("act", &s.act, model.na),
        ("ctrl", &s.ctrl, model.nu()),
        ("qfrc_applied", &s.qfrc_applied, model.nv),
        ("qacc_warmstart", &s.qacc_warmstart, model.nv),
    ] {
        check_values(field, values, expected)?;
    }
    check_rows("xfrc_applied", &s.xfrc_applied, model.nbody(), |f| {
        f.to_array()
    })?;
    check_rows("mocap_pos", &s.mocap_pos, model.nmocap, |p| p.to_array())?;
    check_rows("mocap_quat", &s.mocap_quat, model.nmocap, |q| q.to_array())?;
    check_length("eq_active", s.eq_active.len(), model.equalities.len())
}

/// What a step from `time` produced: finite accelerations and constraint forces, and a finite state.
pub(crate) fn check_result<T: Scalar>(
    time: T,
    state: &State<T>,
    ws: &Workspace<T>,
) -> Result<(), SimError> {
    let time = time.to_f64();
    if ws.singular {
        return Err(SimError::Singular { time });
    }
    for (field, values) in [
        ("qacc", &ws.qacc),
        ("qfrc_constraint", &ws.qfrc_constraint),
        ("qvel", &state.qvel),
        ("qpos", &state.qpos),
        ("act", &state.act),
    ] {
        if let Some((index, value)) = first_not_finite(values) {
            return Err(SimError::Diverged {
                time,
                field,
                index,
                value,
            });
        }
    }
    let stats = ws.solver.stats().lane(0);
    if stats.status == Status::NonFinite {
        return Err(SimError::Diverged {
            time,
            field: "gap",
            index: 0,
            value: stats.gap,
        });
    }
    Ok(())
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
