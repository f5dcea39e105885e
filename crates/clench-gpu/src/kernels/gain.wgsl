// Inputs, gains and biases of actuators, force = gain · input + bias. Sisters of `dynamics/gain.rs` and `activation.rs`.
//
// Gain and bias are affine in the length and the velocity of the actuator, or those of a muscle. What a kind lacks is a zero
// coefficient.

fn affine(place: u32, length: f32, velocity: f32) -> f32 {
    return parameter(place) + parameter(place + 1u) * length + parameter(place + 2u) * velocity;
}

fn acting_control(u: u32) -> f32 {
    let ctrl = given(CTRL + words[ACTUATOR_CTRL + u]);
    return clamp(ctrl, parameter(CTRL_RANGE + 2u * u), parameter(CTRL_RANGE + 2u * u + 1u));
}

fn activation_rate(u: u32, ctrl: f32, act: f32) -> f32 {
    switch words[ACTUATOR_DYNAMICS + u] {
        case DYN_INTEGRATOR: {
            return ctrl;
        }
        case DYN_FILTER, DYN_FILTER_EXACT: {
            return (nearest_setpoint(u, ctrl, act) - act) / time_constant(u);
        }
        case DYN_MUSCLE: {
            if (!ANY_MUSCLE) {
                return 0.0;
            }
            return muscle_rate(ctrl, act, parameter3(DYNAMICS_PRM + 3u * u));
        }
        default: {
            return 0.0;
        }
    }
}

// What the gain multiplies: the control, or the activation. Leaves the activation's rate.
fn actuator_input(u: u32, length: f32) -> f32 {
    let a = words[ACTUATOR_ACT + u];
    var input = acting_control(u);
    if (NA > 0u && a != NONE) {
        let act = given(ACT + a);
        let rate = activation_rate(u, input, act);
        put(ACT_DOT + a, rate);
        input = act;
        if (words[ACTUATOR_EARLY + u] == 1u) {
            input = next_activation(u, act, rate);
        }
    }
    return nearest_setpoint(u, input, length);
}

fn unlimited_force(u: u32) -> f32 {
    let length = fetch(ACTUATOR_LENGTH + u);
    let velocity = fetch(ACTUATOR_VELOCITY + u);
    let input = actuator_input(u, length);
    if (words[ACTUATOR_OFF + u] == 1u) {
        return 0.0;
    }
    let gain_at = ACTUATOR_GAIN + LAW_SIZE * u;
    let bias_at = ACTUATOR_BIAS + LAW_SIZE * u;
    var gain = 0.0;
    if (ANY_MUSCLE && words[GAIN_LAW + u] == LAW_MUSCLE) {
        gain = muscle_gain(gain_at, length, velocity);
    } else {
        gain = affine(gain_at, length, velocity);
    }
    if (ANY_MUSCLE && words[BIAS_LAW + u] == LAW_MUSCLE) {
        return gain * input + muscle_bias(bias_at, length);
    }
    return gain * input + affine(bias_at, length, velocity);
}

// How the force of an actuator changes with its velocity, before any limit.
fn unlimited_slope(u: u32) -> f32 {
    let length = fetch(ACTUATOR_LENGTH + u);
    let gain_at = ACTUATOR_GAIN + LAW_SIZE * u;
    var slope = parameter(gain_at + 2u);
    if (ANY_MUSCLE && words[GAIN_LAW + u] == LAW_MUSCLE) {
        slope = muscle_gain_slope(gain_at, length, fetch(ACTUATOR_VELOCITY + u));
    }
    if (slope != 0.0) {
        slope *= actuator_input(u, length);
    }
    if (ANY_MUSCLE && words[BIAS_LAW + u] == LAW_MUSCLE) {
        return slope;
    }
    return slope + parameter(ACTUATOR_BIAS + LAW_SIZE * u + 2u);
}
