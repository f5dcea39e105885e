// The states of direct-current motors. CPU counterpart: `dynamics/dc_motor.rs`, which lists formulas and parameters.
// Each actuator with a controller has ten numbers of its dynamics, then of its gain, then of its bias.

fn controller(u: u32, offset: u32) -> f32 {
    return parameter(CONTROLLER_PRM + CONTROLLER_SIZE * words[ACTUATOR_CONTROLLER + u] + offset);
}

// Returns the activation that is the given state of actuator `u`, one of the STATE_ constants; NONE if it has none.
fn state_of(u: u32, which: u32) -> u32 {
    return words[ACTUATOR_STATES + STATE_SIZE * u + which];
}

// Returns −σ₀ |ω| / g(ω), the decay rate of the bristle's deflection.
fn bristle_decay(u: u32, velocity: f32) -> f32 {
    let coulomb = controller(u, CONTROLLER_BIAS + 3u);
    let ratio = velocity / max(controller(u, CONTROLLER_BIAS + 5u), TINY);
    let level = coulomb + (controller(u, CONTROLLER_BIAS + 4u) - coulomb) * exponential(-ratio * ratio);
    return -controller(u, CONTROLLER_DYNAMICS + 5u) * abs(velocity) / max(level, TINY);
}

// Returns an activation of a motor one time step later.
fn next_motor_activation(u: u32, a: u32, act: f32, rate: f32, velocity: f32) -> f32 {
    if (a == state_of(u, STATE_CURRENT)) {
        let te = max(controller(u, CONTROLLER_DYNAMICS), TINY);
        return act - rate * te * exp_less_one(-TIMESTEP / te);
    }
    if (a == state_of(u, STATE_BRISTLE)) {
        let decay = bristle_decay(u, velocity);
        let change = exp_less_one(decay * TIMESTEP);
        let moves = abs(decay) > TINY;
        let time = select(TIMESTEP, change / select(1.0, decay, moves), moves);
        return (change + 1.0) * act + time * velocity;
    }
    let next = act + rate * TIMESTEP;
    let bound = controller(u, CONTROLLER_DYNAMICS + 8u);
    if (a == state_of(u, STATE_INTEGRAL) && bound > 0.0) {
        return clamp(next, -bound, bound);
    }
    return next;
}
