// Setpoints of controllers, and PID controllers. CPU counterparts: `dynamics/setpoint.rs` and `pid.rs`.

// The controls of an actuator with a controller, by meaning; `first` is the first after all limits.
struct Setpoints {
    position: f32,
    velocity: f32,
    feedforward: f32,
    voltage: f32,
    first: f32,
}

fn setpoints_of(u: u32) -> Setpoints {
    var setpoints = Setpoints();
    let start = words[ACTUATOR_CTRL + u];
    for (var c = start; c < words[ACTUATOR_CTRL + u + 1u]; c++) {
        var value = fetch(ACTING_CTRL + c);
        if (c == start) {
            let a = state_of(u, STATE_SLEW);
            if (a != NONE) {
                let is_pid = words[ACTUATOR_DYNAMICS + u] == DYN_PID;
                let rate = controller(u, CONTROLLER_DYNAMICS + select(7u, 1u, is_pid));
                let before = fetch_state(ACT + a);
                let limit = rate * TIMESTEP;
                value = clamp(nearest_setpoint(u, value, before), before - limit, before + limit);
            }
            setpoints.first = value;
        }
        switch words[CONTROL_INPUT + c] {
            case INPUT_POSITION: {
                setpoints.position = value;
            }
            case INPUT_VELOCITY: {
                setpoints.velocity = value;
            }
            case INPUT_FEEDFORWARD: {
                setpoints.feedforward = value;
            }
            case INPUT_VOLTAGE: {
                setpoints.voltage = value;
            }
            case INPUT_COMMAND, INPUT_ROTATION_VECTOR, INPUT_QUATERNION, default: {
            }
        }
    }
    return setpoints;
}

// Returns the rate of an integral of an error; at its limit, if positive, it can only decrease in magnitude.
fn integral_rate(error: f32, integral: f32, bound: f32) -> f32 {
    if (bound > 0.0 && integral >= bound) {
        return min(error, 0.0);
    }
    if (bound > 0.0 && integral <= -bound) {
        return max(error, 0.0);
    }
    return error;
}

// Computes the rates of the activations that both kinds of controller have, for an error of the position.
fn controller_rates(u: u32, setpoints: Setpoints, error: f32, bound: f32) {
    let slew = state_of(u, STATE_SLEW);
    if (slew != NONE) {
        put(ACT_DOT + slew, (setpoints.first - fetch_state(ACT + slew)) / TIMESTEP);
    }
    let integral = state_of(u, STATE_INTEGRAL);
    if (integral != NONE) {
        put(ACT_DOT + integral, integral_rate(error, fetch_state(ACT + integral), bound));
    }
}

fn pid_rates(u: u32, setpoints: Setpoints, length: f32) {
    let target_length = nearest_setpoint(u, setpoints.position, length);
    controller_rates(u, setpoints, target_length - length, controller(u, CONTROLLER_DYNAMICS));
}

// Returns the part of a PID controller's force due to setpoints and the integral.
fn pid_force(u: u32, setpoints: Setpoints, length: f32, velocity: f32) -> f32 {
    let target_length = nearest_setpoint(u, setpoints.position, length);
    let pull = setpoints.feedforward - controller(u, CONTROLLER_BIAS + 1u) * target_length;
    let force = pull - controller(u, CONTROLLER_BIAS + 2u) * setpoints.velocity;
    let a = state_of(u, STATE_INTEGRAL);
    if (a == NONE) {
        return force;
    }
    return force + controller(u, CONTROLLER_GAIN) * acting(u, a, velocity);
}
