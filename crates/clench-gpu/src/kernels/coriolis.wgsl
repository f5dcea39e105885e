// Velocity derivatives of bias forces, in the pattern of the mass matrix, not symmetric. CPU counterpart:
// `dynamics/coriolis.rs`, which derives them.

// Writes the columns of B of a body: the derivative of its force with respect to each component of a motion.
fn write_body_rates(b: u32) {
    let cvel = fetch_spatial(CVEL + 6u * b);
    let carried = momentum(CINERT + 10u * b, cvel);
    for (var c = 0u; c < bound(6u); c++) {
        let x = motion_component(c);
        var column = plus(momentum(CINERT + 10u * b, cross_motion(x, cvel)), cross_force(x, carried));
        column = plus(column, cross_force(cvel, momentum(CINERT + 10u * b, x)));
        if (HAS_FLUID && has_ellipsoids(b)) {
            column = plus(column, times(rate_part(b, c, -1.0), -1.0));
        }
        put_spatial(CORIOLIS_RATES + 36u * b + 6u * c, column);
    }
}

// Sums B over each body and its descendants.
fn sum_rates() {
    for (var b = 0u; b < bound(NBODY); b++) {
        write_body_rates(b);
    }
    for (var b = NBODY - 1u; b > 0u; b--) {
        let parent = words[BODY_PARENT + b];
        for (var k = 0u; parent != 0u && k < 36u; k++) {
            add(CORIOLIS_RATES + 36u * parent + k, fetch(CORIOLIS_RATES + 36u * b + k));
        }
    }
}

// Writes ṡ − s × u of each dof. The axes of a ball joint rotate with the whole joint, as do those of a free joint's
// rotations.
fn drifts() {
    for (var b = 1u; b < bound(NBODY); b++) {
        var carried = fetch_spatial(CVEL + 6u * words[BODY_PARENT + b]);
        for (var j = words[BODY_JNT + b]; j < words[BODY_JNT + b + 1u]; j++) {
            let start = words[JNT_DOF + j];
            let end = words[JNT_DOF + j + 1u];
            let rotations = start + select(0u, 3u, words[JNT_KIND + j] == FREE);
            for (var part = 0u; part < bound(2u); part++) {
                let first = select(start, rotations, part == 1u);
                let last = select(rotations, end, part == 1u);
                for (var i = first; i < last; i++) {
                    carried = plus(carried, times(fetch_spatial(CDOF + 6u * i), fetch_state(QVEL + i)));
                }
                for (var i = first; i < last; i++) {
                    let swept = cross_motion(fetch_spatial(CDOF + 6u * i), carried);
                    put_spatial(CORIOLIS_DRIFT + 6u * i, plus(fetch_spatial(CDOF_DOT + 6u * i), times(swept, -1.0)));
                }
            }
        }
    }
}

// Adds h ∂(bias − fluid)/∂v to the matrix in QLD and QLD_UPPER; of the fluid forces only the skew-symmetric part.
fn add_bias_derivatives() {
    sum_rates();
    drifts();
    for (var i = 0u; i < bound(NV); i++) {
        let b = words[DOF_BODY + i];
        let axis = fetch_spatial(CDOF + 6u * i);
        let carried = momentum(CRB + 10u * b, axis);
        // The derivative of the force below i with respect to dof i, and the force along i for each component of
        // another's axis.
        var change = momentum(CRB + 10u * b, fetch_spatial(CORIOLIS_DRIFT + 6u * i));
        var along = Spatial(vec3f(), vec3f());
        for (var c = 0u; c < bound(3u); c++) {
            let turning = fetch_spatial(CORIOLIS_RATES + 36u * b + 6u * c);
            let moving = fetch_spatial(CORIOLIS_RATES + 36u * b + 6u * c + 18u);
            change = plus(change, plus(times(turning, axis.angular[c]), times(moving, axis.linear[c])));
            along.angular[c] = spatial_dot(axis, turning);
            along.linear[c] = spatial_dot(axis, moving);
        }
        for (var p = words[TREE_START + i]; p < words[TREE_START + i + 1u]; p++) {
            let j = words[TREE_DOF + p];
            let other = fetch_spatial(CDOF + 6u * j);
            let entry = spatial_dot(fetch_spatial(CORIOLIS_DRIFT + 6u * j), carried) + spatial_dot(other, along);
            add(QLD + p, TIMESTEP * entry);
            add(QLD_UPPER + p, TIMESTEP * spatial_dot(other, change));
        }
    }
}
