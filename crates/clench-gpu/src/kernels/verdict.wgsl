// What a step or forward pass must leave within bounds. Sister of `each_result` in `check.rs`.

fn is_far(x: f32) -> bool {
    return is_wild(x) || abs(x) > 1e10;
}

// Notes a number that is beyond its bounds, and where it is.
fn judge(field: u32, index: u32, x: f32, beyond: bool) {
    if (beyond && reports[TROUBLE * envs + env] == RUNNING) {
        reports[FAULT_FIELD * envs + env] = field;
        reports[FAULT_INDEX * envs + env] = index;
        reports[FAULT_VALUE * envs + env] = report_bits(x);
        trouble(DIVERGED);
    }
}

fn judge_results() {
    for (var i = 0u; i < bound(NV); i++) {
        let x = fetch(QACC + i);
        judge(OF_QACC, i, x, is_far(x));
    }
    for (var i = 0u; i < bound(NV); i++) {
        let x = fetch(QFRC_CONSTRAINT + i);
        judge(OF_QFRC_CONSTRAINT, i, x, is_wild(x));
    }
    for (var i = 0u; i < bound(NV); i++) {
        let x = given(QVEL + i);
        judge(OF_QVEL, i, x, is_far(x));
    }
    for (var i = 0u; i < bound(NQ); i++) {
        let x = given(QPOS + i);
        judge(OF_QPOS, i, x, is_far(x));
    }
    for (var a = 0u; a < NA; a++) {
        let x = given(ACT + a);
        judge(OF_ACT, a, x, is_wild(x));
    }
}
