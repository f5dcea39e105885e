// Limits on the results of a step or forward pass. CPU counterpart: `good_results` in `check.rs`.

fn is_far(x: f32) -> bool {
    return is_wild(x) || abs(x) > 1e10;
}

// A checked number: its field, its index, its value, and whether it is beyond its limits.
struct Checked {
    field: u32,
    index: u32,
    x: f32,
    beyond: bool,
}

// Returns the k-th checked number.
fn checked(k: u32) -> Checked {
    var index = k;
    if (index < NV) {
        let x = fetch(QACC + index);
        return Checked(OF_QACC, index, x, is_far(x));
    }
    index -= NV;
    if (index < NV) {
        let x = fetch(QFRC_CONSTRAINT + index);
        return Checked(OF_QFRC_CONSTRAINT, index, x, is_wild(x));
    }
    index -= NV;
    if (index < NV) {
        let x = fetch_state(QVEL + index);
        return Checked(OF_QVEL, index, x, is_far(x));
    }
    index -= NV;
    if (index < NQ) {
        let x = fetch_state(QPOS + index);
        return Checked(OF_QPOS, index, x, is_far(x));
    }
    index -= NQ;
    let x = fetch_state(ACT + index);
    return Checked(OF_ACT, index, x, is_wild(x));
}

// Records the first number beyond its limits, and its location.
fn check_results() {
    join();
    var worst = NONE;
    for (var k = member; k < 3u * NV + NQ + NA; k += TEAM) {
        if (checked(k).beyond) {
            worst = min(worst, k);
        }
    }
    worst = least_of_team(worst);
    if (is_first() && worst != NONE && reports[FAILURE * envs + env] == RUNNING) {
        let number = checked(worst);
        reports[FAULT_FIELD * envs + env] = number.field;
        reports[FAULT_INDEX * envs + env] = number.index;
        reports[FAULT_VALUE * envs + env] = report_bits(number.x);
        fail(DIVERGED);
    }
    join();
}
