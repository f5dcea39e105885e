// A convex polytope about the origin that grows vertex by vertex, in the environment's memory. CPU counterpart:
// `clench-collide/src/narrow/convex/polytope.rs`, which explains it.
//
// A vertex has nine numbers, a face twelve: its corners, the sides across (four times the face, plus the side), its
// normal, its distance, the distance again if it may still move (else UNMOVABLE), and whether it is removed. The
// horizon lists the sides of the remaining faces in order: the side, and its start and end corners.

const UNMOVABLE: f32 = 3e38;
const FACE_SIZE: u32 = 12u;

var<private> vertex_count: u32;
var<private> face_count: u32;
var<private> visible_count: u32;
var<private> horizon_count: u32;
// A point inside.
var<private> middle: vec3f;

fn fetch_index(offset: u32) -> u32 {
    return u32(fetch(offset));
}

fn polytope_w(k: u32) -> vec3f {
    return fetch3(thread_field(POLYTOPE) + 9u * k);
}

fn polytope_vertex(k: u32) -> Vertex {
    return Vertex(fetch3(thread_field(POLYTOPE) + 9u * k), fetch3(thread_field(POLYTOPE) + 9u * k + 3u), fetch3(thread_field(POLYTOPE) + 9u * k + 6u));
}

fn push_vertex(vertex: Vertex) {
    put3(thread_field(POLYTOPE) + 9u * vertex_count, vertex.w);
    put3(thread_field(POLYTOPE) + 9u * vertex_count + 3u, vertex.a);
    put3(thread_field(POLYTOPE) + 9u * vertex_count + 6u, vertex.b);
    vertex_count++;
}

fn face_at(face: u32) -> u32 {
    return thread_field(POLYTOPE_FACE) + FACE_SIZE * face;
}

// Returns the minimum distance of a vertex beyond a face to count.
fn visibility() -> f32 {
    return largest * EPSILON * 4.0;
}

fn insert_face(face: u32, corners: vec3u, sides: vec3u) {
    let offset = face_at(face);
    let a = polytope_w(corners.x);
    let crossed = cross(polytope_w(corners.y) - a, polytope_w(corners.z) - a);
    let area = length(crossed);
    // A face without area, to rounding, may even point inwards.
    let is_flat = dot(crossed, a - middle) <= area * visibility();
    let normal = select(crossed / max(area, SMALLEST), vec3f(), is_flat);
    let distance = dot(normal, a);
    put3(offset, vec3f(corners));
    put3(offset + 3u, vec3f(sides));
    put3(offset + 6u, normal);
    put(offset + 9u, distance);
    put(offset + 10u, select(distance, UNMOVABLE, is_flat));
    put(offset + 11u, 0.0);
    face_count = max(face_count, face + 1u);
}

// Builds a tetrahedron from the first four vertices.
fn begin_polytope() {
    let a = polytope_w(0u);
    middle = (a + polytope_w(1u) + polytope_w(2u) + polytope_w(3u)) * 0.25;
    let volume = dot(cross(polytope_w(1u) - a, polytope_w(2u) - a), polytope_w(3u) - a);
    // This makes the first face counter-clockwise, seen from outside.
    let b = select(1u, 2u, volume > 0.0);
    let c = 3u - b;
    face_count = 0u;
    for (var k = 0u; k < bound(4u); k++) {
        var corners = vec3u(0u, b, c);
        var sides = vec3u(4u, 8u, 12u);
        if (k == 1u) {
            corners = vec3u(b, 0u, 3u);
            sides = vec3u(0u, 14u, 9u);
        } else if (k == 2u) {
            corners = vec3u(c, b, 3u);
            sides = vec3u(1u, 6u, 13u);
        } else if (k == 3u) {
            corners = vec3u(0u, c, 3u);
            sides = vec3u(2u, 10u, 5u);
        }
        insert_face(k, corners, sides);
    }
}

// Returns the face nearest to the origin of those that may still move; its distance is UNMOVABLE if there is none.
fn nearest_face_of_polytope() -> u32 {
    var nearest = 0u;
    var least = UNMOVABLE;
    for (var k = 0u; k < face_count; k++) {
        let distance = fetch(face_at(k) + 10u);
        if (distance < least) {
            least = distance;
            nearest = k;
        }
    }
    return nearest;
}

fn remove_face(face: u32) {
    put(face_at(face) + 11u, 1.0);
    put(thread_field(POLYTOPE_VISIBLE) + visible_count, f32(face));
    visible_count++;
}

// Removes the faces visible from `w` by traversal from one of them, and lists the sides at its border, the horizon, in
// order.
fn find_horizon(first: u32, w: vec3f) {
    visible_count = 0u;
    horizon_count = 0u;
    remove_face(first);
    var depth = 0u;
    for (var k = 3u; k > 0u; k--) {
        put(thread_field(POLYTOPE_STACK) + depth, fetch(face_at(first) + 2u + k));
        depth++;
    }
    while (depth > 0u) {
        depth--;
        let side = fetch_index(thread_field(POLYTOPE_STACK) + depth);
        let face = side >> 2u;
        let start = side & 3u;
        let offset = face_at(face);
        if (fetch(offset + 11u) == 1.0) {
            continue;
        }
        let normal = fetch3(offset + 6u);
        // A face without area has no normal and is removed with its neighbours.
        if (any(normal != vec3f()) && dot(normal, w) - fetch(offset + 9u) <= visibility()) {
            if (horizon_count < POLYTOPE_FACES) {
                put(thread_field(POLYTOPE_HORIZON) + 3u * horizon_count, f32(side));
                put(thread_field(POLYTOPE_HORIZON) + 3u * horizon_count + 1u, fetch(offset + start));
                put(thread_field(POLYTOPE_HORIZON) + 3u * horizon_count + 2u, fetch(offset + (start + 1u) % 3u));
            }
            horizon_count++;
            continue;
        }
        remove_face(face);
        put(thread_field(POLYTOPE_STACK) + depth, fetch(offset + 3u + (start + 2u) % 3u));
        put(thread_field(POLYTOPE_STACK) + depth + 1u, fetch(offset + 3u + (start + 1u) % 3u));
        depth += 2u;
    }
}

// Returns true if the visible faces are a patch with one border, which then has two sides more than there are faces.
fn horizon_is_closed() -> bool {
    if (horizon_count != visible_count + 2u || horizon_count > POLYTOPE_FACES) {
        return false;
    }
    var start = fetch(thread_field(POLYTOPE_HORIZON) + 3u * (horizon_count - 1u) + 1u);
    for (var k = 0u; k < horizon_count; k++) {
        if (start != fetch(thread_field(POLYTOPE_HORIZON) + 3u * k + 2u)) {
            return false;
        }
        start = fetch(thread_field(POLYTOPE_HORIZON) + 3u * k + 1u);
    }
    return true;
}

// Returns the index of the new face at side `k` of the horizon: those of the visible faces, and two more.
fn new_face(k: u32, old: u32) -> u32 {
    if (k < visible_count) {
        return fetch_index(thread_field(POLYTOPE_VISIBLE) + k);
    }
    return old + k - visible_count;
}

// Adds faces from the horizon to the last vertex.
fn stitch() {
    let tip = vertex_count - 1u;
    let old = face_count;
    for (var k = 0u; k < horizon_count; k++) {
        let face = new_face(k, old);
        let before = new_face(select(k - 1u, horizon_count - 1u, k == 0u), old);
        let after = new_face(select(k + 1u, 0u, k + 1u == horizon_count), old);
        let side = fetch_index(thread_field(POLYTOPE_HORIZON) + 3u * k);
        let start = fetch_index(thread_field(POLYTOPE_HORIZON) + 3u * k + 1u);
        let to = fetch_index(thread_field(POLYTOPE_HORIZON) + 3u * k + 2u);
        insert_face(face, vec3u(to, start, tip), vec3u(side, 4u * after + 2u, 4u * before + 1u));
        put(face_at(side >> 2u) + 3u + (side & 3u), f32(4u * face));
    }
}

// Replaces the faces visible from a vertex by faces to it; `face` is one of them. Does nothing and returns false if the
// vertex is one of its corners or rounding has broken the horizon.
fn add_to_polytope(face: u32, vertex: Vertex) -> bool {
    let same = max(smallest * POLYTOPE_SAME_VERTEX, exactness);
    for (var k = 0u; k < bound(3u); k++) {
        let apart = polytope_w(fetch_index(face_at(face) + k)) - vertex.w;
        if (dot(apart, apart) <= same * same) {
            return false;
        }
    }
    find_horizon(face, vertex.w);
    if (!horizon_is_closed()) {
        for (var k = 0u; k < visible_count; k++) {
            put(face_at(fetch_index(thread_field(POLYTOPE_VISIBLE) + k)) + 11u, 0.0);
        }
        return false;
    }
    push_vertex(vertex);
    stitch();
    return true;
}
