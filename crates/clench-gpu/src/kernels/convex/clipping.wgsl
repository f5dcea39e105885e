// Features projected along the contact's normal, and clipping one against the other: x and y across the normal, z along
// it. CPU counterparts: `clench-collide/src/narrow/convex/clipping.rs` and `polygon.rs`.

// A polygon, or a segment (two corners), from `polygon_begin` on. A function that makes new corners of all old ones
// writes them to the other half: compilers unroll a copy of the array.
var<private> polygon: array<vec3f, 2 * POLYGON_CORNERS>;
var<private> polygon_begin: u32;
var<private> polygon_count: u32;

fn polygon_corner(k: u32) -> vec3f {
    return polygon[polygon_begin + k];
}

// Empties the polygon, and returns where its corners were.
fn begin_polygon() -> u32 {
    let old = polygon_begin;
    polygon_begin = POLYGON_CORNERS - old;
    polygon_count = 0u;
    return old;
}

// A projected edge or face: the offset and number of its corners, and the slope of its height. For a round cap also its
// radius (else zero), two axes in its plane, and a point with its centre's coordinates along them.
struct Projected {
    offset: u32,
    count: u32,
    slope: vec2f,
    radius: f32,
    x: vec3f,
    y: vec3f,
    center: vec3f,
}

// Returns the projection of a feature whose corners, from `offset` on, are already projected; the columns of `axes` are
// its body's.
fn project_feature(offset: u32, f: Feature, axes: mat3x3f, center: vec3f) -> Projected {
    let normal = axes * f.normal;
    var slope = -normal.xy / normal.z;
    if (f.count == 2u) {
        let apart = feature_corners[offset + 1u] - feature_corners[offset];
        slope = apart.xy * (apart.z / max(dot(apart.xy, apart.xy), SMALLEST));
    }
    return Projected(offset, f.count, slope, f.radius, axes[0], axes[1], center);
}

fn is_cap(f: Projected) -> bool {
    return ANY_CAP_PATCHES && f.radius > 0.0;
}

// Returns a corner; after the last comes the first.
fn corner_of_feature(f: Projected, k: u32) -> vec3f {
    return feature_corners[f.offset + select(k, 0u, k == f.count)];
}

// Returns the height of a feature's plane at a point of the projection.
fn height_of(f: Projected, p: vec2f) -> f32 {
    let origin = feature_corners[f.offset];
    return origin.z + dot(f.slope, p - origin.xy);
}

fn cross_2d(u: vec2f, v: vec2f) -> f32 {
    return u.x * v.y - u.y * v.x;
}

// Adds a corner. Only rounding could exceed the capacity, and the excess corners coincide with others.
fn push_corner(p: vec3f) {
    if (polygon_count < POLYGON_CORNERS) {
        polygon[polygon_begin + polygon_count] = p;
        polygon_count++;
    }
}

// Keeps the part of the polygon where `outward` · p is at most `limit` (Sutherland–Hodgman).
fn clip_polygon(outward: vec2f, limit: f32) {
    let count = polygon_count;
    var beyond = false;
    for (var k = 0u; k < count; k++) {
        beyond = beyond || dot(outward, polygon_corner(k).xy) > limit;
    }
    if (!beyond) {
        return;
    }
    // The second side of a segment would cross the line again.
    let sides = select(count, 1u, count == 2u);
    let old = begin_polygon();
    for (var k = 0u; k < count; k++) {
        let p = polygon[old + k];
        let q = polygon[old + select(k + 1u, 0u, k + 1u == count)];
        let dp = dot(outward, p.xy) - limit;
        let dq = dot(outward, q.xy) - limit;
        if (dp <= 0.0) {
            push_corner(p);
        }
        let crosses = (dp < 0.0 && dq > 0.0) || (dp > 0.0 && dq < 0.0);
        if (crosses && k < sides) {
            push_corner(p + (q - p) * (dp / (dp - dq)));
        }
    }
}

// Returns the parameter, 0 to 1, of the point of a segment that is nearest to another in the projection.
fn nearest_along(along: vec2f, to: vec2f) -> f32 {
    return clamp(dot(along, to) / dot(along, along), 0.0, 1.0);
}

// Returns the crossing of two segments in the projection, or the middle between their nearest points.
fn crossing(a: Projected, b: Projected) -> vec3f {
    let p = feature_corners[a.offset];
    let q = feature_corners[b.offset];
    let u = feature_corners[a.offset + 1u] - p;
    let v = feature_corners[b.offset + 1u] - q;
    let inverse = 1.0 / cross_2d(u.xy, v.xy);
    let at = vec2f(cross_2d((q - p).xy, v.xy), cross_2d((q - p).xy, u.xy)) * inverse;
    var ends = clamp(at, vec2f(0.0), vec2f(1.0));
    let beyond = abs(at - ends);
    if (max(beyond.x, beyond.y) > CLIP_BEYOND_END) {
        // The lines of nearly parallel segments may cross far beyond the end at which the segments are nearest.
        ends.y = nearest_along(v.xy, (p + u * ends.x - q).xy);
        ends.x = nearest_along(u.xy, (q + v * ends.y - p).xy);
    }
    return (p + u * ends.x + q + v * ends.y) * 0.5;
}

fn is_parallel(a: Projected, b: Projected) -> bool {
    let u = (feature_corners[a.offset + 1u] - feature_corners[a.offset]).xy;
    let v = (feature_corners[b.offset + 1u] - feature_corners[b.offset]).xy;
    let area = cross_2d(u, v);
    return area * area <= dot(u, u) * dot(v, v) * CLIP_PARALLEL * CLIP_PARALLEL;
}

// Returns the coordinates, in the plane of a cap and from its centre, of the point above or below a point of the
// projection.
fn in_cap_plane(cap: Projected, p: vec2f) -> vec2f {
    let arm = vec3f(p, height_of(cap, p)) - cap.center;
    return vec2f(dot(cap.x, arm), dot(cap.y, arm));
}

// Returns true if a point of the projection lies in a face.
fn covers(f: Projected, p: vec2f, slack: f32) -> bool {
    if (is_cap(f)) {
        let at = in_cap_plane(f, p);
        return dot(at, at) <= (f.radius + slack) * (f.radius + slack);
    }
    for (var k = 0u; k < f.count; k++) {
        let start = corner_of_feature(f, k).xy;
        let side = corner_of_feature(f, k + 1u).xy - start;
        if (cross_2d(side, p - start) < -slack * length(side)) {
            return false;
        }
    }
    return true;
}

// Returns the parameters, 0 to 1 between its ends, at which a segment enters and leaves a cap's circle; both are
// nearest to the centre if it misses the circle.
fn chord(cap: Projected, p: vec2f, q: vec2f) -> vec2f {
    let start = in_cap_plane(cap, p);
    let along = in_cap_plane(cap, q) - start;
    let square = max(dot(along, along), SMALLEST);
    let nearest = -dot(start, along) / square;
    let miss = cross_2d(start, along);
    let half = sqrt(max(cap.radius * cap.radius * square - miss * miss, 0.0)) / square;
    return vec2f(nearest - half, nearest + half);
}

// Fills the polygon with the part of an edge or a face within a round cap.
fn clip_to_cap(cap: Projected, cut: Projected, slack: f32) {
    if (cut.count == 2u) {
        let p = feature_corners[cut.offset];
        let edge = feature_corners[cut.offset + 1u] - p;
        let ends = clamp(chord(cap, p.xy, (p + edge).xy), vec2f(0.0), vec2f(1.0));
        push_corner(p + edge * ends.x);
        push_corner(p + edge * ends.y);
        return;
    }
    for (var k = 0u; k < cut.count; k++) {
        let p = corner_of_feature(cut, k);
        if (covers(cap, p.xy, slack)) {
            push_corner(p);
        }
        let q = corner_of_feature(cut, k + 1u);
        let ends = chord(cap, p.xy, q.xy);
        for (var end = 0u; end < bound(2u); end++) {
            let t = ends[end];
            if (ends.x < ends.y && t > 0.0 && t < 1.0) {
                push_corner(p + (q - p) * t);
            }
        }
    }
    for (var k = 0u; k < cap.count; k++) {
        let p = corner_of_feature(cap, k);
        if (covers(cut, p.xy, slack)) {
            push_corner(p);
        }
    }
    sort_by_angle();
}

// Sorts the corners of the polygon around their centre, from the first. Overwrites their heights.
fn sort_by_angle() {
    var sum = vec3f();
    for (var k = 0u; k < polygon_count; k++) {
        sum += polygon_corner(k);
    }
    let center = sum.xy / f32(max(polygon_count, 1u));
    let start = polygon_corner(0u).xy - center;
    for (var k = 0u; k < polygon_count; k++) {
        let p = polygon_corner(k).xy;
        let arm = p - center;
        let along = dot(start, arm);
        let aside = cross_2d(start, arm);
        let size = max(abs(along) + abs(aside), SMALLEST);
        let pseudo_angle = 1.0 - along / size;
        // The key grows with the angle from the first corner, 0 to 4. Corners next to the first tie with it.
        let corner = vec3f(p, select(pseudo_angle, 4.0 - pseudo_angle, aside < -size * (EPSILON * 1e3)));
        var index = polygon_begin + k;
        while (index > polygon_begin && polygon[max(index, 1u) - 1u].z > corner.z) {
            polygon[index] = polygon[index - 1u];
            index--;
        }
        polygon[index] = corner;
    }
}

// Fills the polygon with the overlap of two features in the projection, widened by `slack`. The heights of its corners
// are undefined.
fn overlap(a: Projected, b: Projected, slack: f32) {
    polygon_count = 0u;
    if (a.count == 2u && b.count == 2u && !is_parallel(a, b)) {
        push_corner(crossing(a, b));
        return;
    }
    // A face cuts an edge, a circle cuts a polygon, and the one with fewer sides cuts the other.
    var cut = b;
    var by = a;
    if (a.count == 2u || (b.count != 2u && (is_cap(b) || (!is_cap(a) && a.count >= b.count)))) {
        cut = a;
        by = b;
    }
    if (is_cap(by)) {
        clip_to_cap(by, cut, slack);
        return;
    }
    for (var k = 0u; k < cut.count; k++) {
        push_corner(corner_of_feature(cut, k));
    }
    for (var k = 0u; k < by.count; k++) {
        let p = corner_of_feature(by, k).xy;
        let side = corner_of_feature(by, k + 1u).xy - p;
        let outward = select(vec2f(side.y, -side.x), -side, by.count == 2u);
        clip_polygon(outward, dot(outward, p) + length(side) * slack);
    }
}
