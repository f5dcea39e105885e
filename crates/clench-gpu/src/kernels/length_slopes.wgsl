// Length derivatives of actuator forces, after all limits: zero if a limit of the actuator, its tendon or its joint is
// active. CPU counterparts: `dynamics/actuator_derivatives.rs`, `gain.rs`, `muscle.rs` and `dc_motor.rs`.

// Returns the derivative of a parabola with the given width, `x` from its start or end.
fn parabola_slope(x: f32, width: f32) -> f32 {
    return x / (divisor(width) * divisor(width));
}

// Returns the derivative of the active force by length.
fn active_by_length_slope(l: f32, lmin: f32, lmax: f32) -> f32 {
    let left = 0.5 * (lmin + 1.0);
    let right = 0.5 * (1.0 + lmax);
    if (l < lmin || l > lmax) {
        return 0.0;
    }
    if (l <= left) {
        return parabola_slope(l - lmin, left - lmin);
    }
    if (l > right) {
        return -parabola_slope(lmax - l, lmax - right);
    }
    if (l <= 1.0) {
        return parabola_slope(1.0 - l, 1.0 - left);
    }
    return -parabola_slope(l - 1.0, right - 1.0);
}

// Returns the derivative of the factor of the activation with respect to the length.
fn muscle_gain_length_slope(prm: u32, length: f32, velocity: f32) -> f32 {
    let resting = divisor(parameter(prm + MUSCLE_RESTING_LENGTH));
    let v = velocity / divisor(parameter(prm + MUSCLE_RESTING_LENGTH) * parameter(prm + MUSCLE_VMAX));
    let lmin = parameter(prm + MUSCLE_LMIN);
    let slope = active_by_length_slope(muscle_length(prm, length), lmin, parameter(prm + MUSCLE_LMAX)) / resting;
    return -parameter(prm + MUSCLE_STRENGTH) * slope * active_by_velocity(v, parameter(prm + MUSCLE_FVMAX));
}

// Returns the derivative of the passive force.
fn muscle_bias_slope(prm: u32, length: f32) -> f32 {
    let l = muscle_length(prm, length);
    if (l <= 1.0) {
        return 0.0;
    }
    let bend = 0.5 * (1.0 + parameter(prm + MUSCLE_LMAX));
    let width = divisor(bend - 1.0);
    let slope = select(1.0 / width, (l - 1.0) / (width * width), l <= bend);
    return -parameter(prm + MUSCLE_STRENGTH) * parameter(prm + MUSCLE_FPMAX) * slope / divisor(parameter(prm + MUSCLE_RESTING_LENGTH));
}

// Returns ∂force/∂length of cogging.
fn cogging_slope(u: u32) -> f32 {
    let poles = controller(u, CONTROLLER_BIAS + 1u);
    let phase = poles * fetch(ACTUATOR_LENGTH + output_of(u)) + controller(u, CONTROLLER_BIAS + 2u);
    return controller(u, CONTROLLER_BIAS) * poles * sin_cos(phase).y;
}

// Ignores all limits.
fn unlimited_length_slope(u: u32) -> f32 {
    let length = fetch(ACTUATOR_LENGTH + output_of(u));
    let velocity = fetch(ACTUATOR_VELOCITY + output_of(u));
    let gain_at = ACTUATOR_GAIN + LAW_SIZE * u;
    var slope = parameter(gain_at + AFFINE_LENGTH);
    if (ANY_MUSCLE && words[GAIN_LAW + u] == LAW_MUSCLE) {
        slope = muscle_gain_length_slope(gain_at, length, velocity);
    }
    if (slope != 0.0) {
        slope *= actuator_input(u, length, velocity);
    }
    if (ANY_CONTROLLER && words[GAIN_LAW + u] == LAW_DC_MOTOR) {
        let circuit = circuit_of(u, setpoints_of(u), length, velocity);
        slope = by_voltage(u, circuit, circuit.voltage_length_slope);
    }
    if (ANY_MUSCLE && words[BIAS_LAW + u] == LAW_MUSCLE) {
        return slope + muscle_bias_slope(ACTUATOR_BIAS + LAW_SIZE * u, length);
    }
    return slope + parameter(ACTUATOR_BIAS + LAW_SIZE * u + AFFINE_LENGTH);
}

fn length_slope(u: u32) -> f32 {
    if (is_orientation_servo(u)) {
        return select(servo_length_slope(u), 0.0, words[ACTUATOR_OFF + u] == 1u);
    }
    if (words[ACTUATOR_OFF + u] == 1u || joint_holds(u)) {
        return 0.0;
    }
    var slope: f32 = 0.0;
    if (!is_at_limit(u)) {
        slope = unlimited_length_slope(u);
    }
    if (ANY_CONTROLLER && words[BIAS_LAW + u] == LAW_DC_MOTOR) {
        slope += cogging_slope(u);
    }
    return slope;
}
