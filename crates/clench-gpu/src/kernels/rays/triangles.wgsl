// Rays against the triangles of a mesh, found by a tree of boxes: sister of `clench-collide/src/ray/triangles.rs`.
//
// Nodes lie in the order in which they are visited: one that a ray enters is followed by its children, and each names the node that
// follows all below it. A mesh is told by how many nodes it has, and where they, their boxes and the corners of its triangles are.

// A ray, and the shear that makes it the z axis: its axes in an order in which it is longest along the last, and how much x and y change
// along z.
struct Shear {
    line: Line,
    longest: u32,
    slope: vec2f,
}

// A vector with its axes in that order.
fn in_order(v: vec3f, longest: u32) -> vec3f {
    return select(select(v, v.zxy, longest == 1u), v.yzx, longest == 0u);
}

fn shear_of(line: Line) -> Shear {
    let size = abs(line.along);
    let longest = select(select(0u, 1u, size.y > size.x), 2u, size.z > max(size.x, size.y));
    let along = in_order(line.along, longest);
    return Shear(line, longest, along.xy / along.z);
}

// Whether a ray enters the box at a place before a limit. A ray across an axis is taken for one that is almost so.
fn enters(line: Line, place: u32, limit: f32) -> bool {
    let steep = select(max(line.along, vec3f(1e-20)), min(line.along, vec3f(-1e-20)), line.along < vec3f());
    let low = (shape3(place) - line.origin) / steep;
    let high = (shape3(place + 3u) - line.origin) / steep;
    let near = min(low, high);
    let far = max(low, high) * (1.0 + 4.0 * EPSILON);
    return max(max(near.x, near.y), max(near.z, 0.0)) <= min(min(far.x, far.y), min(far.z, limit));
}

// On which side of the edge from a to b the origin is, by the area between them; zero where rounding alone would say it, which may differ
// between both triangles at the edge.
fn side_of(a: vec3f, b: vec3f) -> f32 {
    let ahead = a.x * b.y;
    let back = a.y * b.x;
    let area = ahead - back;
    return select(area, 0.0, abs(area) <= EPSILON * (abs(ahead) + abs(back)));
}

// A corner in the ray's frame: its distance from the ray across, and how far along the ray it is.
fn sheared(shear: Shear, place: u32) -> vec3f {
    let v = in_order(shape3(place) - shear.line.origin, shear.longest);
    return vec3f(v.xy - shear.slope * v.z, v.z);
}

// Where a ray hits the triangle at a place, NOWHERE if it does not.
fn hit_triangle(shear: Shear, place: u32) -> f32 {
    let p = sheared(shear, place);
    let q = sheared(shear, place + 3u);
    let r = sheared(shear, place + 6u);
    let sides = vec3f(side_of(r, q), side_of(p, r), side_of(q, p));
    let whole = dot(sides, vec3f(1.0));
    let inside = all(sides >= vec3f()) || all(sides <= vec3f());
    if (!inside || whole == 0.0) {
        return NOWHERE;
    }
    let at = dot(sides, vec3f(p.z, q.z, r.z)) / (whole * in_order(shear.line.along, shear.longest).z);
    return select(NOWHERE, at, at >= 0.0);
}

// The first hit before a limit, from either side. The normal is on the side from which the corners are counter-clockwise.
fn hit_mesh(mesh: u32, line: Line, limit: f32) -> Hit {
    let count = words[mesh];
    let corners = words[mesh + 3u];
    let shear = shear_of(line);
    var nearest = limit;
    var hit = NONE;
    var node = 0u;
    while (node < count) {
        let row = words[mesh + 1u] + NODE_SIZE * node;
        if (!enters(line, words[mesh + 2u] + 6u * node, nearest)) {
            node = words[row + NODE_NEXT];
            continue;
        }
        for (var k = 0u; k < words[row + NODE_FACE_COUNT]; k++) {
            let face = words[row + NODE_FACE] + k;
            let at = hit_triangle(shear, corners + 9u * face);
            if (at < nearest) {
                nearest = at;
                hit = face;
            }
        }
        node += 1u;
    }
    if (hit == NONE) {
        return Hit(NOWHERE, vec3f());
    }
    let p = shape3(corners + 9u * hit);
    let q = shape3(corners + 9u * hit + 3u);
    let r = shape3(corners + 9u * hit + 6u);
    return Hit(nearest, direction(cross(q - p, r - p)).xyz);
}
