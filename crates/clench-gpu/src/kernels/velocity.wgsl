// Velocities of bodies and tendons, and Coriolis, centrifugal and gravity forces by recursive Newton–Euler. CPU
// counterparts: `dynamics/velocity.rs`, `bias.rs` and `project.rs`.

// Computes the velocity of a body, its bias acceleration, and the force for that, in CFRC.
fn velocity_and_bias(b: u32) {
    let parent = words[BODY_PARENT + b];
    var cvel = fetch_spatial(CVEL + 6u * parent);
    var cacc = fetch_spatial(CACC_BIAS + 6u * parent);
    for (var j = words[BODY_JNT + b]; j < words[BODY_JNT + b + 1u]; j++) {
        var i = words[JNT_DOF + j];
        let end = words[JNT_DOF + j + 1u];
        if (words[JNT_KIND + j] == FREE) {
            for (var k = 0u; k < 3u; k++) {
                put_spatial(CDOF_DOT + 6u * i, Spatial(vec3f(), vec3f()));
                cvel = plus(cvel, times(fetch_spatial(CDOF + 6u * i), fetch_state(QVEL + i)));
                i++;
            }
        }
        // All axes of a ball move with the frame before it.
        let before = cvel;
        for (; i < end; i++) {
            let axis = fetch_spatial(CDOF + 6u * i);
            let v = fetch_state(QVEL + i);
            let rate = cross_motion(before, axis);
            put_spatial(CDOF_DOT + 6u * i, rate);
            cvel = plus(cvel, times(axis, v));
            cacc = plus(cacc, times(rate, v));
        }
    }
    put_spatial(CVEL + 6u * b, cvel);
    put_spatial(CACC_BIAS + 6u * b, cacc);
    let inertial = momentum(CINERT + 10u * b, cacc);
    put_spatial(CFRC + 6u * b, plus(inertial, cross_force(cvel, momentum(CINERT + 10u * b, cvel))));
}

fn velocities_and_bias() {
    if (is_first()) {
        put_spatial(CVEL, Spatial(vec3f(), vec3f()));
        put_spatial(CACC_BIAS, Spatial(vec3f(), -parameter3(GRAVITY)));
        put_spatial(CFRC, Spatial(vec3f(), vec3f()));
    }
    join();
    for (var level = 1u; level < bound(NBODY_LEVEL); level++) {
        for (var n = words[BODY_LEVEL + level] + member; n < words[BODY_LEVEL + level + 1u]; n += TEAM) {
            velocity_and_bias(words[LEVEL_BODY + n]);
        }
        join();
    }
    clear_dofs(QFRC_BIAS);
    project_forces(QFRC_BIAS);
}

// Adds Σ J_bᵀ f_b to the dof forces at `qfrc`, for the spatial forces in CFRC, which it overwrites.
fn project_forces(qfrc: u32) {
    for (var level = NBODY_LEVEL; level > 1u; level--) {
        for (var n = words[BODY_LEVEL + level - 1u] + member; n < words[BODY_LEVEL + level]; n += TEAM) {
            let b = words[LEVEL_BODY + n];
            var force = fetch_spatial(CFRC + 6u * b);
            for (var k = words[BODY_CHILD + b]; k < words[BODY_CHILD + b + 1u]; k++) {
                force = plus(force, fetch_spatial(CFRC + 6u * words[CHILD_BODY + k]));
            }
            put_spatial(CFRC + 6u * b, force);
        }
        join();
    }
    for (var i = member; i < bound(NV); i += TEAM) {
        add(qfrc + i, spatial_dot(fetch_spatial(CDOF + 6u * i), fetch_spatial(CFRC + 6u * words[DOF_BODY + i])));
    }
    join();
}

// Returns the spatial force of a force and a torque at the centre of mass of body `b`.
fn force_at_com(b: u32, force: vec3f, torque: vec3f) -> Spatial {
    let arm = fetch3(XIPOS + 3u * b) - fetch3(SUBTREE_COM + 3u * words[BODY_ROOT + b]);
    return Spatial(torque + cross(arm, force), force);
}

fn clear_dofs(qfrc: u32) {
    for (var i = member; i < bound(NV); i += TEAM) {
        put(qfrc + i, 0.0);
    }
}

fn tendon_velocities() {
    for (var t = member; t < NTENDON; t += TEAM) {
        var velocity: f32 = 0.0;
        for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
            velocity += fetch(TEN_JACOBIAN + k) * fetch_state(QVEL + words[TENDON_DOF + k]);
        }
        put(TEN_VELOCITY + t, velocity);
    }
}
