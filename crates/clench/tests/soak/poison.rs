//! Numbers that no state should hold.

use crate::dice::Dice;
use clench::rigid::Precision;
use clench::rigid::batch::StateRows;

/// What an environment was given.
pub struct Poison {
    /// Which part of the state.
    pub field: &'static str,
    /// Whether a step can start from it all the same.
    pub finite: bool,
}

/// Writes a bad number somewhere into the state of an environment.
pub fn poison<S: Precision>(state: &mut StateRows<S>, env: usize, dice: &mut Dice) -> Poison {
    let mut fields = [
        ("time", &mut state.time),
        ("qpos", &mut state.qpos),
        ("qvel", &mut state.qvel),
        ("ctrl", &mut state.ctrl),
        ("qfrc_applied", &mut state.qfrc_applied),
        ("xfrc_applied", &mut state.xfrc_applied),
        ("qacc_warmstart", &mut state.qacc_warmstart),
    ];
    let chosen = dice.below(fields.len());
    let (field, rows) = &mut fields[chosen];
    let row = rows.row_mut(env);
    let values = [
        S::new(f64::NAN),
        S::INFINITY,
        -S::INFINITY,
        S::MAX,
        -S::MAX,
        S::new(1e30),
        S::new(-1e12),
        S::new(1e6),
        S::MIN_POSITIVE,
    ];
    let value = values[dice.below(values.len())];
    row[dice.below(row.len())] = value;
    Poison {
        field,
        finite: value.to_f64().is_finite(),
    }
}
