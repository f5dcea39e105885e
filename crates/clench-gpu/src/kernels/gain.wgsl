// Inputs, gains and biases of actuators, force = gain · input + bias. CPU counterparts: `dynamics/gain.rs`,
// `activation.rs` and `activation_rates.rs`.
//
// Gain and bias are affine in the length and the velocity of the actuator, or those of a muscle, a controller or a
// motor. Terms that a kind lacks have a zero coefficient.

fn affine(offset: u32, length: f32, velocity: f32) -> f32 {
    let moved = parameter(offset + AFFINE_CONSTANT) + parameter(offset + AFFINE_LENGTH) * length;
    return moved + parameter(offset + AFFINE_VELOCITY) * velocity;
}

// Returns activation `a` of actuator `u` as its gain uses it.
fn acting(u: u32, a: u32, velocity: f32) -> f32 {
    let act = fetch_state(ACT + a);
    if (words[ACTUATOR_EARLY + u] == 1u) {
        return next_activation(u, a, act, fetch(ACT_DOT + a), velocity);
    }
    return act;
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
        case DYN_NONE, DYN_PID, DYN_DC_MOTOR, DYN_USER, default: {
            return 0.0;
        }
    }
}

// Returns the input that the gain multiplies: the control or the activation.
fn actuator_input(u: u32, length: f32, velocity: f32) -> f32 {
    let a = words[ACTUATOR_ACT + u];
    var input: f32 = 0.0;
    if (ANY_ACTIVATION && a != NONE) {
        input = acting(u, a, velocity);
    } else {
        input = fetch(ACTING_CTRL + words[ACTUATOR_CTRL + u]);
    }
    return nearest_setpoint(u, input, length);
}

// Stores the rates of the activations, and returns the force before any limit, without the parts that no limit applies
// to; zero if the actuator is off.
fn unlimited_force(u: u32) -> f32 {
    let length = fetch(ACTUATOR_LENGTH + output_of(u));
    let velocity = fetch(ACTUATOR_VELOCITY + output_of(u));
    let gain_law = words[GAIN_LAW + u];
    let bias_law = words[BIAS_LAW + u];
    var setpoints = Setpoints();
    var circuit = Circuit();
    if (ANY_CONTROLLER && words[ACTUATOR_CONTROLLER + u] != NONE) {
        setpoints = setpoints_of(u);
        circuit = circuit_of(u, setpoints, length, velocity);
    }
    if (ANY_CONTROLLER && words[ACTUATOR_DYNAMICS + u] == DYN_PID) {
        pid_rates(u, setpoints, length);
    } else if (ANY_CONTROLLER && words[ACTUATOR_DYNAMICS + u] == DYN_DC_MOTOR) {
        motor_rates(u, setpoints, circuit, length, velocity);
    } else if (ANY_ACTIVATION && words[ACTUATOR_ACT + u] != NONE) {
        let a = words[ACTUATOR_ACT + u];
        put(ACT_DOT + a, activation_rate(u, fetch(ACTING_CTRL + words[ACTUATOR_CTRL + u]), fetch_state(ACT + a)));
    }
    if (words[ACTUATOR_OFF + u] == 1u) {
        return 0.0;
    }
    var gain: f32 = 1.0;
    var input: f32 = 0.0;
    if (ANY_CONTROLLER && gain_law == LAW_PID) {
        input = pid_force(u, setpoints, length, velocity);
    } else if (ANY_CONTROLLER && gain_law == LAW_DC_MOTOR) {
        gain = motor_gain(u, circuit);
        input = motor_input(u, circuit, velocity);
    } else {
        input = actuator_input(u, length, velocity);
        if (ANY_MUSCLE && gain_law == LAW_MUSCLE) {
            gain = muscle_gain(ACTUATOR_GAIN + LAW_SIZE * u, length, velocity);
        } else {
            gain = affine(ACTUATOR_GAIN + LAW_SIZE * u, length, velocity);
        }
    }
    if (ANY_MUSCLE && bias_law == LAW_MUSCLE) {
        return gain * input + muscle_bias(ACTUATOR_BIAS + LAW_SIZE * u, length);
    }
    if (ANY_CONTROLLER && bias_law == LAW_DC_MOTOR) {
        return gain * input - back_emf(u, gain, velocity);
    }
    return gain * input + affine(ACTUATOR_BIAS + LAW_SIZE * u, length, velocity);
}
