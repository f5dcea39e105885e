// The acceleration due to all forces except constraints. CPU counterpart: `dynamics/smooth.rs`.

// Returns the force on dof i due to user forces on bodies at their centres of mass.
fn applied_to_bodies(i: u32) -> f32 {
    var sum: f32 = 0.0;
    for (var b = words[DOF_BODY + i]; b < bound(NBODY); b++) {
        let force = fetch_state3(XFRC_APPLIED + 6u * b);
        let torque = fetch_state3(XFRC_APPLIED + 6u * b + 3u);
        if (moves(b, i) && (any(force != vec3f()) || any(torque != vec3f()))) {
            sum += spatial_dot(fetch_spatial(CDOF + 6u * i), force_at_com(b, force, torque));
        }
    }
    return sum;
}

// Returns true if the user applies any force to bodies.
fn any_applied_to_bodies() -> bool {
    var any_applied: f32 = 0.0;
    for (var k = 6u + member; k < bound(6u * NBODY); k += TEAM) {
        let applied = fetch_state(XFRC_APPLIED + k);
        any_applied = select(any_applied, 1.0, applied != 0.0);
    }
    return least_of_team(select(1u, 0u, any_applied > 0.0)) == 0u;
}

fn smooth_acceleration() {
    let any_applied = any_applied_to_bodies();
    for (var i = member; i < bound(NV); i += TEAM) {
        let applied = fetch_state(QFRC_APPLIED + i) + fetch(QFRC_ACTUATOR + i);
        var force = fetch(QFRC_PASSIVE + i) - fetch(QFRC_BIAS + i) + applied;
        if (any_applied) {
            force += applied_to_bodies(i);
        }
        put(QFRC_SMOOTH + i, force);
        put(QACC_SMOOTH + i, force);
    }
    // `metric.wgsl` solves in the metric.
    if (!IN_METRIC) {
        solve_tree(QACC_SMOOTH);
    }
}

// Runs everything that depends on velocities and controls. One team per environment.
@compute @workgroup_size(GROUP, TEAM)
fn forces(@builtin(global_invocation_id) id: vec3u) {
    begin_in_team(id);
    if (ANY_ON_CONTACTS) {
        adhesion();
    }
    velocities_and_bias();
    if (NTENDON > 0u) {
        tendon_velocities();
        join();
    }
    passive_forces();
    if (HEAVY_TENDONS) {
        tendon_bias();
    }
    actuation();
    smooth_acceleration();
    end_in_team();
}
