// Velocities of bodies, and Coriolis, centrifugal and gravity forces by recursive Newton–Euler. Sisters of
// `dynamics/velocity.rs`, `bias.rs` and `project.rs`.

fn body_velocities() {
    put_spatial(CVEL, Spatial(vec3f(), vec3f()));
    for (var b = 1u; b < bound(NBODY); b++) {
        var cvel = fetch_spatial(CVEL + 6u * words[BODY_PARENT + b]);
        for (var j = words[BODY_JNT + b]; j < words[BODY_JNT + b + 1u]; j++) {
            var i = words[JNT_DOF + j];
            let end = words[JNT_DOF + j + 1u];
            if (words[JNT_KIND + j] == FREE) {
                for (var k = 0u; k < 3u; k++) {
                    put_spatial(CDOF_DOT + 6u * i, Spatial(vec3f(), vec3f()));
                    cvel = plus(cvel, times(fetch_spatial(CDOF + 6u * i), given(QVEL + i)));
                    i++;
                }
            }
            // All axes of a ball move with the frame before it.
            let before = cvel;
            for (; i < end; i++) {
                let axis = fetch_spatial(CDOF + 6u * i);
                put_spatial(CDOF_DOT + 6u * i, cross_motion(before, axis));
                cvel = plus(cvel, times(axis, given(QVEL + i)));
            }
        }
        put_spatial(CVEL + 6u * b, cvel);
    }
}

// Adds Σ J_bᵀ f_b to the dof forces at `qfrc`, for the spatial forces in CFRC, which are used up.
fn project_forces(qfrc: u32) {
    for (var b = NBODY - 1u; b > 0u; b--) {
        let parent = words[BODY_PARENT + b];
        if (parent != 0u) {
            put_spatial(CFRC + 6u * parent, plus(fetch_spatial(CFRC + 6u * parent), fetch_spatial(CFRC + 6u * b)));
        }
    }
    for (var i = 0u; i < bound(NV); i++) {
        add(qfrc + i, spatial_dot(fetch_spatial(CDOF + 6u * i), fetch_spatial(CFRC + 6u * words[DOF_BODY + i])));
    }
}

// The spatial force of a force and a torque at the centre of mass of body `b`.
fn force_at_com(b: u32, force: vec3f, torque: vec3f) -> Spatial {
    let arm = fetch3(XIPOS + 3u * b) - fetch3(SUBTREE_COM + 3u * words[BODY_ROOT + b]);
    return Spatial(torque + cross(arm, force), force);
}

fn clear_dofs(qfrc: u32) {
    for (var i = 0u; i < bound(NV); i++) {
        put(qfrc + i, 0.0);
    }
}

fn bias_forces() {
    put_spatial(CACC_BIAS, Spatial(vec3f(), -parameter3(GRAVITY)));
    put_spatial(CFRC, Spatial(vec3f(), vec3f()));
    for (var b = 1u; b < bound(NBODY); b++) {
        var cacc = fetch_spatial(CACC_BIAS + 6u * words[BODY_PARENT + b]);
        for (var i = words[BODY_DOF + b]; i < words[BODY_DOF + b + 1u]; i++) {
            cacc = plus(cacc, times(fetch_spatial(CDOF_DOT + 6u * i), given(QVEL + i)));
        }
        let cvel = fetch_spatial(CVEL + 6u * b);
        let inertial = momentum(CINERT + 10u * b, cacc);
        put_spatial(CACC_BIAS + 6u * b, cacc);
        put_spatial(CFRC + 6u * b, plus(inertial, cross_force(cvel, momentum(CINERT + 10u * b, cvel))));
    }
    clear_dofs(QFRC_BIAS);
    project_forces(QFRC_BIAS);
}
