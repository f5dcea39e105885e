// Automatic resets: a step that failed leaves the initial state, from which the host lets it be repeated once. CPU
// counterpart: `fail` in `batch/stepper.rs` of clench-rigid.

// Returns true if a step with this fault is repeated: not beyond a capacity, nor if it is already a repetition.
fn is_repeated(fault: u32) -> bool {
    let beyond_capacity = fault == CONTACT_OVERFLOW || fault == STICK_OVERFLOW || fault == UNFINISHED;
    return AUTORESET && !beyond_capacity && reports[REPEATS * envs + env] == 0u;
}

// Resets the state; without the controls if they are those of a rollout.
fn start_over() {
    for (var k = member; k < bound(STATE); k += TEAM) {
        let is_control = k >= CTRL && k < QFRC_APPLIED;
        if (!(is_control && words[KEEPS_CONTROLS] == 1u)) {
            put_state(k, initial_number(k));
        }
    }
}

// Counts a step that failed.
fn count_failure(fault: u32) {
    if (is_repeated(fault)) {
        reports[STEPS * envs + env] = 0u;
        reports[RESETS * envs + env] += 1u;
        reports[REPEATS * envs + env] = 1u;
        return;
    }
    // A repetition that fails too is no reset.
    if (AUTORESET) {
        reports[RESETS * envs + env] -= reports[REPEATS * envs + env];
    }
    reports[STATUS * envs + env] = fault;
}
