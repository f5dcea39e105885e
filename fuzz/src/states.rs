//! JSON states, as `clench forward` reads them.

use crate::trial::{check_result, machine};
use clench_cli::protocol::forward;
use clench_cli::state_line;
use std::sync::LazyLock;

/// Reads a state and computes with it.
pub fn states(data: &[u8]) -> bool {
    let Ok(line) = std::str::from_utf8(data) else {
        return false;
    };
    static MACHINE: LazyLock<std::sync::Arc<clench::Model>> = LazyLock::new(machine);
    let mut sim = clench::Sim::<f64>::new(MACHINE.clone()).expect("our own model");
    let done = state_line::apply(line, &mut sim)
        .and_then(|contacts| forward(&mut sim, contacts.as_deref()));
    let accepted = done.is_ok();
    if accepted {
        check_result(&sim);
    }
    accepted
}
