// Which pairs touch, and where. Sister of `contact/detect.rs` and `bounding_sphere.rs`: the pairs of the model, listed once, in
// canonical order.

// A geom where it is.
struct Placed {
    center: vec3f,
    axes: mat3x3f,
    size: vec3f,
}

fn placed(geom: u32) -> Placed {
    return Placed(fetch3(GEOM_XPOS + 3u * geom), fetch_matrix(GEOM_XMAT + 9u * geom), number3(GEOM_SIZE + 3u * geom));
}

// Whether the bounding spheres of a pair meet; a plane has none.
fn may_touch(pair: u32, a: u32, b: u32) -> bool {
    let reach = numbers[PAIR_REACH + pair];
    let offset = fetch3(GEOM_XPOS + 3u * b) - fetch3(GEOM_XPOS + 3u * a);
    if (words[GEOM_KIND + a] == PLANE) {
        let place = GEOM_XMAT + 9u * a;
        let normal = vec3f(fetch(place + 2u), fetch(place + 5u), fetch(place + 8u));
        return dot(normal, offset) <= reach;
    }
    return dot(offset, offset) <= reach * max(reach, 0.0);
}

fn on_plane(pair: u32, plane: Placed, b: Placed, kind: u32, range: f32) {
    let normal = plane.axes[2];
    let above = dot(normal, b.center - plane.center);
    if (kind == SPHERE) {
        plane_sphere(pair, normal, above, b.center, b.size, range);
    } else if (kind == CAPSULE) {
        plane_capsule(pair, normal, above, b.center, b.axes[2], b.size, range);
    } else if (kind == ELLIPSOID) {
        plane_ellipsoid(pair, normal, above, b.center, b.axes, b.size, range);
    } else {
        plane_box(pair, normal, above, b.center, b.axes, b.size, range);
    }
}

fn collide(pair: u32, a: u32, b: u32) {
    let first = placed(a);
    let second = placed(b);
    let kind = words[GEOM_KIND + b];
    let range = numbers[PAIR_RANGE + pair];
    if (words[GEOM_KIND + a] == PLANE) {
        on_plane(pair, first, second, kind, range);
    } else if (words[GEOM_KIND + a] == CAPSULE) {
        capsule_capsule(pair, first, second, range);
    } else if (kind == CAPSULE) {
        sphere_capsule(pair, first, second, range);
    } else {
        sphere_sphere(pair, first, second, range);
    }
}

// One thread an environment.
@compute @workgroup_size(GROUP)
fn contacts(@builtin(global_invocation_id) id: vec3u) {
    if (!begin(id.x)) {
        return;
    }
    found = 0u;
    for (var pair = 0u; pair < NPAIR; pair++) {
        let a = words[PAIR_GEOM + 2u * pair];
        let b = words[PAIR_GEOM + 2u * pair + 1u];
        if (may_touch(pair, a, b)) {
            collide(pair, a, b);
        }
    }
    reports[NCON * N + env] = found;
}
