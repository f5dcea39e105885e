// Features projected along the contact's normal, and clipping one against the other: x and y across the normal, z along it. Sisters
// of `clench-collide/src/narrow/convex/clipping.rs` and `polygon.rs`.

// Edges at less than this angle lie side by side; others cross.
const PARALLEL: f32 = 1e-3;

// A polygon, or a segment (two corners). Two faces of four corners overlap in one of at most eight.
var<private> polygon: array<vec3f, 12>;
var<private> polygon_count: u32;

// A projected edge or face: where its corners stand, how many there are, and the slope of its height.
struct Projected {
    place: u32,
    count: u32,
    slope: vec2f,
}

// The projection of a feature, whose corners from `place` on it replaces; `normal` is that of a face, projected.
fn project_feature(place: u32, count: u32, normal: vec3f) -> Projected {
    var slope = -normal.xy / normal.z;
    if (count == 2u) {
        let apart = feature_corners[place + 1u] - feature_corners[place];
        slope = apart.xy * (apart.z / max(dot(apart.xy, apart.xy), LEAST_NORMAL));
    }
    return Projected(place, count, slope);
}

// The height of a feature's plane at a point of the projection.
fn height_of(f: Projected, p: vec2f) -> f32 {
    let origin = feature_corners[f.place];
    return origin.z + dot(f.slope, p - origin.xy);
}

fn turn_of(u: vec2f, v: vec2f) -> f32 {
    return u.x * v.y - u.y * v.x;
}

// Leaves the part of the polygon where `outward` · p is at most `limit` (Sutherland–Hodgman).
fn clip_polygon(outward: vec2f, limit: f32) {
    var whole = polygon;
    let count = polygon_count;
    // The way back along a segment would meet the line a second time.
    let sides = select(count, 1u, count == 2u);
    polygon_count = 0u;
    for (var k = 0u; k < count; k++) {
        let p = whole[k];
        let q = whole[select(k + 1u, 0u, k + 1u == count)];
        let dp = dot(outward, p.xy) - limit;
        let dq = dot(outward, q.xy) - limit;
        if (dp <= 0.0 && polygon_count < 12u) {
            polygon[polygon_count] = p;
            polygon_count++;
        }
        let crosses = (dp < 0.0 && dq > 0.0) || (dp > 0.0 && dq < 0.0);
        if (crosses && k < sides && polygon_count < 12u) {
            polygon[polygon_count] = p + (q - p) * (dp / (dp - dq));
            polygon_count++;
        }
    }
}

// Where two segments cross in the projection, or come nearest to that.
fn crossing(a: Projected, b: Projected) -> vec3f {
    let p = feature_corners[a.place];
    let q = feature_corners[b.place];
    let u = feature_corners[a.place + 1u] - p;
    let v = feature_corners[b.place + 1u] - q;
    let inverse = 1.0 / turn_of(u.xy, v.xy);
    let s = clamp(turn_of((q - p).xy, v.xy) * inverse, 0.0, 1.0);
    let t = clamp(turn_of((q - p).xy, u.xy) * inverse, 0.0, 1.0);
    return (p + u * s + q + v * t) * 0.5;
}

fn is_parallel(a: Projected, b: Projected) -> bool {
    let u = (feature_corners[a.place + 1u] - feature_corners[a.place]).xy;
    let v = (feature_corners[b.place + 1u] - feature_corners[b.place]).xy;
    let turn = turn_of(u, v);
    return turn * turn <= dot(u, u) * dot(v, v) * PARALLEL * PARALLEL;
}

// Fills the polygon with where two features overlap in the projection, or are at most `slack` from it.
fn overlap(a: Projected, b: Projected, slack: f32) {
    if (a.count == 2u && b.count == 2u && !is_parallel(a, b)) {
        polygon[0] = crossing(a, b);
        polygon_count = 1u;
        return;
    }
    // An edge is cut by a face, many sides by few.
    var cut = b;
    var by = a;
    if (a.count == 2u || (b.count != 2u && a.count >= b.count)) {
        cut = a;
        by = b;
    }
    for (var k = 0u; k < cut.count; k++) {
        polygon[k] = feature_corners[cut.place + k];
    }
    polygon_count = cut.count;
    for (var k = 0u; k < by.count; k++) {
        let p = feature_corners[by.place + k].xy;
        let q = feature_corners[by.place + select(k + 1u, 0u, k + 1u == by.count)].xy;
        let side = q - p;
        let outward = select(vec2f(side.y, -side.x), -side, by.count == 2u);
        clip_polygon(outward, dot(outward, p) + length(side) * slack);
    }
}
