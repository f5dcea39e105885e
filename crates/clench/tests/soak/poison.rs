//! Numbers that are invalid in a state.

use crate::dice::Dice;
use clench::rigid::Precision;
use clench::rigid::batch::StateRows;

/// The poison of an environment.
pub struct Poison {
    /// The poisoned field of the state.
    pub field: &'static str,
    /// True if a step can start from it.
    pub finite: bool,
}

/// Writes a bad number to a random position in the state of an environment.
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
