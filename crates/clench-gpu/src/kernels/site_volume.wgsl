// Volumes of sites: what is inside, and which rays meet them. Sister of `sensor/volume.rs`; the rays are those of `clench-collide`.

fn is_in_volume(kind: u32, size: vec3f, p: vec3f) -> bool {
    let level = dot(p.xy, p.xy);
    switch kind {
        case SPHERE: {
            return dot(p, p) <= size.x * size.x;
        }
        case CAPSULE: {
            let end = max(abs(p.z) - size.y, 0.0);
            return level + end * end <= size.x * size.x;
        }
        case ELLIPSOID: {
            let scaled = p / size;
            return dot(scaled, scaled) <= 1.0;
        }
        case CYLINDER: {
            return level <= size.x * size.x && abs(p.z) <= size.y;
        }
        case BOX: {
            return all(abs(p) <= size);
        }
        default: {
            return false;
        }
    }
}

// Where a line o + t d is within the unit ball, from t.x to t.y; nowhere where t.x > t.y.
fn within_ball(o: vec3f, d: vec3f) -> vec2f {
    let a = dot(d, d);
    let b = dot(o, d);
    let root = b * b - a * (dot(o, o) - 1.0);
    if (root < 0.0 || a == 0.0) {
        return vec2f(1.0, -1.0);
    }
    return (vec2f(-b) + vec2f(-1.0, 1.0) * sqrt(root)) / a;
}

// Where it is between −half and half along one axis.
fn within_slab(o: f32, d: f32, half: f32) -> vec2f {
    if (d == 0.0) {
        return select(vec2f(1.0, -1.0), vec2f(-1e30, 1e30), abs(o) <= half);
    }
    let ends = (vec2f(-half, half) - o) / d;
    return vec2f(min(ends.x, ends.y), max(ends.x, ends.y));
}

fn is_met(t: vec2f) -> bool {
    return t.x <= t.y && t.y >= 0.0;
}

fn overlap(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(max(a.x, b.x), min(a.y, b.y));
}

// Where it is within the endless cylinder of a radius around z.
fn within_tube(o: vec3f, d: vec3f, radius: f32) -> vec2f {
    if (dot(d.xy, d.xy) == 0.0) {
        return select(vec2f(1.0, -1.0), vec2f(-1e30, 1e30), dot(o.xy, o.xy) <= radius * radius);
    }
    return within_ball(vec3f(o.xy, 0.0) / radius, vec3f(d.xy, 0.0) / radius);
}

// Whether a ray meets a volume.
fn meets_volume(kind: u32, size: vec3f, o: vec3f, d: vec3f) -> bool {
    switch kind {
        case SPHERE: {
            return is_met(within_ball(o / size.x, d / size.x));
        }
        case ELLIPSOID: {
            return is_met(within_ball(o / size, d / size));
        }
        case CYLINDER: {
            return is_met(overlap(within_tube(o, d, size.x), within_slab(o.z, d.z, size.y)));
        }
        case CAPSULE: {
            let end = vec3f(0.0, 0.0, size.y);
            let body = overlap(within_tube(o, d, size.x), within_slab(o.z, d.z, size.y));
            let top = within_ball((o - end) / size.x, d / size.x);
            let bottom = within_ball((o + end) / size.x, d / size.x);
            return is_met(body) || is_met(top) || is_met(bottom);
        }
        case BOX: {
            let level = overlap(within_slab(o.x, d.x, size.x), within_slab(o.y, d.y, size.y));
            return is_met(overlap(level, within_slab(o.z, d.z, size.z)));
        }
        default: {
            return false;
        }
    }
}
