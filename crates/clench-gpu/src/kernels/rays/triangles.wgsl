// Rays against the triangles of a mesh, by a tree of boxes. CPU counterpart: `clench-collide/src/ray/triangles.rs`.
//
// Nodes are stored in depth-first order: a node that a ray enters is followed by its children, and each names the node
// after its subtree. A mesh is a row of MESH_SIZE words.

// A ray, and the shear that makes it the z axis: the index of its longest axis, which comes last, and the slopes of x
// and y along z.
struct Shear {
    line: Line,
    longest: u32,
    slope: vec2f,
}

// Returns a vector with its axes in that order.
fn in_order(v: vec3f, longest: u32) -> vec3f {
    return select(select(v, v.zxy, longest == 1u), v.yzx, longest == 0u);
}

fn shear_of(line: Line) -> Shear {
    let size = abs(line.along);
    let longest = select(select(0u, 1u, size.y > size.x), 2u, size.z > max(size.x, size.y));
    let along = in_order(line.along, longest);
    return Shear(line, longest, along.xy / along.z);
}

// Returns true if a ray enters the box at `offset` before a limit. A ray perpendicular to an axis is perturbed.
fn enters(line: Line, offset: u32, limit: f32) -> bool {
    let steep = select(max(line.along, vec3f(1e-20)), min(line.along, vec3f(-1e-20)), line.along < vec3f());
    let low = (shape3(offset) - line.origin) / steep;
    let high = (shape3(offset + 3u) - line.origin) / steep;
    let near = min(low, high);
    let far = max(low, high) * (1.0 + 4.0 * EPSILON);
    return max(max(near.x, near.y), max(near.z, 0.0)) <= min(min(far.x, far.y), min(far.z, limit));
}

// Returns the area that gives the side of the edge from a to b on which the origin is; zero if it is only rounding,
// which may differ between the two triangles at the edge.
fn side_of(a: vec3f, b: vec3f) -> f32 {
    let ahead = a.x * b.y;
    let back = a.y * b.x;
    let area = ahead - back;
    return select(area, 0.0, abs(area) <= EPSILON * (abs(ahead) + abs(back)));
}

// Returns a corner in the ray's frame: its position across the ray, and along it.
fn sheared(shear: Shear, offset: u32) -> vec3f {
    let v = in_order(shape3(offset) - shear.line.origin, shear.longest);
    return vec3f(v.xy - shear.slope * v.z, v.z);
}

// Returns the hit distance of a ray on the triangle at `offset`, NOWHERE if it misses.
fn hit_triangle(shear: Shear, offset: u32) -> f32 {
    let p = sheared(shear, offset);
    let q = sheared(shear, offset + 3u);
    let r = sheared(shear, offset + 6u);
    let sides = vec3f(side_of(r, q), side_of(p, r), side_of(q, p));
    let whole = dot(sides, vec3f(1.0));
    let inside = all(sides >= vec3f()) || all(sides <= vec3f());
    if (!inside || whole == 0.0) {
        return NOWHERE;
    }
    let at = dot(sides, vec3f(p.z, q.z, r.z)) / (whole * in_order(shear.line.along, shear.longest).z);
    return select(NOWHERE, at, at >= 0.0);
}

// Returns the first hit before a limit, from either side. The normal is on the side from which the corners are
// counter-clockwise.
fn hit_mesh(mesh: u32, line: Line, limit: f32) -> Hit {
    let count = words[mesh + MESH_COUNT];
    let corners = words[mesh + MESH_CORNERS];
    let shear = shear_of(line);
    var nearest = limit;
    var hit = NONE;
    var node = 0u;
    while (node < count) {
        let row = words[mesh + MESH_NODES] + NODE_SIZE * node;
        if (!enters(line, words[mesh + MESH_BOXES] + 6u * node, nearest)) {
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
