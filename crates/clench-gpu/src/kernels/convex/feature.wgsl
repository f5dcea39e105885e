// What of a body lies against a plane: a face, an edge or a corner. Sister of `clench-collide/src/narrow/convex/feature.rs`.

// Faces and edges count as lying against the plane up to a tilt of 5°.
const FACE_COSINE: f32 = 0.996;
const EDGE_SINE: f32 = 0.087;
// The corners of a feature of the first body, then those of one of the second, each in its body's frame.
const MOST_CORNERS: u32 = 4u;
var<private> feature_corners: array<vec3f, 8>;

// How many corners a feature has, and the outward normal of a face. A round cap has more corners than there is room for.
struct Feature {
    count: u32,
    normal: vec3f,
}

// The edge along `axis` through a corner.
fn edge_feature(corner: vec3f, axis: u32, d: vec3f, place: u32) -> Feature {
    for (var k = 0u; k < bound(2u); k++) {
        var end = corner;
        end[axis] = select(abs(corner[axis]), -abs(corner[axis]), k == 0u);
        feature_corners[place + k] = end;
    }
    return Feature(2u, d);
}

fn box_feature(size: vec3f, corner: vec3f, d: vec3f, place: u32) -> Feature {
    for (var axis = 0u; axis < bound(3u); axis++) {
        if (abs(d[axis]) >= FACE_COSINE) {
            let sign = signed(1.0, d[axis]);
            var normal = vec3f();
            normal[axis] = sign;
            let next = (axis + 1u) % 3u;
            let last = (axis + 2u) % 3u;
            for (var k = 0u; k < bound(4u); k++) {
                var found = corner;
                found[next] = size[next] * select(-sign, sign, k == 1u || k == 2u);
                found[last] = size[last] * select(-1.0, 1.0, k >= 2u);
                feature_corners[place + k] = found;
            }
            return Feature(4u, normal);
        }
    }
    for (var axis = 0u; axis < bound(3u); axis++) {
        if (abs(d[axis]) <= EDGE_SINE) {
            return edge_feature(corner, axis, d, place);
        }
    }
    feature_corners[place] = corner;
    return Feature(1u, d);
}

// The feature of a body that is furthest along the unit direction `d`; its corners are stored from `place` on.
fn feature_of(body: Body, d: vec3f, place: u32) -> Feature {
    let corner = support(body, d, d);
    if (body.kind == BOX) {
        return box_feature(body.size, corner, d, place);
    }
    let has_axis = body.kind == CYLINDER || body.kind == CAPSULE;
    if (has_axis && abs(d.z) <= EDGE_SINE) {
        return edge_feature(corner, 2u, d, place);
    }
    feature_corners[place] = corner;
    let is_cap = body.kind == CYLINDER && abs(d.z) >= FACE_COSINE;
    return Feature(select(1u, MOST_CORNERS + 1u, is_cap), d);
}
