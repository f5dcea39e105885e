// Tactile skins: one thread per vertex, on request. CPU counterpart: `sensor/tactile.rs`, which explains the depths. A
// skin is a row of SKIN_SIZE words.

fn box_distance(size: vec3f, point: vec3f) -> f32 {
    let beyond = abs(point) - size;
    if (max(beyond.x, max(beyond.y, beyond.z)) >= 0.0) {
        return length(max(beyond, vec3f()));
    }
    let field = size / beyond;
    let steps = -beyond / abs(field / length(field));
    return -min(steps.x, min(steps.y, steps.z));
}

// Returns the signed distance function of a shape at a point of its frame, negative inside; shapes without one have no
// inside.
fn signed_distance(kind: u32, size: vec3f, point: vec3f) -> f32 {
    switch kind {
        case PLANE: {
            return point.z;
        }
        case SPHERE: {
            return length(point) - size.x;
        }
        case CAPSULE: {
            let height = point.z - clamp(point.z, -size.y, size.y);
            return length(vec3f(point.xy, height)) - size.x;
        }
        case ELLIPSOID: {
            let scaled = point / size;
            let norm = length(scaled);
            return norm * (norm - 1.0) / length(scaled / size);
        }
        case CYLINDER: {
            let outside = vec2f(length(point.xy) - size.x, abs(point.z) - size.y);
            return min(max(outside.x, outside.y), 0.0) + length(max(outside, vec2f()));
        }
        case BOX: {
            return box_distance(size, point);
        }
        case MESH, HEIGHT_FIELD, default: {
            return 1.0;
        }
    }
}

// Returns the first geom from `next` on that touches a body welded to `body`; NONE if there is none.
fn next_touched(body: u32, next: u32) -> u32 {
    var least = NONE;
    for (var c = 0u; c < reports[NCON * envs + env]; c++) {
        let pair = u32(fetch(CONTACTS + CONTACT_SIZE * c));
        for (var side = 0u; side < 2u; side++) {
            let own = words[BODY_WELD + words[PAIR_BODY + 2u * pair + side]];
            let other = words[PAIR_GEOM + 2u * pair + 1u - side];
            if (own == body && other >= next) {
                least = min(least, other);
            }
        }
    }
    return least;
}

// Writes the depth of a vertex, and its sliding speeds along both tangents.
fn read_taxel(s: u32, k: u32) {
    let geom = words[s + SKIN_GEOM];
    let body = words[GEOM_BODY + geom];
    let axes = fetch_matrix(GEOM_XMAT + 9u * geom);
    let point = fetch3(GEOM_XPOS + 3u * geom) + axes * shape3(words[s + SKIN_POINTS] + 3u * k);
    var depth: f32 = 0.0;
    var speeds = vec2f();
    var other = next_touched(words[BODY_WELD + body], 0u);
    while (other != NONE) {
        let local = (point - fetch3(GEOM_XPOS + 3u * other)) * fetch_matrix(GEOM_XMAT + 9u * other);
        let distance = signed_distance(words[GEOM_KIND + other], parameter3(GEOM_SIZE + 3u * other), local);
        if (distance < 0.0) {
            depth = max(depth, -distance);
            if (k < words[s + SKIN_TANGENT_COUNT]) {
                let sliding = velocity_at(body, point).linear - velocity_at(words[GEOM_BODY + other], point).linear;
                let tangents = words[s + SKIN_TANGENTS] + 6u * k;
                speeds += vec2f(abs(dot(sliding, axes * shape3(tangents))), abs(dot(sliding, axes * shape3(tangents + 3u))));
            }
        }
        other = next_touched(words[BODY_WELD + body], other + 1u);
    }
    let out = SENSORDATA + words[s + SKIN_OFFSET] + k;
    put(out, depth);
    put(out + words[s + SKIN_COUNT], speeds.x);
    put(out + 2u * words[s + SKIN_COUNT], speeds.y);
}

// Adjacent threads have neighbouring environments and the same vertex.
@compute @workgroup_size(GROUP)
fn skins(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    if (!SENSING || !begin(id.x)) {
        return;
    }
    for (var taxel = id.y; taxel < NTAXEL; taxel += groups.y) {
        let s = SKINS + SKIN_SIZE * words[TAXEL_SKIN + taxel];
        read_taxel(s, taxel - words[s + SKIN_FIRST]);
    }
    check_loops();
}
