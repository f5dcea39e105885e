// Lengths, velocities, moment arms and forces of actuators: one each, or three for orientation servos.

// Returns the first output of actuator `u`.
fn output_of(u: u32) -> u32 {
    if (!ANY_ORIENTATION) {
        return u;
    }
    return words[ACTUATOR_OUTPUT + u];
}

// Returns the start of its moment arms.
fn first_arm(u: u32) -> u32 {
    return words[ACTUATOR_ROW + output_of(u)];
}

fn is_orientation_servo(u: u32) -> bool {
    return ANY_ORIENTATION && words[GAIN_LAW + u] == LAW_ORIENTATION;
}
