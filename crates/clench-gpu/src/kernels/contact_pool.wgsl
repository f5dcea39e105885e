// The contacts that a thread of the narrow phase finds, pair by pair, in private memory: up to the maximum of an
// environment, and one for each pair whose distance is measured. Frames are those of `clench-collide/src/frame.rs`.

// The start of this thread's memory.
var<private> thread_start: u32;

// Returns the offset of a field of this thread.
fn thread_field(field: u32) -> u32 {
    return thread_start + field;
}

// The number of contacts so far, and before the current pair.
var<private> found: u32;
var<private> first_of_pair: u32;
// True if the capacity was exceeded.
var<private> overflowed: bool;

// Adds a contact of a pair; `tangent` is the first of the two. For a pair limited to one contact, the first of the
// deepest is kept. Contacts of a terrain triangle go to its patch.
fn add_contact(pair: u32, distance: f32, position: vec3f, normal: vec3f, tangent: vec3f) {
    if (ANY_TERRAIN && on_terrain) {
        add_to_patch(TerrainPoint(position, normal, distance));
        return;
    }
    if (found > first_of_pair && words[PAIR_DEEPEST + pair] == 1u) {
        if (distance >= fetch(thread_field(FOUND_CONTACTS) + CONTACT_SIZE * first_of_pair + 1u)) {
            return;
        }
        found = first_of_pair;
    }
    if (found == THREAD_CONTACTS) {
        overflowed = true;
        return;
    }
    let offset = thread_field(FOUND_CONTACTS) + CONTACT_SIZE * found;
    put(offset, f32(pair));
    put(offset + 1u, distance);
    put3(offset + 2u, position);
    put3(offset + 5u, normal);
    put3(offset + 8u, tangent);
    put3(offset + 11u, cross(normal, tangent));
    found++;
}

// Returns the y axis made orthogonal to the normal, or the z axis if the normal is within 60° of y.
fn tangent_from_normal(n: vec3f) -> vec3f {
    let use_y = abs(n.y) < 0.5;
    let start = select(vec3f(0.0, 0.0, 1.0), vec3f(0.0, 1.0, 0.0), use_y);
    let tangent = start - n * select(n.z, n.y, use_y);
    return tangent * (1.0 / length(tangent));
}

// Returns a direction made orthogonal to the normal; the x axis, or y near it, if the two are parallel.
fn tangent_along(n: vec3f, along: vec3f) -> vec3f {
    var tangent = along - n * dot(n, along);
    // Below this length the remainder of the direction is mostly rounding error.
    let least: f32 = 1e4 * EPSILON;
    if (dot(tangent, tangent) < least * least) {
        let other = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(n.x) > 0.9);
        tangent = other - n * dot(n, other);
    }
    return tangent * (1.0 / length(tangent));
}
