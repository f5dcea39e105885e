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
    let values = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        S::MAX.to_f64(),
        -S::MAX.to_f64(),
        1e30,
        -1e12,
        1e6,
        S::MIN_POSITIVE.to_f64(),
    ];
    let value = values[dice.below(values.len())];
    let mut fields = [
        ("qpos", &mut state.qpos),
        ("qvel", &mut state.qvel),
        ("ctrl", &mut state.ctrl),
        ("qfrc_applied", &mut state.qfrc_applied),
        ("xfrc_applied", &mut state.xfrc_applied),
        ("qacc_warmstart", &mut state.qacc_warmstart),
    ];
    let chosen = dice.below(fields.len() + 1);
    let field = match fields.get_mut(chosen) {
        Some((field, rows)) => {
            let row = rows.row_mut(env);
            row[dice.below(row.len())] = S::new(value);
            *field
        }
        None => {
            state.time.row_mut(env)[0] = value;
            "time"
        }
    };
    Poison {
        field,
        finite: value.is_finite(),
    }
}
