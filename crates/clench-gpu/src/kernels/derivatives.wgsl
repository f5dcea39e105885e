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

fn add_velocity_derivatives() {
    add_actuators();
    add_fluid_derivatives();
    add_dampers();
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
