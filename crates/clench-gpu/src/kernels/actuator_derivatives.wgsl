// Velocity derivatives of actuator forces, after all limits: zero if a limit of the actuator, its tendon or its joint
// is active. CPU counterparts: `dynamics/actuator_derivatives.rs` and `gain.rs`.

// The relative tolerance with which a sum of forces scaled into a range is at one of its ends.
const SUM_ROUNDING: f32 = max(1e-10, 16.0 * EPSILON);

// Ignores all limits.
fn unlimited_slope(u: u32) -> f32 {
    let length = fetch(ACTUATOR_LENGTH + output_of(u));
    let velocity = fetch(ACTUATOR_VELOCITY + output_of(u));
    let gain_at = ACTUATOR_GAIN + LAW_SIZE * u;
    var slope = parameter(gain_at + AFFINE_VELOCITY);
    if (ANY_MUSCLE && words[GAIN_LAW + u] == LAW_MUSCLE) {
        slope = muscle_gain_slope(gain_at, length, velocity);
    }
    if (slope != 0.0) {
        slope *= actuator_input(u, length, velocity);
    }
    if (ANY_CONTROLLER && words[GAIN_LAW + u] == LAW_DC_MOTOR) {
        slope = electrical_slope(u, circuit_of(u, setpoints_of(u), length, velocity));
    }
    if (ANY_MUSCLE && words[BIAS_LAW + u] == LAW_MUSCLE) {
        return slope;
    }
    return slope + parameter(ACTUATOR_BIAS + LAW_SIZE * u + AFFINE_VELOCITY);
}

fn is_saturated(x: f32, range: u32) -> bool {
    return x <= parameter(range) || x >= parameter(range + 1u);
}

// Returns true if the total actuator force on a tendon is at a limit.
fn tendon_is_saturated(t: u32) -> bool {
    let total = fetch(TEN_ACTUATOR_FORCE + t);
    let low = parameter(TENDON_FORCE_RANGE + 2u * t);
    let high = parameter(TENDON_FORCE_RANGE + 2u * t + 1u);
    return total <= low + abs(low) * SUM_ROUNDING || total >= high - abs(high) * SUM_ROUNDING;
}

// Returns true if a limit of the actuator or its tendon is active. Cogging and friction of a motor are added after its
// limit, which applies only to its current.
fn is_at_limit(u: u32) -> bool {
    let is_motor = ANY_CONTROLLER && words[BIAS_LAW + u] == LAW_DC_MOTOR;
    let limited = select(ACTUATOR_FORCE, CURRENT_FORCE, is_motor) + output_of(u);
    if (is_saturated(fetch(limited), FORCE_RANGE + 2u * u)) {
        return true;
    }
    let t = words[ACTUATOR_LIMITED_TENDON + u];
    return t != NONE && tendon_is_saturated(t);
}

fn joint_holds(u: u32) -> bool {
    let dof = words[ACTUATOR_DOF + first_arm(u)];
    return words[ACTUATOR_ON + u] <= ON_FREE && is_saturated(fetch(QFRC_ACTUATOR + dof), DOF_FORCE_RANGE + 2u * dof);
}

fn velocity_slope(u: u32) -> f32 {
    if (is_orientation_servo(u)) {
        return select(servo_slope(u), 0.0, words[ACTUATOR_OFF + u] == 1u);
    }
    if (words[ACTUATOR_OFF + u] == 1u || joint_holds(u)) {
        return 0.0;
    }
    let at_limit = is_at_limit(u);
    if (ANY_CONTROLLER && words[GAIN_LAW + u] == LAW_DC_MOTOR) {
        // As in MuJoCo, friction counts with a motor's gain although it is part of its bias. No limit applies to it.
        let friction = mechanical_slope(u);
        if (at_limit) {
            return select(0.0, friction, words[BIAS_LAW + u] == LAW_DC_MOTOR);
        }
        return unlimited_slope(u) + friction;
    }
    if (at_limit) {
        return 0.0;
    }
    return unlimited_slope(u);
}
