// Velocity derivatives of the medium's forces, in the pattern of the mass matrix: added, times −h, to QLD. The metric
// has those of drag alone. CPU counterpart: `dynamics/derivatives.rs`.

// Returns the change of the resistance of the medium, axis by axis, for a change `dv` of the velocity `v`.
fn resistance_change(viscous: vec3f, quadratic: vec3f, v: vec3f, dv: vec3f) -> vec3f {
    return -(viscous + 2.0 * quadratic * abs(v)) * dv;
}

// Adds the power, along each dof of the path to dof i, of the derivative of a body's force with respect to that dof. In
// the metric, the part of a body with a diagonal mass matrix is diagonal too, as in MuJoCo.
fn add_along_path(b: u32, i: u32, change: Spatial) {
    let end = words[TREE_START + i + 1u];
    let is_diagonal = IN_METRIC && words[BODY_ALONE + b] == 1u;
    for (var p = select(words[TREE_START + i], end - 1u, is_diagonal); p < end; p++) {
        add(QLD + p, -TIMESTEP * spatial_dot(fetch_spatial(CDOF + 6u * words[TREE_DOF + p]), change));
    }
}

// Adds the medium's effect on ellipsoids: only the symmetric part of their forces.
fn add_fluid_on_ellipsoids(b: u32) {
    for (var i = 0u; i < bound(NV); i++) {
        if (moves(b, i)) {
            add_along_path(b, i, rate_along(b, fetch_spatial(CDOF + 6u * i), 1.0));
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
        add_along_path(b, i, Spatial(torque + cross(offset_of(b, at), force), force));
    }
}

fn add_fluid_derivatives() {
    if (HAS_FLUID && ANY_FLUID_ELLIPSOID) {
        ellipsoid_rates();
    }
    for (var b = 1u; HAS_FLUID && b < NBODY; b++) {
        if (has_ellipsoids(b)) {
            add_fluid_on_ellipsoids(b);
        } else {
            add_fluid(b);
        }
    }
}
