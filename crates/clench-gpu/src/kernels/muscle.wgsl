// Muscles. CPU counterpart: `dynamics/muscle.rs`, which explains the curves. The parameters at `prm` are
// the MUSCLE_ constants.

fn divisor(x: f32) -> f32 {
    return max(x, TINY);
}

// Returns the rate of an activation under a control; `prm` holds the time constants and the width between them.
fn muscle_rate(ctrl: f32, act: f32, prm: vec3f) -> f32 {
    let slowing = 0.5 + 1.5 * clamp(act, 0.0, 1.0);
    let rise = prm.x * slowing;
    let fall = prm.y / slowing;
    let missing = clamp(ctrl, 0.0, 1.0) - act;
    let sudden = select(fall, rise, missing > 0.0);
    let x = clamp(missing / divisor(prm.z) + 0.5, 0.0, 1.0);
    let smoothed = fall + (rise - fall) * (x * x * x * (3.0 * x * (2.0 * x - 5.0) + 10.0));
    return missing / divisor(select(smoothed, sudden, prm.z < TINY));
}

fn muscle_length(prm: u32, length: f32) -> f32 {
    return parameter(prm + MUSCLE_START) + length / parameter(prm + MUSCLE_RESTING_LENGTH);
}

// Returns the active force by length.
fn active_by_length(l: f32, lmin: f32, lmax: f32) -> f32 {
    let left = 0.5 * (lmin + 1.0);
    let right = 0.5 * (1.0 + lmax);
    if (l < lmin || l > lmax) {
        return 0.0;
    }
    if (l <= left) {
        let rising = (l - lmin) / divisor(left - lmin);
        return 0.5 * rising * rising;
    }
    if (l > right) {
        let falling = (lmax - l) / divisor(lmax - right);
        return 0.5 * falling * falling;
    }
    let top = select((l - 1.0) / divisor(right - 1.0), (1.0 - l) / divisor(1.0 - left), l <= 1.0);
    return 1.0 - 0.5 * top * top;
}

// Returns the active force by velocity.
fn active_by_velocity(v: f32, fvmax: f32) -> f32 {
    let above = fvmax - 1.0;
    if (v <= -1.0) {
        return 0.0;
    }
    if (v <= 0.0) {
        return (v + 1.0) * (v + 1.0);
    }
    if (v <= above) {
        return fvmax - (above - v) * (above - v) / divisor(above);
    }
    return fvmax;
}

// Returns the factor of the activation.
fn muscle_gain(prm: u32, length: f32, velocity: f32) -> f32 {
    let l = muscle_length(prm, length);
    let v = velocity / divisor(parameter(prm + MUSCLE_RESTING_LENGTH) * parameter(prm + MUSCLE_VMAX));
    let by_length = active_by_length(l, parameter(prm + MUSCLE_LMIN), parameter(prm + MUSCLE_LMAX));
    return -parameter(prm + MUSCLE_STRENGTH) * by_length * active_by_velocity(v, parameter(prm + MUSCLE_FVMAX));
}

// Returns its derivative with respect to the velocity.
fn muscle_gain_slope(prm: u32, length: f32, velocity: f32) -> f32 {
    let scale = divisor(parameter(prm + MUSCLE_RESTING_LENGTH) * parameter(prm + MUSCLE_VMAX));
    let v = velocity / scale;
    let above = parameter(prm + MUSCLE_FVMAX) - 1.0;
    var slope: f32 = 0.0;
    if (v > -1.0 && v <= 0.0) {
        slope = 2.0 * (v + 1.0);
    } else if (v > 0.0 && v <= above) {
        slope = 2.0 * (above - v) / divisor(above);
    }
    let l = muscle_length(prm, length);
    return -parameter(prm + MUSCLE_STRENGTH) * active_by_length(l, parameter(prm + MUSCLE_LMIN), parameter(prm + MUSCLE_LMAX)) * slope / scale;
}

// Returns the passive force.
fn muscle_bias(prm: u32, length: f32) -> f32 {
    let l = muscle_length(prm, length);
    if (l <= 1.0) {
        return 0.0;
    }
    let bend = 0.5 * (1.0 + parameter(prm + MUSCLE_LMAX));
    let width = divisor(bend - 1.0);
    let bent = (l - 1.0) / width;
    let force = select(0.5 + (l - bend) / width, 0.5 * bent * bent, l <= bend);
    return -parameter(prm + MUSCLE_STRENGTH) * parameter(prm + MUSCLE_FPMAX) * force;
}
