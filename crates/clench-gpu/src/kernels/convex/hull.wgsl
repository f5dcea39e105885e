// Hulls of meshes: the furthest vertex, and the part that lies against a plane. CPU counterparts:
// `clench-collide/src/hull/mod.rs` and `clench-collide/src/shape/mesh.rs`. A hull is the offset in the words of its
// parts' offsets.

// Returns a hull's vertex.
fn vertex_of_hull(hull: u32, vertex: u32) -> vec3f {
    return shape3(words[hull + HULL_VERTICES] + 3u * vertex);
}

// Returns the outward normal of a face and, in w, the offset of its plane along it.
fn plane_of_hull(hull: u32, face: u32) -> vec4f {
    return shape4(words[hull + HULL_PLANES] + 4u * face);
}

// Returns the index of the vertex furthest along `d`, by hill climbing from a vertex chosen by the signs of `d`.
fn furthest_of_hull(hull: u32, d: vec3f) -> u32 {
    let neighbors = words[hull + HULL_NEIGHBORS];
    let octant = select(0u, 1u, d.x < 0.0) | select(0u, 2u, d.y < 0.0) | select(0u, 4u, d.z < 0.0);
    var vertex = words[hull + HULL_SIZE + octant];
    var reach = dot(vertex_of_hull(hull, vertex), d);
    var before = NONE;
    while (vertex != before) {
        before = vertex;
        let end = words[neighbors + before + 1u];
        for (var k = words[neighbors + before]; k < end; k++) {
            let further = dot(vertex_of_hull(hull, words[k]), d);
            if (further > reach) {
                reach = further;
                vertex = words[k];
            }
        }
    }
    return vertex;
}

// Returns the face at a vertex most nearly perpendicular to `d`; NONE if all are tilted by more than 5°.
fn face_across(hull: u32, vertex: u32, d: vec3f) -> u32 {
    let faces = words[hull + HULL_VERTEX_FACES];
    var cosine: f32 = FACE_COSINE;
    var best_face = NONE;
    for (var k = words[faces + vertex]; k < words[faces + vertex + 1u]; k++) {
        let other = dot(plane_of_hull(hull, words[k]).xyz, d);
        if (other >= cosine) {
            cosine = other;
            best_face = words[k];
        }
    }
    return best_face;
}

// Stores the corners of a face; of many, only every second, third and so on. Then the furthest vertex is kept too, but
// for a level face only if it is noticeably further than the others.
fn face_of_hull(body: Body, face: u32, vertex: u32, d: vec3f, offset: u32) -> Feature {
    let corners = words[body.hull + HULL_FACE_CORNERS] + face;
    let begin = words[corners];
    let count = words[corners + 1u] - begin;
    let stride = (count + MAX_FACE_CORNERS - 2u) / (MAX_FACE_CORNERS - 1u);
    let normal = plane_of_hull(body.hull, face).xyz;
    var furthest = -UNMOVABLE;
    for (var k = 0u; k < count; k += stride) {
        furthest = max(furthest, dot(vertex_of_hull(body.hull, words[begin + k]), d));
    }
    let level = dot(d - normal, d - normal) <= HULL_LEVEL * HULL_LEVEL;
    let needed = !level || dot(vertex_of_hull(body.hull, vertex), d) > furthest + body.reach * HULL_NOTICEABLE;
    var kept = 0u;
    for (var k = 0u; k < count; k++) {
        let corner = words[begin + k];
        if (k % stride == 0u || (needed && corner == vertex)) {
            feature_corners[offset + kept] = vertex_of_hull(body.hull, corner);
            kept++;
        }
    }
    return Feature(kept, normal, 0.0);
}

// Stores the most nearly level face or edge at the furthest vertex, if one is level enough. A slight tilt, beyond
// rounding, decides between several vertices or faces.
fn feature_of_hull(body: Body, d: vec3f, offset: u32) -> Feature {
    let aside = vec3f(HULL_ASIDE_X, HULL_ASIDE_Y, HULL_ASIDE_Z);
    let tilted = d + aside * max(HULL_TIE, 16.0 * EPSILON);
    let vertex = furthest_of_hull(body.hull, tilted);
    let face = face_across(body.hull, vertex, tilted);
    if (face != NONE) {
        return face_of_hull(body, face, vertex, d, offset);
    }
    let corner = vertex_of_hull(body.hull, vertex);
    let neighbors = words[body.hull + HULL_NEIGHBORS] + vertex;
    // The squared rise and length of the best edge.
    var best_edge = vec2f(EDGE_SINE * EDGE_SINE, 1.0);
    var neighbor = NONE;
    for (var k = words[neighbors]; k < words[neighbors + 1u]; k++) {
        let edge = vertex_of_hull(body.hull, words[k]) - corner;
        let rise = dot(edge, d) * dot(edge, d);
        let square = dot(edge, edge);
        if (rise * best_edge.y <= best_edge.x * square) {
            best_edge = vec2f(rise, square);
            neighbor = words[k];
        }
    }
    feature_corners[offset] = corner;
    if (neighbor == NONE) {
        return Feature(1u, d, 0.0);
    }
    let is_first = vertex < neighbor;
    feature_corners[offset + select(0u, 1u, is_first)] = vertex_of_hull(body.hull, neighbor);
    feature_corners[offset + select(1u, 0u, is_first)] = corner;
    return Feature(2u, d, 0.0);
}
