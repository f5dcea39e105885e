// The contacts of near pairs. CPU counterpart: `contact/detect.rs`.

// A geom with its pose.
struct Placed {
    center: vec3f,
    axes: mat3x3f,
    size: vec3f,
}

fn placed(geom: u32) -> Placed {
    return Placed(fetch3(GEOM_XPOS + 3u * geom), fetch_matrix(GEOM_XMAT + 9u * geom), parameter3(GEOM_SIZE + 3u * geom));
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

// Finds the contacts of a pair. Methods that no pair of the model needs are omitted. Drivers inline a function at every
// call site: hence one call of the general one.
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

// NTHREAD threads per environment, among which its near pairs are distributed by method: adjacent threads, of different
// environments, mostly use the same method.
@compute @workgroup_size(GROUP)
fn narrow_phase(@builtin(global_invocation_id) id: vec3u) {
    if (!begin(id.x)) {
        return;
    }
    let thread = id.y;
    thread_start = THREADS + THREAD_SIZE * thread;
    found = 0u;
    overflowed = false;
    let count = reports[NNEAR * envs + env];
    for (var rotation = thread; rotation < count; rotation += NTHREAD) {
        let offset = (NEAR_PAIRS + reports[(NEAR_BY_METHOD + rotation) * envs + env]) * envs + env;
        let pair = reports[offset];
        first_of_pair = found;
        collide(pair, words[PAIR_GEOM + 2u * pair], words[PAIR_GEOM + 2u * pair + 1u]);
        reports[offset] = contacts_of_pair(thread * THREAD_CONTACTS + first_of_pair, found - first_of_pair);
    }
    var fault = RUNNING;
    if (!loops_end()) {
        fault = UNFINISHED;
    } else if (overflowed) {
        fault = CONTACT_OVERFLOW;
    }
    reports[(THREAD_FAULT + thread) * envs + env] = fault;
}
