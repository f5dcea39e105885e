// The interval of a line o + t d within a shape, from t.x to t.y; empty if t.x > t.y. CPU counterpart:
// `clench-collide/src/ray/chord.rs`.

// Clips to the unit ball, from the nearest point of the line, since its origin may be far away.
fn within_ball(o: vec3f, d: vec3f) -> vec2f {
    let square = dot(d, d);
    let back = dot(o, d) / max(square, SMALLEST);
    let nearest = o - d * back;
    let rest = 1.0 - dot(nearest, nearest);
    if (rest < 0.0 || square == 0.0) {
        return vec2f(1.0, -1.0);
    }
    return vec2f(-back) + vec2f(-1.0, 1.0) * sqrt(rest / square);
}

// Clips to −half to half along one axis.
fn within_slab(o: f32, d: f32, half: f32) -> vec2f {
    if (d == 0.0) {
        return select(vec2f(1.0, -1.0), vec2f(-1e30, 1e30), abs(o) <= half);
    }
    let ends = (vec2f(-half, half) - o) / d;
    return vec2f(min(ends.x, ends.y), max(ends.x, ends.y));
}

// Clips to the infinite cylinder of a radius around z.
fn within_tube(o: vec3f, d: vec3f, radius: f32) -> vec2f {
    if (dot(d.xy, d.xy) < EPSILON * EPSILON) {
        return select(vec2f(1.0, -1.0), vec2f(-1e30, 1e30), dot(o.xy, o.xy) <= radius * radius);
    }
    return within_ball(vec3f(o.xy, 0.0) / radius, vec3f(d.xy, 0.0) / radius);
}

// Clips to a box.
fn within_box(o: vec3f, d: vec3f, half: vec3f) -> vec2f {
    let level = overlap(within_slab(o.x, d.x, half.x), within_slab(o.y, d.y, half.y));
    return overlap(level, within_slab(o.z, d.z, half.z));
}

// Intersects two intervals.
fn overlap(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(max(a.x, b.x), min(a.y, b.y));
}

// Unites two intervals whose shapes have a convex union.
fn union_of(a: vec2f, b: vec2f) -> vec2f {
    if (b.x > b.y) {
        return a;
    }
    return select(vec2f(min(a.x, b.x), max(a.y, b.y)), b, a.x > a.y);
}

// Clips to a sphere, capsule, ellipsoid, cylinder or box about its own axes; d has unit length.
fn within_shape(kind: u32, size: vec3f, o: vec3f, d: vec3f) -> vec2f {
    switch kind {
        case SPHERE, ELLIPSOID: {
            let semi_axes = select(size, size.xxx, kind == SPHERE);
            return within_ball(o / semi_axes, d / semi_axes);
        }
        case CYLINDER, CAPSULE: {
            var t = overlap(within_tube(o, d, size.x), within_slab(o.z, d.z, size.y));
            for (var end = 0u; end < bound(2u) && kind == CAPSULE; end++) {
                let centre = vec3f(0.0, 0.0, select(size.y, -size.y, end == 1u));
                t = union_of(t, within_ball((o - centre) / size.x, d / size.x));
            }
            return t;
        }
        case BOX: {
            return within_box(o, d, size);
        }
        case PLANE, HEIGHT_FIELD, MESH, default: {
            return vec2f(1.0, -1.0);
        }
    }
}

// Returns true if a ray hits a shape with this interval on its line.
fn is_hit(t: vec2f) -> bool {
    return t.x <= t.y && t.y >= 0.0;
}
