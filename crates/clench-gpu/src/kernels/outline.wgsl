// At most eight points on the outline of a convex polygon of contacts. CPU counterpart:
// `clench-collide/src/narrow/outline.rs`, which derives the integral over a sector.

// The centroid of the polygon, and the inverse root of its second moments: xx, xy, yy.
var<private> outline_middle: vec2f;
var<private> outline_round: vec3f;
// The sampled points of the outline.
var<private> sampled: array<vec2f, PATCH_POINTS>;
var<private> sampled_count: u32;

fn is_near(p: vec2f, q: vec2f, same: f32) -> bool {
    return dot(p - q, p - q) <= same * same;
}

// Drops corners from the end where the path to the next turns right or not at all.
fn straighten(next: vec2f) {
    while (polygon_count >= 2u) {
        let p = polygon_corner(polygon_count - 2u).xy;
        let q = polygon_corner(polygon_count - 1u).xy;
        if (cross_2d(q - p, next - q) > 0.0) {
            break;
        }
        polygon_count--;
    }
}

// Reduces the polygon, which is star-shaped, to the corners of its convex hull (Graham 1972); corners nearer than
// `same` to the previous one are dropped.
fn make_convex(same: f32) {
    let count = polygon_count;
    let old = begin_polygon();
    var first = 0u;
    for (var k = 1u; k < count; k++) {
        let p = polygon[old + k];
        let q = polygon[old + first];
        if (p.x < q.x || (p.x == q.x && p.y < q.y)) {
            first = k;
        }
    }
    // The first is repeated at the end, to straighten the path back to it.
    for (var k = 0u; k <= count; k++) {
        let next = polygon[old + (first + k) % count].xy;
        if (k == count) {
            while (polygon_count > 1u && is_near(polygon_corner(polygon_count - 1u).xy, next, same)) {
                polygon_count--;
            }
        } else if (polygon_count > 0u && is_near(polygon_corner(max(polygon_count, 1u) - 1u).xy, next, same)) {
            continue;
        }
        straighten(next);
        if (k < count) {
            push_corner(vec3f(next, 0.0));
        }
    }
}

// Finds the centroid and the moments of the polygon; harmless values if it has no area.
fn find_moments() {
    let origin = polygon_corner(0u).xy;
    var area: f32 = 0.0;
    var first = vec2f();
    var second = vec3f();
    for (var k = 1u; k + 1u < polygon_count; k++) {
        let p = polygon_corner(k).xy - origin;
        let q = polygon_corner(k + 1u).xy - origin;
        let twice = cross_2d(p, q);
        area += twice;
        first += (p + q) * twice;
        second += vec3f(
            p.x * p.x + p.x * q.x + q.x * q.x,
            p.x * p.y + q.x * q.y + (p.x * q.y + q.x * p.y) * 0.5,
            p.y * p.y + p.y * q.y + q.y * q.y,
        ) * twice;
    }
    let inverse = 1.0 / max(area, SMALLEST);
    let mean = first * (inverse / 3.0);
    second *= inverse / 6.0;
    let xy = second.y - mean.x * mean.y;
    // Widens a very thin polygon a little.
    var squares = second.xz - mean * mean;
    squares = max(squares, vec2f()) + (squares.x + squares.y) * ROOT_OF_EPSILON;
    let root = sqrt(max(squares.x * squares.y - xy * xy, SMALLEST));
    let scale = 1.0 / (root * sqrt(squares.x + squares.y + root * 2.0));
    outline_middle = origin + mean;
    outline_round = vec3f(squares.y + root, -xy, squares.x + root) * scale;
    if (is_wild(scale)) {
        outline_round = vec3f(1.0, 0.0, 1.0);
    }
}

fn rounded(v: vec2f) -> vec2f {
    return vec2f(dot(outline_round.xy, v), dot(outline_round.yz, v));
}

// Returns the first corner furthest along a direction.
fn furthest_corner(d: vec2f) -> u32 {
    var furthest = 0u;
    var height = -UNMOVABLE;
    for (var k = 0u; k < polygon_count; k++) {
        let other = dot(polygon_corner(k).xy, d);
        if (other > height) {
            height = other;
            furthest = k;
        }
    }
    return furthest;
}

fn next_corner(k: u32) -> u32 {
    return select(k + 1u, 0u, k + 1u >= polygon_count);
}

// Returns the point of the sector between two directions; `begin` is the corner that supports the first, and z the one
// that supports the second.
fn sector_point(start: vec2f, to: vec2f, begin: u32) -> vec3f {
    var corner = begin;
    var mean = vec2f();
    var passed: f32 = 0.0;
    var edge_total = 0u;
    while (edge_total < polygon_count) {
        let p = polygon_corner(corner).xy;
        let edge = polygon_corner(next_corner(corner)).xy - p;
        let at_start = dot(edge, start);
        let at_end = dot(edge, to);
        if (at_end <= 0.0) {
            break;
        }
        // The fraction at which the next corner takes over.
        var share = passed;
        if (at_start < 0.0) {
            share = max(at_start / (at_start - at_end), passed);
        }
        mean += p * (share - passed);
        passed = share;
        corner = next_corner(corner);
        edge_total++;
    }
    mean += polygon_corner(corner).xy * (1.0 - passed);
    // Outward from the centroid, to the first edge between those corners.
    let outward = mean - outline_middle;
    var reach = UNMOVABLE;
    var at = begin;
    for (var k = 0u; k < edge_total; k++) {
        let p = polygon_corner(at).xy;
        at = next_corner(at);
        let side = polygon_corner(at).xy - p;
        let across_side = vec2f(side.y, -side.x);
        let rise = dot(across_side, outward);
        if (rise > 0.0) {
            reach = min(reach, dot(across_side, p - outline_middle) / rise);
        }
    }
    if (reach < UNMOVABLE && reach > 1.0) {
        mean = outline_middle + outward * reach;
    }
    return vec3f(mean, f32(corner));
}

// Samples the polygon's outline: a point per sector, the first about the direction `first`; coincident points are
// merged.
fn sample_outline(first: vec2f, same: f32) {
    let toward = rounded(first);
    let size = length(toward);
    var x = vec2f(1.0, 0.0);
    if (size > 0.0) {
        x = toward / size;
    }
    sampled_count = 0u;
    var corner = 0u;
    var to = vec2f();
    for (var k = 0u; k <= bound(PATCH_POINTS); k++) {
        let start = to;
        let rotation = sin_cos(f32(2u * (k % PATCH_POINTS)) * HALF_SECTOR - HALF_SECTOR);
        to = rounded(vec2f(x.x * rotation.y - x.y * rotation.x, x.x * rotation.x + x.y * rotation.y));
        if (k == 0u) {
            corner = furthest_corner(to);
            continue;
        }
        let point = sector_point(start, to, corner);
        corner = u32(point.z);
        let coincides = sampled_count > 0u
            && (is_near(sampled[max(sampled_count, 1u) - 1u], point.xy, same) || is_near(sampled[0], point.xy, same));
        if (!coincides) {
            sampled[sampled_count] = point.xy;
            sampled_count++;
        }
    }
}
