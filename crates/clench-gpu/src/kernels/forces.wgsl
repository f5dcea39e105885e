// Actuators, and the acceleration that all forces but constraints cause. Sisters of `dynamics/actuation.rs`, `gain.rs` and
// `smooth.rs`.
//
// force = gain · control + bias, both affine in the length and the velocity of a joint times its gear. What a kind lacks is a
// zero coefficient, a range that is not limited one of all numbers.

fn affine(place: u32, length: f32, velocity: f32) -> f32 {
    return numbers[place] + numbers[place + 1u] * length + numbers[place + 2u] * velocity;
}

fn actuation() {
    clear_dofs(QFRC_ACTUATOR);
    for (var u = 0u; u < NU; u++) {
        let joint = words[ACTUATOR_JNT + u];
        let dof = words[JNT_DOF + joint];
        let gear = numbers[ACTUATOR_GEAR + u];
        let length = given(QPOS + words[JNT_QPOS + joint]) * gear;
        let velocity = given(QVEL + dof) * gear;
        let control = clamp(given(CTRL + u), numbers[CTRL_RANGE + 2u * u], numbers[CTRL_RANGE + 2u * u + 1u]);
        let gain = affine(ACTUATOR_GAIN + 3u * u, length, velocity);
        let bias = affine(ACTUATOR_BIAS + 3u * u, length, velocity);
        let range = FORCE_RANGE + 2u * u;
        let force = clamp(gain * control + bias, numbers[range], numbers[range + 1u]);
        put(ACTUATOR_LENGTH + u, length);
        put(ACTUATOR_VELOCITY + u, velocity);
        put(ACTUATOR_FORCE + u, force);
        add(QFRC_ACTUATOR + dof, gear * force);
    }
    for (var i = 0u; i < bound(NV); i++) {
        let range = DOF_FORCE_RANGE + 2u * i;
        put(QFRC_ACTUATOR + i, clamp(fetch(QFRC_ACTUATOR + i), numbers[range], numbers[range + 1u]));
    }
}

// Adds what the user applies to bodies at their centres of mass.
fn applied_wrenches() {
    var any = false;
    for (var k = 6u; k < bound(6u * NBODY); k++) {
        any = any || given(XFRC_APPLIED + k) != 0.0;
    }
    if (!any) {
        return;
    }
    put_spatial(CFRC, Spatial(vec3f(), vec3f()));
    for (var b = 1u; b < bound(NBODY); b++) {
        let place = XFRC_APPLIED + 6u * b;
        put_spatial(CFRC + 6u * b, force_at_com(b, given3(place), given3(place + 3u)));
    }
    project_forces(QFRC_SMOOTH);
}

fn smooth_acceleration() {
    for (var i = 0u; i < bound(NV); i++) {
        let applied = given(QFRC_APPLIED + i) + fetch(QFRC_ACTUATOR + i);
        put(QFRC_SMOOTH + i, fetch(QFRC_PASSIVE + i) - fetch(QFRC_BIAS + i) + applied);
    }
    applied_wrenches();
    for (var i = 0u; i < bound(NV); i++) {
        put(QACC_SMOOTH + i, fetch(QFRC_SMOOTH + i));
    }
    solve_tree(QACC_SMOOTH);
}

// What depends on velocities and controls: one thread an environment.
@compute @workgroup_size(GROUP)
fn forces(@builtin(global_invocation_id) id: vec3u) {
    if (!begin(id.x)) {
        return;
    }
    body_velocities();
    passive_forces();
    bias_forces();
    actuation();
    smooth_acceleration();
}
