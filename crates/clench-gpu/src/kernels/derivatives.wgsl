// Velocity derivatives of smooth forces, in the pattern of the mass matrix: added, times −h, to QLD. CPU counterpart:
// `dynamics/derivatives.rs`.

fn add_actuators() {
    for (var u = 0u; ACTUATION && u < NU; u++) {
        let scale = -TIMESTEP * velocity_slope(u);
        for (var o = output_of(u); o < output_of(u + 1u); o++) {
            add_outer(QLD, ACTUATOR_DOF, ACTUATOR_MOMENT, words[ACTUATOR_ROW + o], words[ACTUATOR_ROW + o + 1u], scale);
        }
    }
}

fn add_dampers() {
    for (var i = 0u; i < bound(NV); i++) {
        let slope = damping_slope(DOF_DAMPER + 3u * i, fetch_state(QVEL + i));
        add(QLD + words[TREE_START + i + 1u] - 1u, TIMESTEP * slope);
    }
    for (var t = 0u; t < NTENDON; t++) {
        let scale = TIMESTEP * damping_slope(TENDON_DAMPER + 3u * t, fetch(TEN_VELOCITY + t));
        add_outer(QLD, TENDON_DOF, TEN_JACOBIAN, words[TENDON_ROW + t], words[TENDON_ROW + t + 1u], scale);
    }
}

// Returns the change of the resistance of the medium, axis by axis, for a change `dv` of the velocity `v`.
fn resistance_change(viscous: vec3f, quadratic: vec3f, v: vec3f, dv: vec3f) -> vec3f {
    return -(viscous + 2.0 * quadratic * abs(v)) * dv;
}

// Adds the power, along each dof of the path to dof i, of the derivative of a body's force with respect to that dof.
fn add_along_path(i: u32, change: Spatial) {
    for (var p = words[TREE_START + i]; p < words[TREE_START + i + 1u]; p++) {
        add(QLD + p, -TIMESTEP * spatial_dot(fetch_spatial(CDOF + 6u * words[TREE_DOF + p]), change));
    }
}

// Adds the medium's effect on ellipsoids: only the symmetric part of their forces.
fn add_fluid_on_ellipsoids(b: u32) {
    for (var i = 0u; i < bound(NV); i++) {
        if (moves(b, i)) {
            add_along_path(i, rate_along(b, fetch_spatial(CDOF + 6u * i), 1.0));
        }
    }
}

// Adds its effect on boxes: entry (i, j) is the power, along dof j, of the resistance's derivative by dof i.
fn add_fluid(b: u32) {
    let axes = fetch_matrix(XIMAT + 9u * b);
    let back = transpose(axes);
    let at = fetch3(XIPOS + 3u * b);
    let velocity = velocity_at(b, at);
    let angular = back * velocity.angular;
    let linear = back * (velocity.linear - parameter3(WIND));
    let drag = BODY_DRAG + 12u * b;
    for (var i = 0u; i < bound(NV); i++) {
        if (!moves(b, i)) {
            continue;
        }
        let motion = motion_at(b, i, at);
        let torque = axes * resistance_change(parameter3(drag), parameter3(drag + 6u), angular, back * motion.angular);
        let force = axes * resistance_change(parameter3(drag + 3u), parameter3(drag + 9u), linear, back * motion.linear);
        add_along_path(i, Spatial(torque + cross(offset_of(b, at), force), force));
    }
}

fn add_velocity_derivatives() {
    if (HAS_FLUID && ANY_FLUID_ELLIPSOID) {
        ellipsoid_rates();
    }
    add_actuators();
    add_dampers();
    for (var b = 1u; HAS_FLUID && b < NBODY; b++) {
        if (has_ellipsoids(b)) {
            add_fluid_on_ellipsoids(b);
        } else {
            add_fluid(b);
        }
    }
}

// Computes M − h D, without Coriolis forces, in QLD, and the sum of all forces in RATE. The terms share entries, so one
// thread adds them.
fn symmetric_inertia() {
    for (var p = member; p < bound(NNZ); p += TEAM) {
        put(QLD + p, fetch(QM + p));
    }
    for (var i = member; i < bound(NV); i += TEAM) {
        put(RATE + i, fetch(QFRC_SMOOTH + i) + fetch(QFRC_CONSTRAINT + i));
    }
    join();
    if (is_first()) {
        add_velocity_derivatives();
    }
    join();
}
