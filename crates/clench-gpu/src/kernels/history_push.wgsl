// Keeps the controls of a step for those that they reach late. Sister of `history.rs` of clench-rigid.

// Moves `count` numbers of a buffer down by `by`.
fn shift_down(first: u32, count: u32, by: u32) {
    for (var k = by; k < count; k++) {
        keep(first + k - by, given(first + k));
    }
}

fn push_controls() {
    for (var u = 0u; u < NU; u++) {
        let h = words[ACTUATOR_HISTORY + u];
        if (h == NONE) {
            continue;
        }
        let samples = words[h + 1u];
        let width = words[h + 2u];
        let times = HISTORY + words[h] + 1u;
        let values = times + samples;
        shift_down(values, samples * width, width);
        for (var part = 0u; part < width; part++) {
            keep(values + (samples - 1u) * width + part, given(CTRL + words[ACTUATOR_CTRL + u] + part));
        }
        shift_down(times, samples, 1u);
        keep(times + samples - 1u, 0.0);
        for (var k = 0u; k < samples; k++) {
            keep(times + k, given(times + k) - TIMESTEP);
        }
    }
}
