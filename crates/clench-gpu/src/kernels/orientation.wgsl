// Orientation servos: a torque that rotates a ball joint, or a site in the frame of another, to a commanded orientation
// by the shortest rotation. CPU counterpart: `dynamics/orientation.rs`.

// Returns the orientation of a rotation vector.
fn quat_from_rotation_vector(v: vec3f) -> vec4f {
    let axis = direction(v);
    return quat_from_axis_angle(axis.xyz, axis.w);
}

// Returns the target orientation of servo `u`; stores the rates of its activations.
fn servo_target(u: u32) -> vec4f {
    let c = words[ACTUATOR_CTRL + u];
    let vector = fetch3(ACTING_CTRL + c);
    if (words[CONTROL_INPUT + c] == INPUT_QUATERNION) {
        return quat_normalize(vec4f(vector, fetch(ACTING_CTRL + c + 3u)));
    }
    let last = words[ACTUATOR_ACT + u];
    if (!ANY_ACTIVATION || last == NONE) {
        return quat_from_rotation_vector(vector);
    }
    var acts = vec3f();
    for (var k = 0u; k < bound(3u); k++) {
        put(ACT_DOT + last - 2u + k, vector[k]);
        acts[k] = acting(u, last - 2u + k, 0.0);
    }
    return quat_from_rotation_vector(acts);
}

// Returns the torque of servo `u` before any limit; zero if it is off.
fn servo_torque(u: u32) -> vec3f {
    let output = output_of(u);
    let now = quat_from_rotation_vector(fetch3(ACTUATOR_LENGTH + output));
    let error = quat_difference(servo_target(u), now);
    let bias = ACTUATOR_BIAS + LAW_SIZE * u;
    let damping = fetch3(ACTUATOR_VELOCITY + output) * parameter(bias + AFFINE_VELOCITY);
    let torque = error * parameter(ACTUATOR_GAIN + LAW_SIZE * u) + parameter(bias) + damping;
    return select(torque, vec3f(), words[ACTUATOR_OFF + u] == 1u);
}

// Limits the norm of the torque to the upper end of its range; its direction stays.
fn limit_torque(u: u32) {
    let offset = ACTUATOR_FORCE + output_of(u);
    let torque = fetch3(offset);
    let norm = length(torque);
    let limit = parameter(FORCE_RANGE + 2u * u + 1u);
    if (norm > limit) {
        put3(offset, torque * (limit / norm));
    }
}

// Returns true if the limit of the torque is active.
fn servo_is_at_limit(u: u32) -> bool {
    let norm = length(fetch3(ACTUATOR_FORCE + output_of(u)));
    return norm >= parameter(FORCE_RANGE + 2u * u + 1u) * (1.0 - max(1e-10, 16.0 * EPSILON));
}

// Returns ∂torque/∂ω, the same about each axis; zero if the limit is active.
fn servo_slope(u: u32) -> f32 {
    return select(parameter(ACTUATOR_BIAS + LAW_SIZE * u + AFFINE_VELOCITY), 0.0, servo_is_at_limit(u));
}

// Returns ∂torque/∂angle at small angles from the target, likewise.
fn servo_length_slope(u: u32) -> f32 {
    return select(-parameter(ACTUATOR_GAIN + LAW_SIZE * u), 0.0, servo_is_at_limit(u));
}
