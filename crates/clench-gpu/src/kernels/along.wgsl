// Tendons and lengths of actuators, with consecutive indices, as directions of the terms of a metric. CPU counterpart:
// `Along` in `dynamics/metric.rs`.

// The moment arms along one: the offsets of their dofs in `words` and of their entries in `work`, and their range.
struct Arms {
    dofs: u32,
    entries: u32,
    start: u32,
    end: u32,
}

fn arms_along(along: u32) -> Arms {
    if (along < NTENDON) {
        return Arms(TENDON_DOF, TEN_JACOBIAN, words[TENDON_ROW + along], words[TENDON_ROW + along + 1u]);
    }
    let output = along - NTENDON;
    return Arms(ACTUATOR_DOF, ACTUATOR_MOMENT, words[ACTUATOR_ROW + output], words[ACTUATOR_ROW + output + 1u]);
}

// Returns the sum of the arms of coupling `k` times a vector in `work`.
fn coupling_times(k: u32, x: u32) -> f32 {
    let arms = arms_along(words[COUPLING_ALONG + k]);
    var sum: f32 = 0.0;
    for (var n = arms.start; n < arms.end; n++) {
        sum += fetch(arms.entries + n) * fetch(x + words[arms.dofs + n]);
    }
    return sum;
}

fn coupling_scale(k: u32) -> f32 {
    return fetch(ALONG_SCALE + words[COUPLING_ALONG + k]);
}

// Returns the arm along dof `i`.
fn arm_along(along: u32, i: u32) -> f32 {
    let arms = arms_along(along);
    for (var n = arms.start; n < arms.end; n++) {
        if (words[arms.dofs + n] == i) {
            return fetch(arms.entries + n);
        }
    }
    return 0.0;
}
