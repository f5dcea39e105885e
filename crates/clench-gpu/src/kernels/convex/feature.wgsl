// The part of a body that lies against a plane: a face, an edge or a corner. CPU counterpart: `feature` of the shapes
// in `clench-collide/src/shape`.

// The corners of a feature of the first body, then those of the second, each in its body's frame.
var<private> feature_corners: array<vec3f, 2 * FEATURE_CORNERS>;

// The number of a feature's corners, the outward normal of a face, and the radius of a round cap, which its corners
// approximate (else zero).
struct Feature {
    count: u32,
    normal: vec3f,
    radius: f32,
}

// Stores the edge along `axis` through a corner.
fn edge_feature(corner: vec3f, axis: u32, d: vec3f, offset: u32) -> Feature {
    for (var k = 0u; k < bound(2u); k++) {
        var end = corner;
        end[axis] = select(abs(corner[axis]), -abs(corner[axis]), k == 0u);
        feature_corners[offset + k] = end;
    }
    return Feature(2u, d, 0.0);
}

fn box_feature(size: vec3f, corner: vec3f, d: vec3f, offset: u32) -> Feature {
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
                found[last] = size[last] * select(f32(-1.0), f32(1.0), k >= 2u);
                feature_corners[offset + k] = found;
            }
            return Feature(4u, normal, 0.0);
        }
    }
    for (var axis = 0u; axis < bound(3u); axis++) {
        if (abs(d[axis]) <= EDGE_SINE) {
            return edge_feature(corner, axis, d, offset);
        }
    }
    feature_corners[offset] = corner;
    return Feature(1u, d, 0.0);
}

// Stores the cap of a cylinder: corners at equal angles, the first at the deepest point of the circle. They do not
// follow a negligible tilt, so that a standing cylinder stays at rest.
fn cap_feature(size: vec3f, d: vec3f, offset: u32) -> Feature {
    let up = signed(1.0, d.z);
    var first = vec2f(size.x, 0.0);
    if (length(d.xy) > CAP_TILT) {
        first = radial_direction(d) * size.x;
    }
    for (var k = 0u; k < bound(CAP_CORNERS); k++) {
        let turned = sin_cos(f32(k) * CAP_ANGLE * up);
        let corner = vec2f(first.x * turned.y - first.y * turned.x, first.y * turned.y + first.x * turned.x);
        feature_corners[offset + k] = vec3f(corner, size.y * up);
    }
    return Feature(CAP_CORNERS, vec3f(0.0, 0.0, up), size.x);
}

// Stores the feature of a body furthest along the unit direction `d`, its corners from `offset` on.
fn feature_of(body: Body, d: vec3f, offset: u32) -> Feature {
    if (ANY_MESH && body.kind == MESH) {
        return feature_of_hull(body, d, offset);
    }
    if (ANY_TERRAIN && body.kind == PRISM) {
        return feature_of_prism(d, offset);
    }
    if (ANY_CAP_PATCHES && body.kind == CYLINDER && abs(d.z) >= FACE_COSINE) {
        return cap_feature(body.size, d, offset);
    }
    let corner = support_without_hull(body, d, d);
    if (body.kind == BOX) {
        return box_feature(body.size, corner, d, offset);
    }
    let has_axis = body.kind == CYLINDER || body.kind == CAPSULE;
    if (has_axis && abs(d.z) <= EDGE_SINE) {
        return edge_feature(corner, 2u, d, offset);
    }
    feature_corners[offset] = corner;
    // If no cap meets more than a corner, any count other than 1 suffices.
    let is_cap = body.kind == CYLINDER && abs(d.z) >= FACE_COSINE;
    return Feature(select(1u, CAP_CORNERS, is_cap), d, 0.0);
}
