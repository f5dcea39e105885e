// The acceleration that all forces but constraints cause. Sister of `dynamics/smooth.rs`.

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
    if (ANY_ON_CONTACTS) {
        adhesion();
    }
    body_velocities();
    tendon_velocities();
    passive_forces();
    bias_forces();
    if (HEAVY_TENDONS) {
        tendon_bias();
    }
    actuation();
    smooth_acceleration();
    note_end();
}
