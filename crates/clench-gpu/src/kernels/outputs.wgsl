// Lengths, velocities, moment arms and forces of actuators: one each, but for orientation servos, which have three.

// The first of actuator `u`.
fn output_of(u: u32) -> u32 {
    if (!ANY_ORIENTATION) {
        return u;
    }
    return words[ACTUATOR_OUTPUT + u];
}

// Where its moment arms begin.
fn first_arm(u: u32) -> u32 {
    return words[ACTUATOR_ROW + output_of(u)];
}

fn is_orientation_servo(u: u32) -> bool {
    return ANY_ORIENTATION && words[GAIN_LAW + u] == LAW_ORIENTATION;
}
