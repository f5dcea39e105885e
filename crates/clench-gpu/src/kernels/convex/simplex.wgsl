// The point nearest to the origin in the hull of up to four vertices. CPU counterpart:
// `clench-collide/src/narrow/convex/simplex.rs`.

var<private> simplex: array<Vertex, 4>;
var<private> weights: array<f32, 4>;
var<private> simplex_count: u32;

// A point as a weighted sum of vertices.
struct Nearest {
    point: vec3f,
    corners: vec3u,
    weights: vec3f,
}

fn begin_simplex(vertex: Vertex) {
    simplex[0] = vertex;
    weights = array<f32, 4>(1.0, 0.0, 0.0, 0.0);
    simplex_count = 1u;
}

fn nearest_vertex(i: u32) -> Nearest {
    return Nearest(simplex[i].w, vec3u(i), vec3f(1.0, 0.0, 0.0));
}

// Returns the point at the fraction `ahead` / `whole` from one vertex to another.
fn nearest_on_edge(i: u32, j: u32, ahead: f32, whole: f32) -> Nearest {
    if (whole <= 0.0) {
        return nearest_vertex(i);
    }
    let t = ahead / whole;
    let p = simplex[i].w;
    return Nearest(p + (simplex[j].w - p) * t, vec3u(i, j, j), vec3f(1.0 - t, t, 0.0));
}

fn nearest_on_segment_of(i: u32, j: u32) -> Nearest {
    let p = simplex[i].w;
    let along = simplex[j].w - p;
    let ahead = -dot(p, along);
    let square = dot(along, along);
    if (ahead <= 0.0) {
        return nearest_vertex(i);
    }
    if (ahead >= square) {
        return nearest_vertex(j);
    }
    return nearest_on_edge(i, j, ahead, square);
}

// Finds the nearest point by the Voronoi regions of corners, edges and inside (Ericson, Real-Time Collision Detection,
// 5.1.5).
fn nearest_on_triangle(i: u32, j: u32, k: u32) -> Nearest {
    let a = simplex[i].w;
    let b = simplex[j].w;
    let c = simplex[k].w;
    let ab = b - a;
    let ac = c - a;
    let d1 = -dot(ab, a);
    let d2 = -dot(ac, a);
    if (d1 <= 0.0 && d2 <= 0.0) {
        return nearest_vertex(i);
    }
    let d3 = -dot(ab, b);
    let d4 = -dot(ac, b);
    if (d3 >= 0.0 && d4 <= d3) {
        return nearest_vertex(j);
    }
    let vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
        return nearest_on_edge(i, j, d1, d1 - d3);
    }
    let d5 = -dot(ab, c);
    let d6 = -dot(ac, c);
    if (d6 >= 0.0 && d5 <= d6) {
        return nearest_vertex(k);
    }
    let vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
        return nearest_on_edge(i, k, d2, d2 - d6);
    }
    let va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
        return nearest_on_edge(j, k, d4 - d3, d4 - d3 + (d5 - d6));
    }
    let sum = va + vb + vc;
    let normal = cross(ab, ac);
    let square = dot(normal, normal);
    if (!(sum > 0.0 && square > 0.0)) {
        return nearest_on_sides(i, j, k);
    }
    let v = vb / sum;
    let w = vc / sum;
    // Along the normal the point keeps its direction, which the weighted sum would lose.
    return Nearest(normal * (dot(normal, a) / square), vec3u(i, j, k), vec3f(1.0 - v - w, v, w));
}

// Handles a triangle without area.
fn nearest_on_sides(i: u32, j: u32, k: u32) -> Nearest {
    var nearest = nearest_vertex(i);
    for (var side = 0u; side < bound(3u); side++) {
        let start = select(select(k, j, side == 1u), i, side == 0u);
        let to = select(select(i, k, side == 1u), j, side == 0u);
        let other = nearest_on_segment_of(start, to);
        if (dot(other.point, other.point) < dot(nearest.point, nearest.point)) {
            nearest = other;
        }
    }
    return nearest;
}

// Adds a vertex and drops those not needed for the nearest point. Returns that point and 1; zero if the origin is
// inside.
fn add_vertex(vertex: Vertex) -> vec4f {
    let count = simplex_count;
    simplex[count] = vertex;
    simplex_count = count + 1u;
    var nearest = nearest_vertex(count);
    var known = false;
    if (count == 1u) {
        nearest = nearest_on_segment_of(1u, 0u);
        known = true;
    } else {
        // For a tetrahedron, the faces with the new vertex that the origin is beyond.
        for (var i = 0u; i < bound(select(1u, 3u, count == 3u)); i++) {
            let j = (i + 1u) % 3u;
            let normal = cross(simplex[i].w - vertex.w, simplex[j].w - vertex.w);
            let inward = dot(simplex[(i + 2u) % 3u].w - vertex.w, normal);
            if (count == 3u && -dot(vertex.w, normal) * inward > 0.0) {
                continue;
            }
            let other = nearest_on_triangle(count, i, j);
            if (!known || dot(other.point, other.point) < dot(nearest.point, nearest.point)) {
                nearest = other;
                known = true;
            }
        }
    }
    if (!known) {
        return vec4f();
    }
    store_vertices(nearest);
    return vec4f(nearest.point, 1.0);
}

fn store_vertices(nearest: Nearest) {
    var all = array<f32, 4>(0.0, 0.0, 0.0, 0.0);
    for (var k = 0u; k < bound(3u); k++) {
        all[nearest.corners[k]] += nearest.weights[k];
    }
    var kept = 0u;
    for (var k = 0u; k < bound(4u); k++) {
        if (all[k] > 0.0) {
            simplex[kept] = simplex[k];
            weights[kept] = all[k];
            kept++;
        }
    }
    simplex_count = max(kept, 1u);
}
