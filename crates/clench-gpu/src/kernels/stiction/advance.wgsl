// The motion of dry friction that sticks in a step, and the memory after a failed one. CPU counterpart:
// `advance_friction` in `stiction/friction.rs`.

// Adds the motion along the velocity at `velocity`, with the gradients of tendons at `jacobian` (both in work).
fn advance_friction(velocity: u32, jacobian: u32) {
    for (var k = member; k < NDISPLACED; k += TEAM) {
        let i = words[DISPLACED + k];
        var rate: f32 = 0.0;
        if (i < NV) {
            rate = fetch(velocity + i);
        } else {
            rate = tendon_rate(i - NV, velocity, jacobian);
        }
        put_state(STICK_FRICTION + i, fetch_state(STICK_FRICTION + i) + TIMESTEP * rate);
    }
}

// Restores the memory at the start of the step.
fn restore_memory() {
    for (var k = member; k < REFERENCE_SIZE * MAX_STICK_PAIRS; k += TEAM) {
        put_state(STICK_REFERENCES + k, fetch(START_STICK_REFERENCES + k));
    }
    for (var k = member; k < NV + NTENDON; k += TEAM) {
        put_state(STICK_FRICTION + k, fetch(START_STICK_FRICTION + k));
    }
}
