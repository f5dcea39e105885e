// Which pairs touch, and where. Sister of `contact/detect.rs` and `bounding_sphere.rs`: the pairs of the model, listed once, in
// canonical order.

// A geom where it is.
struct Placed {
    center: vec3f,
    axes: mat3x3f,
    size: vec3f,
}

fn placed(geom: u32) -> Placed {
    return Placed(fetch3(GEOM_XPOS + 3u * geom), fetch_matrix(GEOM_XMAT + 9u * geom), parameter3(GEOM_SIZE + 3u * geom));
}

// Whether the bounding spheres of a pair meet; a plane has none.
fn may_touch(pair: u32, a: u32, b: u32) -> bool {
    let reach = parameter(PAIR_REACH + pair);
    let offset = fetch3(GEOM_XPOS + 3u * b) - fetch3(GEOM_XPOS + 3u * a);
    if (words[GEOM_KIND + a] == PLANE) {
        let place = GEOM_XMAT + 9u * a;
        let normal = vec3f(fetch(place + 2u), fetch(place + 5u), fetch(place + 8u));
        return dot(normal, offset) <= reach;
    }
    return dot(offset, offset) <= reach * max(reach, 0.0);
}

// The first pair from one on whose bounding spheres meet; NPAIR if there is none. A loop of its own: threads side by side, each at a pair of its
// environment, look for contacts together, and none waits while another does.
fn first_that_may_touch(start: u32) -> u32 {
    var pair = start;
    while (pair < NPAIR && !may_touch(pair, words[PAIR_GEOM + 2u * pair], words[PAIR_GEOM + 2u * pair + 1u])) {
        pair++;
    }
    return pair;
}

fn on_plane(pair: u32, plane: Placed, b: Placed, geom: u32, range: f32) {
    let kind = words[GEOM_KIND + geom];
    let normal = plane.axes[2];
    let above = dot(normal, b.center - plane.center);
    if (MESH_ON_PLANE && kind == MESH) {
        plane_mesh(pair, normal, above, b, words[GEOM_HULL + geom], range);
    } else if (kind == SPHERE) {
        plane_sphere(pair, normal, above, b.center, b.size, range);
    } else if (kind == CAPSULE) {
        plane_capsule(pair, normal, above, b.center, b.axes[2], b.size, range);
    } else if (kind == ELLIPSOID) {
        plane_ellipsoid(pair, normal, above, b.center, b.axes, b.size, range);
    } else if (kind == CYLINDER) {
        plane_cylinder(pair, normal, above, b.center, b.axes, b.size, range);
    } else {
        plane_box(pair, normal, above, b.center, b.axes, b.size, range);
    }
}

// Methods that no pair of the model needs are left out. Drivers put the text of a function wherever it is called: hence one call of
// the general one.
fn collide(pair: u32, a: u32, b: u32) {
    let first = placed(a);
    let second = placed(b);
    let range = parameter(PAIR_RANGE + pair);
    let method = words[PAIR_METHOD + pair];
    var rest = FOUND;
    if (ANY_ON_PLANE && method == ON_PLANE) {
        on_plane(pair, first, second, b, range);
    } else if (ANY_SPHERE_SPHERE && method == SPHERE_SPHERE) {
        sphere_sphere(pair, first, second, range);
    } else if (ANY_SPHERE_CAPSULE && method == SPHERE_CAPSULE) {
        sphere_capsule(pair, first, second, range);
    } else if (ANY_SPHERE_CYLINDER && method == SPHERE_CYLINDER) {
        sphere_cylinder(pair, first, second, range);
    } else if (ANY_SPHERE_BOX && method == SPHERE_BOX) {
        sphere_box(pair, first, second, range);
    } else if (ANY_CAPSULE_CAPSULE && method == CAPSULE_CAPSULE) {
        capsule_capsule(pair, first, second, range);
    } else if (ANY_CAPSULE_CYLINDER && method == CAPSULE_CYLINDER) {
        capsule_cylinder(pair, first, second, range);
    } else if (ANY_CAPSULE_BOX && method == CAPSULE_BOX) {
        rest = select(AS_CONVEX, FOUND, capsule_box(pair, first, second, range));
    } else if (ANY_BOX_BOX && method == BOX_BOX) {
        rest = box_box(pair, first, second, range);
    } else {
        rest = AS_CONVEX;
    }
    if (ANY_CONVEX && rest != FOUND) {
        convex(pair, first, second, rest == ALONG_BEST, range);
    }
}

// One thread an environment.
@compute @workgroup_size(GROUP)
fn contacts(@builtin(global_invocation_id) id: vec3u) {
    if (!begin(id.x)) {
        return;
    }
    found = 0u;
    var pair = first_that_may_touch(0u);
    while (pair < NPAIR) {
        first_of_pair = found;
        collide(pair, words[PAIR_GEOM + 2u * pair], words[PAIR_GEOM + 2u * pair + 1u]);
        pair = first_that_may_touch(pair + 1u);
    }
    reports[NCON * envs + env] = found;
    note_end();
}
