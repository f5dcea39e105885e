// The triangles of a height field, one at a time, their neighbours, and a test whether a direction lies in the Voronoi
// region of an edge or a corner, and so is a normal of the field there. CPU counterparts:
// `clench-collide/src/narrow/convex/terrain/grid.rs` and `voronoi.rs`.

// A corner, an edge or the face of a triangle, and the gap along a normal there.
struct TerrainFeature {
    gap: Gap,
    nodes: array<vec2i, 3>,
    // The nodes that belong to it.
    touches: vec3<bool>,
}

// The current triangle: its nodes; its corners, counter-clockwise seen from above, in a frame with origin at the first;
// that origin in the field's frame; and the unit normal.
var<private> triangle_nodes: array<vec2i, 3>;
var<private> triangle: array<vec3f, 3>;
var<private> triangle_origin: vec3f;
var<private> triangle_normal: vec3f;

// Begins a triangle of a cell: 0 on the left, 1 on the right of its diagonal from the lowest x and y to the highest.
fn begin_triangle(cell: vec2i, half: u32) {
    triangle_nodes[0] = cell;
    triangle_nodes[1] = cell + select(vec2i(0, 1), vec2i(1, 1), half == 0u);
    triangle_nodes[2] = cell + select(vec2i(1, 1), vec2i(1, 0), half == 0u);
    triangle_origin = vec3f(corner_of_cell(cell), height_at(cell));
    for (var k = 0u; k < bound(3u); k++) {
        triangle[k] = position_of_node(triangle_nodes[k]);
    }
    triangle_normal = direction(cross(triangle[1], triangle[2])).xyz;
    let bottom = -triangle_origin.z - grid.base;
    for (var k = 0u; k < bound(3u); k++) {
        prism[k] = triangle[k];
        prism[k + 3u] = vec3f(triangle[k].xy, bottom);
    }
}

fn is_node(node: vec2i) -> bool {
    return all(node >= vec2i()) && node.x < grid.rows && node.y < grid.columns;
}

// Returns a grid point in the triangle's frame.
fn position_of_node(node: vec2i) -> vec3f {
    let apart = node - triangle_nodes[0];
    return vec3f(vec2f(f32(apart.y), f32(apart.x)) * grid.step, height_at(node) - triangle_origin.z);
}

// Returns true if a point is within the ground below the triangle, and at least `distance` from walls and bottom, m.
fn triangle_surrounds(point: vec3f, distance: f32) -> bool {
    for (var k = 0u; k < bound(3u); k++) {
        let side = (triangle[(k + 1u) % 3u] - triangle[k]).xy;
        if (cross_2d(side, (point - triangle[k]).xy) < distance * length(side)) {
            return false;
        }
    }
    return point.z - prism[3].z >= distance;
}

// Returns the grid point across the edge opposite to corner `k`.
fn node_across(k: u32) -> vec2i {
    return triangle_nodes[(k + 1u) % 3u] + triangle_nodes[(k + 2u) % 3u] - triangle_nodes[k];
}

// Returns the slope of the surface beyond the edge opposite to corner `k`, relative to the triangle; −UNMOVABLE where
// the surface ends.
fn rise_across(k: u32) -> f32 {
    let node = node_across(k);
    if (!is_node(node)) {
        return -UNMOVABLE;
    }
    let edge = position_of_node(node) - triangle[(k + 1u) % 3u];
    return dot(triangle_normal, edge) / length(edge);
}

// Returns true if the surface bends away from the triangle nowhere, so that only its face can be touched.
fn is_hollow() -> bool {
    for (var k = 0u; k < bound(3u); k++) {
        if (rise_across(k) < -SAME_DIRECTION) {
            return false;
        }
    }
    return true;
}

// Returns a point; for a downward direction, only its horizontal part.
fn level_with(n: vec3f, v: vec3f) -> vec3f {
    return vec3f(v.xy, select(v.z, 0.0, n.z < -SAME_DIRECTION));
}

// Returns the feature that reaches furthest along the normal of a gap.
fn feature_of_triangle(gap: Gap) -> TerrainFeature {
    var reach = vec3f();
    for (var k = 0u; k < bound(3u); k++) {
        reach[k] = dot(level_with(gap.normal, triangle[k]), gap.normal);
    }
    let first = level_with(gap.normal, triangle[0]);
    let size = length(level_with(gap.normal, triangle[1]) - first) + length(level_with(gap.normal, triangle[2]) - first);
    let least = max(reach.x, max(reach.y, reach.z)) - size * SAME_DIRECTION;
    return TerrainFeature(gap, triangle_nodes, reach >= vec3f(least));
}

// Returns true if a grid point is no higher than a corner along a normal, or does not exist.
fn falls_to(n: vec3f, corner: vec3f, node: vec2i) -> bool {
    if (!is_node(node)) {
        return true;
    }
    let edge = level_with(n, position_of_node(node)) - level_with(n, corner);
    return dot(edge, n) <= length(edge) * SAME_DIRECTION;
}

// Returns true if a feature's direction is a normal of the whole field there: the field does not continue beyond the
// prism's wall, or rise beyond its edge.
fn admits_normal(feature: TerrainFeature) -> bool {
    let n = feature.gap.normal;
    let touching_corners = dot(select(vec3f(), vec3f(1.0), feature.touches), vec3f(1.0));
    if (touching_corners == 3.0) {
        return true;
    }
    for (var k = 0u; k < bound(3u); k++) {
        if (touching_corners == 2.0) {
            if (!feature.touches[k] && !falls_to(n, triangle[(k + 1u) % 3u], node_across(k))) {
                return false;
            }
            continue;
        }
        if (!feature.touches[k]) {
            continue;
        }
        // The six nodes that share an edge with it.
        for (var around = 0u; around < bound(6u); around++) {
            let turned = around % 3u;
            var step = vec2i(select(1, 0, turned == 0u), select(1, 0, turned == 2u));
            step = select(step, -step, around >= 3u);
            if (!falls_to(n, triangle[k], triangle_nodes[k] + step)) {
                return false;
            }
        }
    }
    return true;
}

// Returns true if the triangle has all corners of a feature.
fn has_feature(feature: TerrainFeature) -> bool {
    for (var k = 0u; k < bound(3u); k++) {
        var is_corner = !feature.touches[k];
        for (var own = 0u; own < bound(3u); own++) {
            is_corner = is_corner || all(feature.nodes[k] == triangle_nodes[own]);
        }
        if (!is_corner) {
            return false;
        }
    }
    return true;
}
