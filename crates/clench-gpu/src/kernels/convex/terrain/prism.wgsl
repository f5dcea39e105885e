// The ground below a triangle of terrain: a convex body of six corners. CPU counterpart:
// `clench-collide/src/narrow/convex/prism.rs`.

const PRISM_FACES: u32 = 5u;
const PRISM_EDGES: u32 = 9u;

// Three corners on top, counter-clockwise seen from above, and the three below them.
var<private> prism: array<vec3f, 6>;

// Returns the index of the corner furthest along `d`.
fn furthest_of_prism(d: vec3f) -> u32 {
    let first = select(0u, 3u, d.z < 0.0);
    var furthest = first;
    for (var k = first + 1u; k < first + bound(3u); k++) {
        if (dot(prism[k], d) > dot(prism[furthest], d)) {
            furthest = k;
        }
    }
    return furthest;
}

// Returns the corners of the top, the bottom or a wall, counter-clockwise seen from outside; the first two repeat one.
fn corners_of_prism(face: u32) -> vec4u {
    if (face == 0u) {
        return vec4u(0u, 1u, 2u, 2u);
    }
    if (face == 1u) {
        return vec4u(5u, 4u, 3u, 3u);
    }
    let start = face - 2u;
    let end = (face - 1u) % 3u;
    return vec4u(start, start + 3u, end + 3u, end);
}

// Returns the outward unit normal of a face and, in w, the offset of its plane along it.
fn plane_of_prism(face: u32) -> vec4f {
    let corners = corners_of_prism(face);
    let p = prism[corners.x];
    var normal = vec3f(0.0, 0.0, -1.0);
    if (face == 0u) {
        normal = direction(cross(prism[1] - p, prism[2] - p)).xyz;
    } else if (face >= 2u) {
        let along = prism[corners.w] - p;
        normal = direction(vec3f(along.y, -along.x, 0.0)).xyz;
    }
    return vec4f(normal, dot(normal, p));
}

// Returns the ends of an edge at the top, the bottom or between, the face that traverses it from the first to the
// second, and the other.
fn edge_of_prism(k: u32) -> vec4u {
    let side = k % 3u;
    let next = (side + 1u) % 3u;
    switch k / 3u {
        case 0u: {
            return vec4u(side, next, 0u, side + 2u);
        }
        case 1u: {
            return vec4u(next + 3u, side + 3u, 1u, side + 2u);
        }
        default: {
            return vec4u(side, side + 3u, side + 2u, (side + 2u) % 3u + 2u);
        }
    }
}

// Returns neighbour `k` of a corner: the next and the previous on its level, and the one below or above it.
fn neighbor_in_prism(corner: u32, k: u32) -> u32 {
    if (k == 2u) {
        return (corner + 3u) % 6u;
    }
    return corner - corner % 3u + (corner + 1u + k) % 3u;
}

// Returns the radius of a sphere about the first corner that encloses the prism.
fn reach_of_prism() -> f32 {
    var largest = vec3f();
    for (var k = 0u; k < bound(6u); k++) {
        largest = max(largest, abs(prism[k]));
    }
    return length(largest);
}

// Stores the face that lies against the plane across the unit direction `d`, else the edge, else the corner.
fn feature_of_prism(d: vec3f, offset: u32) -> Feature {
    // A cosine, as the squares of the two lengths of which it is the quotient.
    var steepest = vec2f(FACE_COSINE * FACE_COSINE, 1.0);
    var face = NONE;
    var normal = vec3f();
    // A direction that rises this steeply can only be the normal of the top.
    let faces = select(PRISM_FACES, 1u, d.z > PRISM_WALL_RISE);
    for (var k = 0u; k < faces; k++) {
        let corners = corners_of_prism(k);
        let p = prism[corners.x];
        let outward = cross(prism[corners.y] - p, prism[corners.z] - p);
        let along = dot(outward, d);
        let square = dot(outward, outward);
        if (along > 0.0 && along * along * steepest.y >= steepest.x * square) {
            steepest = vec2f(along * along, square);
            face = k;
            normal = outward;
        }
    }
    if (face != NONE) {
        let corners = corners_of_prism(face);
        for (var k = 0u; k < bound(4u); k++) {
            feature_corners[offset + k] = prism[corners[k]];
        }
        return Feature(select(4u, 3u, face < 2u), direction(normal).xyz, 0.0);
    }
    let corner = furthest_of_prism(d);
    feature_corners[offset] = prism[corner];
    // The squared rise and length of the best edge.
    var best_edge = vec2f(EDGE_SINE * EDGE_SINE, 1.0);
    var count = 1u;
    for (var k = 0u; k < bound(3u); k++) {
        let end = prism[neighbor_in_prism(corner, k)];
        let edge = end - prism[corner];
        let rise = dot(edge, d) * dot(edge, d);
        let square = dot(edge, edge);
        if (rise * best_edge.y <= best_edge.x * square) {
            best_edge = vec2f(rise, square);
            feature_corners[offset + 1u] = end;
            count = 2u;
        }
    }
    return Feature(count, d, 0.0);
}
