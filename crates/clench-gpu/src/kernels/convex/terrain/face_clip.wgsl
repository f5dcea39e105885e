// The feature of a body that faces a triangle, clipped to it. CPU counterpart:
// `clench-collide/src/narrow/convex/terrain/face_clip.rs`.

// The tolerance, relative to the body, with which a corner outside a triangle still belongs to it: more than rounding.
const BESIDE: f32 = max(1e-9, 8.0 * EPSILON);

// The number of listed contacts of the face with the body's feature; and whether there are any, even only on the border
// of coplanar faces, where the clipped polygon has no own corner.
var<private> face_list_count: u32;
var<private> face_touches: bool;

// Returns the contact below a point of the body's core, in the triangle's frame.
fn contact_below(point: vec3f) -> TerrainPoint {
    let height = dot(triangle_normal, point);
    let distance = height - body_b.radius;
    let down = height - distance * 0.5;
    return TerrainPoint(triangle_origin + point - triangle_normal * down, triangle_normal, distance);
}

fn add_to_face(point: vec3f, range: f32) {
    let contact = contact_below(point);
    if (contact.distance <= range) {
        face_touches = true;
        put_terrain_point(thread_field(TERRAIN_FACE) + TERRAIN_POINT_SIZE * face_list_count, contact);
        face_list_count++;
    }
}

// Returns the line of the side opposite to corner `k`: its outward normal and, in w, its offset with some slack.
fn side_of_triangle(k: u32) -> vec4f {
    let start = triangle[(k + 1u) % 3u];
    let out = cross(triangle[(k + 2u) % 3u] - start, triangle_normal);
    return vec4f(out, dot(out, start) + slack_of_side(out));
}

fn slack_of_side(out: vec3f) -> f32 {
    return body_b.reach * BESIDE * max(abs(out.x), max(abs(out.y), abs(out.z)));
}

// Returns true if the plane of the triangle ends at a side that contains the point.
fn face_ends_at(position: vec3f) -> bool {
    for (var k = 0u; k < bound(3u); k++) {
        let side = side_of_triangle(k);
        let on_side = dot(side.xyz, position) > side.w - slack_of_side(side.xyz) * 4.0;
        if (on_side && abs(rise_across(k)) > SAME_DIRECTION) {
            return true;
        }
    }
    return false;
}

// Lists a contact for each corner of the body's feature, clipped to the triangle, that is within range.
fn find_face_contacts(range: f32) {
    face_list_count = 0u;
    face_touches = false;
    let first = FEATURE_CORNERS;
    let feature = feature_of(body_b, -(triangle_normal * rotation_b), first);
    // The minimum distance of all corners beyond each side.
    var beyond = vec3f(UNMOVABLE);
    for (var k = 0u; k < feature.count; k++) {
        let position = offset_b + rotation_b * feature_corners[first + k];
        feature_corners[first + k] = position;
        for (var side = 0u; side < bound(3u); side++) {
            let line = side_of_triangle(side);
            beyond[side] = min(beyond[side], dot(line.xyz, position) - line.w);
        }
    }
    if (any(beyond > vec3f())) {
        return;
    }
    if (feature.count == 1u) {
        add_to_face(feature_corners[first], range);
        return;
    }
    let frame = across(triangle_normal);
    let view = transpose(mat3x3f(frame.e, frame.f, triangle_normal));
    polygon_count = 0u;
    for (var k = 0u; k < feature.count; k++) {
        let own = view * feature_corners[first + k];
        feature_corners[first + k] = own;
        push_corner(own);
    }
    for (var k = 0u; k < bound(3u); k++) {
        let line = side_of_triangle(k);
        clip_polygon(vec2f(dot(line.xyz, frame.e), dot(line.xyz, frame.f)), line.w);
    }
    for (var k = 0u; k < polygon_count; k++) {
        let corner = polygon_corner(k);
        let position = corner * view;
        var is_own = false;
        for (var other = 0u; other < feature.count; other++) {
            is_own = is_own || all(feature_corners[first + other] == corner);
        }
        if (is_own || face_ends_at(position)) {
            add_to_face(position, range);
        } else if (corner.z - body_b.radius <= range) {
            face_touches = true;
        }
    }
}
