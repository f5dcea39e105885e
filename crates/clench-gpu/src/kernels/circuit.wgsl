// The circuits and forces of direct-current motors. CPU counterpart: `dynamics/dc_motor.rs`.

// A motor's circuit at an instant: R, K, V, ∂V/∂ω and ∂V/∂length.
struct Circuit {
    resistance: f32,
    constant: f32,
    voltage: f32,
    voltage_slope: f32,
    voltage_length_slope: f32,
}

fn circuit_of(u: u32, setpoints: Setpoints, length: f32, velocity: f32) -> Circuit {
    let cold = controller(u, CONTROLLER_GAIN);
    let constant = controller(u, CONTROLLER_GAIN + 1u);
    var voltage: f32 = 0.0;
    var slope: f32 = 0.0;
    var length_slope: f32 = 0.0;
    if (words[ACTUATOR_CONTROLLED + u] == 1u) {
        let a = state_of(u, STATE_INTEGRAL);
        var integral: f32 = 0.0;
        if (a != NONE) {
            integral = fetch_state(ACT + a);
        }
        let kp = controller(u, CONTROLLER_GAIN + 4u);
        let kd = controller(u, CONTROLLER_GAIN + 6u);
        let torque = kp * (setpoints.position - length) + kd * (setpoints.velocity - velocity)
            + controller(u, CONTROLLER_GAIN + 5u) * integral + setpoints.feedforward;
        let per_torque = cold / constant;
        voltage = per_torque * torque + constant * velocity;
        slope = constant - per_torque * kd;
        length_slope = -per_torque * kp;
        let limit = controller(u, CONTROLLER_GAIN + 7u);
        if (limit > 0.0) {
            slope = select(slope, 0.0, abs(voltage) >= limit);
            length_slope = select(length_slope, 0.0, abs(voltage) >= limit);
            voltage = clamp(voltage, -limit, limit);
        }
    }
    var resistance = cold;
    let a = state_of(u, STATE_TEMPERATURE);
    if (a != NONE) {
        let temperature = fetch_state(ACT + a) + controller(u, CONTROLLER_DYNAMICS + 4u);
        resistance = cold * (1.0 + controller(u, CONTROLLER_GAIN + 2u) * (temperature - controller(u, CONTROLLER_GAIN + 3u)));
    }
    return Circuit(resistance, constant, voltage + setpoints.voltage, slope, length_slope);
}

// Returns the steady current of a voltage and back-EMF.
fn steady_current(circuit: Circuit, velocity: f32) -> f32 {
    return (circuit.voltage - circuit.constant * velocity) / circuit.resistance;
}

fn motor_rates(u: u32, setpoints: Setpoints, circuit: Circuit, length: f32, velocity: f32) {
    controller_rates(u, setpoints, setpoints.position - length, controller(u, CONTROLLER_DYNAMICS + 8u));
    let steady = steady_current(circuit, velocity);
    let current = state_of(u, STATE_CURRENT);
    let temperature = state_of(u, STATE_TEMPERATURE);
    if (temperature != NONE) {
        var flows = steady;
        if (current != NONE) {
            flows = fetch_state(ACT + current);
        }
        let loss = fetch_state(ACT + temperature) / controller(u, CONTROLLER_DYNAMICS + 2u);
        put(ACT_DOT + temperature, (circuit.resistance * flows * flows - loss) / controller(u, CONTROLLER_DYNAMICS + 3u));
    }
    let bristle = state_of(u, STATE_BRISTLE);
    if (bristle != NONE) {
        put(ACT_DOT + bristle, bristle_decay(u, velocity) * fetch_state(ACT + bristle) + velocity);
    }
    if (current != NONE) {
        let rate = (steady - fetch_state(ACT + current)) / controller(u, CONTROLLER_DYNAMICS);
        let limit = controller(u, CONTROLLER_DYNAMICS + 1u);
        put(ACT_DOT + current, select(rate, clamp(rate, -limit, limit), limit > 0.0));
    }
}

// Returns the gain of a motor: K, which multiplies the current if that is a state, else K / R, which multiplies the
// voltage.
fn motor_gain(u: u32, circuit: Circuit) -> f32 {
    if (state_of(u, STATE_CURRENT) != NONE) {
        return circuit.constant;
    }
    return circuit.constant / max(circuit.resistance, TINY);
}

// Returns the input that the gain multiplies.
fn motor_input(u: u32, circuit: Circuit, velocity: f32) -> f32 {
    let a = state_of(u, STATE_CURRENT);
    if (a == NONE) {
        return circuit.voltage;
    }
    return acting(u, a, velocity);
}

// Returns the back-EMF's reduction of the force of an actuator with this gain: zero if the current is a state, whose
// equation includes it.
fn back_emf(u: u32, gain: f32, velocity: f32) -> f32 {
    return select(0.0, gain * controller(u, CONTROLLER_GAIN + 1u) * velocity, state_of(u, STATE_CURRENT) == NONE);
}

// Returns ∂force/∂velocity of a motor's gain, and of its back-EMF if its bias is a motor's.
fn electrical_slope(u: u32, circuit: Circuit) -> f32 {
    let no_back_emf = state_of(u, STATE_CURRENT) == NONE && words[BIAS_LAW + u] != LAW_DC_MOTOR;
    return by_voltage(u, circuit, circuit.voltage_slope - select(circuit.constant, 0.0, no_back_emf));
}

// Returns the change of the force if the driving voltage changes by `net`. If the current is a state, it follows the
// voltage within the step only with `actearly`.
fn by_voltage(u: u32, circuit: Circuit, net: f32) -> f32 {
    let a = state_of(u, STATE_CURRENT);
    let steady = circuit.constant * net / max(circuit.resistance, TINY);
    if (a == NONE) {
        return steady;
    }
    let limit = controller(u, CONTROLLER_DYNAMICS + 1u);
    let is_at_limit = limit > 0.0 && abs(fetch(ACT_DOT + a)) >= limit;
    if (words[ACTUATOR_EARLY + u] == 0u || is_at_limit) {
        return 0.0;
    }
    return -steady * exp_less_one(-TIMESTEP / max(controller(u, CONTROLLER_DYNAMICS), TINY));
}

// Returns cogging and friction, to which no limit of the motor's torque applies.
fn mechanical_force(u: u32, length: f32) -> f32 {
    let phase = controller(u, CONTROLLER_BIAS + 1u) * length + controller(u, CONTROLLER_BIAS + 2u);
    let cogging = controller(u, CONTROLLER_BIAS) * sin_cos(phase).x;
    let a = state_of(u, STATE_BRISTLE);
    if (a == NONE) {
        return cogging;
    }
    return cogging - (controller(u, CONTROLLER_DYNAMICS + 5u) * fetch_state(ACT + a) + controller(u, CONTROLLER_DYNAMICS + 6u) * fetch(ACT_DOT + a));
}

// Returns ∂force/∂velocity of friction, with the deflection's decay constant.
fn mechanical_slope(u: u32) -> f32 {
    return select(0.0, -controller(u, CONTROLLER_DYNAMICS + 6u), state_of(u, STATE_BRISTLE) != NONE);
}
