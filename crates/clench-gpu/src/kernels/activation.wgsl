// Integration of activations. CPU counterpart: `dynamics/activation.rs`.

// Returns the setpoint of a servo on a circle, moved by full turns to be nearest to `near`; other inputs are unchanged.
fn nearest_setpoint(u: u32, input: f32, near: f32) -> f32 {
    let rotation = parameter(ACTUATOR_TURN + u);
    if (rotation == 0.0) {
        return input;
    }
    return input - rotation * floor((input - near) / rotation + 0.5);
}

fn time_constant(u: u32) -> f32 {
    return max(parameter(DYNAMICS_PRM + 3u * u), TINY);
}

// Computes e^x − 1 by its Taylor series for small x, where the device's own function loses digits. The relative
// truncation error is below 10⁻¹⁶.
fn exp_less_one(x: f32) -> f32 {
    if (abs(x) < 0.5) {
        var sum: f32 = 1.0;
        for (var k = 15u; k > 1u; k--) {
            sum = 1.0 + sum * x / f32(k);
        }
        return x * sum;
    }
    return exponential(x) - 1.0;
}

// Returns activation `a` of actuator `u` one time step later, within its range.
fn next_activation(u: u32, a: u32, act: f32, rate: f32, velocity: f32) -> f32 {
    if (ANY_CONTROLLER && words[ACTUATOR_DYNAMICS + u] == DYN_DC_MOTOR) {
        return next_motor_activation(u, a, act, rate, velocity);
    }
    var time = TIMESTEP;
    if (words[ACTUATOR_DYNAMICS + u] == DYN_FILTER_EXACT) {
        let tau = time_constant(u);
        time = -tau * exp_less_one(-TIMESTEP / tau);
    }
    return clamp(act + rate * time, parameter(ACT_RANGE + 2u * u), parameter(ACT_RANGE + 2u * u + 1u));
}
