// Centres of mass, spatial inertias and dof axes about them. CPU counterpart: `dynamics/com.rs`.

// Sums mass times position over each body and its descendants, from the leaves up; then divides by the mass.
fn subtree_com() {
    for (var level = NBODY_LEVEL; level > 0u; level--) {
        for (var n = words[BODY_LEVEL + level - 1u] + member; n < words[BODY_LEVEL + level]; n += TEAM) {
            let b = words[LEVEL_BODY + n];
            var sum = fetch3(XIPOS + 3u * b) * parameter(BODY_MASS + b);
            for (var k = words[BODY_CHILD + b]; k < words[BODY_CHILD + b + 1u]; k++) {
                sum += fetch3(SUBTREE_COM + 3u * words[CHILD_BODY + k]);
            }
            put3(SUBTREE_COM + 3u * b, sum);
        }
        join();
    }
    for (var b = member; b < bound(NBODY); b += TEAM) {
        let mass = parameter(BODY_SUBTREEMASS + b);
        var com = fetch3(XIPOS + 3u * b);
        if (mass >= TINY) {
            com = fetch3(SUBTREE_COM + 3u * b) * (1.0 / mass);
        }
        put3(SUBTREE_COM + 3u * b, com);
    }
    join();
}

// Computes the inertia of a body about the centre of mass of its tree.
fn body_inertia(b: u32) {
    let axes = fetch_matrix(XIMAT + 9u * b);
    let diagonal = parameter3(BODY_INERTIA + 3u * b);
    let mass = parameter(BODY_MASS + b);
    let o = fetch3(XIPOS + 3u * b) - fetch3(SUBTREE_COM + 3u * words[BODY_ROOT + b]);
    let r = transpose(axes);
    let x = r[0] * diagonal;
    let y = r[1] * diagonal;
    let z = r[2] * diagonal;
    put(CINERT + 10u * b, dot(x, r[0]) + mass * (o.y * o.y + o.z * o.z));
    put(CINERT + 10u * b + 1u, dot(y, r[1]) + mass * (o.x * o.x + o.z * o.z));
    put(CINERT + 10u * b + 2u, dot(z, r[2]) + mass * (o.x * o.x + o.y * o.y));
    put(CINERT + 10u * b + 3u, dot(x, r[1]) - mass * o.x * o.y);
    put(CINERT + 10u * b + 4u, dot(x, r[2]) - mass * o.x * o.z);
    put(CINERT + 10u * b + 5u, dot(y, r[2]) - mass * o.y * o.z);
    put3(CINERT + 10u * b + 6u, o * mass);
    put(CINERT + 10u * b + 9u, mass);
}

// Computes the spatial motion of each dof of a joint at unit velocity.
fn dof_axes(j: u32) {
    let body = words[JNT_BODY + j];
    let kind = words[JNT_KIND + j];
    var start = CDOF + 6u * words[JNT_DOF + j];
    let offset = fetch3(SUBTREE_COM + 3u * words[BODY_ROOT + body]) - fetch3(XANCHOR + 3u * j);
    let axis = fetch3(XAXIS + 3u * j);
    if (kind == SLIDE) {
        put_spatial(start, Spatial(vec3f(), axis));
        return;
    }
    if (kind == HINGE) {
        put_spatial(start, Spatial(axis, cross(axis, offset)));
        return;
    }
    if (kind == FREE) {
        put_spatial(start, Spatial(vec3f(), vec3f(1.0, 0.0, 0.0)));
        put_spatial(start + 6u, Spatial(vec3f(), vec3f(0.0, 1.0, 0.0)));
        put_spatial(start + 12u, Spatial(vec3f(), vec3f(0.0, 0.0, 1.0)));
        start += 18u;
    }
    let xmat = fetch_matrix(XMAT + 9u * body);
    for (var k = 0u; k < 3u; k++) {
        put_spatial(start + 6u * k, Spatial(xmat[k], cross(xmat[k], offset)));
    }
}

fn com_positions() {
    subtree_com();
    for (var b = member; b < bound(NBODY); b += TEAM) {
        body_inertia(b);
    }
    for (var j = member; j < bound(NJNT); j += TEAM) {
        dof_axes(j);
    }
    join();
}
