// Stores the controls of a step for delayed actuators, and the measurements at its start for delayed sensors. CPU
// counterpart: `history.rs` of clench-dynamics.

// Moves `count` numbers of a buffer down by `by`.
fn shift_down(first: u32, count: u32, by: u32) {
    for (var k = by; k < count; k++) {
        put_state(first + k - by, fetch_state(first + k));
    }
}

// Replaces the oldest sample by a new one at the present; returns the offset of its values.
fn take_sample(h: u32) -> u32 {
    let samples = words[h + HISTORY_SAMPLES];
    let width = words[h + HISTORY_WIDTH];
    let times = HISTORY + words[h + HISTORY_START] + 1u;
    let values = times + samples;
    shift_down(times, samples, 1u);
    put_state(times + samples - 1u, 0.0);
    shift_down(values, samples * width, width);
    return values + (samples - 1u) * width;
}

// Ages the samples by a time step.
fn age_samples(h: u32) {
    let times = HISTORY + words[h + HISTORY_START] + 1u;
    for (var k = 0u; k < words[h + HISTORY_SAMPLES]; k++) {
        put_state(times + k, fetch_state(times + k) - TIMESTEP);
    }
}

fn push_controls() {
    for (var u = member; u < NU; u += TEAM) {
        let h = words[ACTUATOR_HISTORY + u];
        if (h == NONE) {
            continue;
        }
        let sample = take_sample(h);
        for (var part = 0u; part < words[h + HISTORY_WIDTH]; part++) {
            put_state(sample + part, fetch_state(CTRL + words[ACTUATOR_CTRL + u] + part));
        }
        age_samples(h);
    }
}

fn push_measurements() {
    for (var i = member; i < NSENSOR; i += TEAM) {
        let s = SENSORS + SENSOR_SIZE * i;
        let h = words[s + SENSOR_HISTORY];
        if (h == NONE) {
            continue;
        }
        let period = parameter(SENSOR_PRM + SENSOR_PRM_SIZE * i + SENSOR_PRM_PERIOD);
        if (is_due(h, period)) {
            put_state(HISTORY + words[h + HISTORY_START], fetch_state(HISTORY + words[h + HISTORY_START]) + max(period, 0.0));
            let sample = take_sample(h);
            for (var part = 0u; part < words[h + HISTORY_WIDTH]; part++) {
                put_state(sample + part, fetch(UNDELAYED + words[s + SENSOR_OFFSET] + part));
            }
        }
        age_samples(h);
    }
}
