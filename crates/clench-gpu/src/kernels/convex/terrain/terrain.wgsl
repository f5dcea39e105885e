// Height fields against bounded convex shapes. Sister of `clench-collide/src/narrow/convex/terrain/mod.rs`, where it is explained.
//
// Each triangle is a round of `convex`: the first body is the ground below it. What a round finds goes into lists in memory, and from
// there into a manifold at its end. After the triangles come rounds that merge what is left.

// A face counts if its depth is at most this many times the smallest depth of any prism.
const FACE_DEPTH_RATIO: f32 = 2.0;
// A direction counts as the face's normal within this many times the tolerance for equal directions.
const FACE_NORMAL_RATIO: f32 = 8.0;
// So many times the tolerance the middle of a ball must be off a triangle for the direction between them to be exact.
const CLEAR: f32 = 1e3;
// How many convex edges and vertices are remembered; others may be searched more than once.
const MAX_FEATURES: u32 = 4u;
// Rounds after the triangles: provisional contacts, then the deepest of those that count and of those that do not.
const CLOSING_ROUNDS: u32 = 3u;

// What is to be done with a triangle: nothing, find its gap, or take the gap of a feature that it shares.
const NOTHING: u32 = 0u;
const SEARCH: u32 = 1u;
const SHARED: u32 = 2u;

// What a triangle's patch is: of a direction that counts, along its normal or not; of one that does not; of a feature known before.
const ALONG_NORMAL: u32 = 0u;
const ADMITTED: u32 = 1u;
const REJECTED: u32 = 2u;
const KNOWN: u32 = 3u;

// Whether contacts are those of a triangle, to be listed.
var<private> on_terrain: bool;
var<private> terrain_offset: vec3f;
var<private> terrain_range: f32;
// The least distances along directions that count and that do not, with contacts that have them.
var<private> deepest: TerrainPoint;
var<private> rejected: TerrainPoint;
// The largest distance along normals of faces with provisional contacts.
var<private> shallowest: f32;
// Which half of which cell of the window comes next, how many there are, and whether any is near the body; then, which closing round.
var<private> next_half: u32;
var<private> half_count: u32;
var<private> any_is_near: bool;
// The direction along which the last triangle's ground was apart from the body.
var<private> apart_along: vec3f;
var<private> features: array<TerrainFeature, MAX_FEATURES>;
var<private> feature_count: u32;
var<private> patch_count: u32;
var<private> patch_is: u32;
// The present triangle's distance along its normal.
var<private> face_distance: f32;
// What the round adds to a manifold: points of a list that are not deeper than this.
var<private> added_from: u32;
var<private> added_count: u32;
var<private> added_to: u32;
var<private> added_least: f32;

// Begins with a body about `offset` in the field's frame.
fn begin_terrain(geom: u32, body: Body, turn: mat3x3f, offset: vec3f, range: f32) {
    begin_grid(words[GEOM_HULL + geom]);
    terrain_size = body.reach;
    terrain_tolerance = max((body.reach + length(offset)) * EPSILON * 64.0, body.reach * 1e-9);
    terrain_offset = offset;
    terrain_range = range;
    manifold_counts = array<u32, 2>();
    let none = TerrainPoint(vec3f(), vec3f(), UNMOVABLE);
    deepest = none;
    rejected = none;
    shallowest = -UNMOVABLE;
    apart_along = vec3f();
    feature_count = 0u;
    any_is_near = false;
    next_half = 0u;
    half_count = 0u;
    if (begin_bounds(body, turn, offset, body.radius + range + terrain_tolerance)) {
        // The cell below the lowest point comes first: what is deepest saves much of the work on the rest.
        half_count = 2u * (1u + u32(window_size.x * window_size.y));
    }
}

// Goes on to the next triangle that is near the body, or closing round. Whether there is one.
fn find_round() -> bool {
    let first = cell_at(lowest_point.x, lowest_point.y);
    while (next_half < half_count) {
        let half = next_half & 1u;
        let number = i32(next_half / 2u) - 1;
        var cell = first;
        if (number >= 0) {
            cell = window_first + vec2i(number / window_size.y, number % window_size.y);
        }
        next_half++;
        if (is_in_window(cell) && (number < 0 || any(cell != first)) && bounds_reach(cell, half)) {
            begin_triangle(cell, half);
            any_is_near = true;
            return true;
        }
    }
    next_half++;
    return any_is_near && next_half <= half_count + CLOSING_ROUNDS;
}

fn deeper(old: TerrainPoint, point: TerrainPoint) -> TerrainPoint {
    if (point.distance < old.distance) {
        return point;
    }
    return old;
}

fn add_list(list: u32, count: u32, manifold: u32, least: f32) {
    added_from = list;
    added_count = count;
    added_to = manifold;
    added_least = least;
}

// Whether a direction shows that the body, whose point nearest to the ground along it is given, and the ground are apart.
fn separates(n: vec3f, nearest: vec3f) -> bool {
    // Downwards the prism's bottom would have to be considered too.
    if (n.z <= 0.0) {
        return false;
    }
    let gap = dot(n, nearest) - max(dot(n, triangle[0]), max(dot(n, triangle[1]), dot(n, triangle[2])));
    let reach = terrain_range + body_b.radius;
    return gap > 0.0 && gap * gap > reach * reach * dot(n, n);
}

// The contact of a triangle and a ball whose middle is above it. Whether it could tell: a middle that is lower than the nearest point
// of the triangle may be nearer to the walls below.
fn ball_on_triangle() -> bool {
    for (var k = 0u; k < bound(3u); k++) {
        simplex[k].w = triangle[k] - offset_b;
    }
    let near = nearest_on_triangle(0u, 1u, 2u);
    let toward = direction(-near.point);
    let normal = toward.xyz;
    let gap = toward.w;
    if (!(normal.z > 0.0 && gap > terrain_tolerance * CLEAR)) {
        return false;
    }
    let radius = body_b.radius;
    let point = TerrainPoint(triangle_origin + offset_b - normal * ((gap + radius) * 0.5), normal, gap - radius);
    if (point.distance > terrain_range) {
        return true;
    }
    if (all(near.weights > vec3f()) || admits_normal(feature_of_triangle(Gap(normal, gap, true)))) {
        deepest = deeper(deepest, point);
        put_terrain_point(thread_field(TERRAIN_PATCH), point);
        add_list(thread_field(TERRAIN_PATCH), 1u, COUNTED, -UNMOVABLE);
    } else {
        rejected = deeper(rejected, point);
    }
    return true;
}

// Makes the triangle of a round the first body, and does what can be done without the gap between the two. What is left to do.
fn begin_round(second: Body, turn: mat3x3f) -> u32 {
    added_count = 0u;
    patch_count = 0u;
    patch_is = ALONG_NORMAL;
    if (next_half > half_count) {
        close(next_half - half_count);
        return NOTHING;
    }
    begin_pair(Body(PRISM, vec3f(), 0.0, reach_of_prism(), NONE), second, turn, terrain_offset - triangle_origin);
    if (second.kind == SPHERE && ball_on_triangle()) {
        return NOTHING;
    }
    // Directions that may separate, the normal between them, and the points of the body that are furthest against them.
    var ways = array<vec3f, 3>(offset_b - (triangle[0] + triangle[1] + triangle[2]) / 3.0, triangle_normal, apart_along);
    var nearest = array<vec3f, 3>();
    for (var k = 0u; k < bound(3u); k++) {
        let local = -(ways[k] * turn_b);
        nearest[k] = turn_b * support(body_b, local, local) + offset_b;
    }
    if (separates(ways[0], nearest[0])) {
        return NOTHING;
    }
    let lowest = nearest[1];
    let height = dot(triangle_normal, lowest);
    face_distance = height - body_b.radius;
    if (face_distance > terrain_range) {
        return NOTHING;
    }
    find_face_contacts(terrain_range);
    // No deeper than the deepest distance so far: then only the face itself or a convex feature can add contacts.
    if (face_distance >= deepest.distance - terrain_tolerance && (face_touches || is_hollow())) {
        add_list(thread_field(TERRAIN_FACE), face_list_count, COUNTED, -UNMOVABLE);
        return NOTHING;
    }
    if (separates(ways[2], nearest[2])) {
        return NOTHING;
    }
    // Deep within its walls: then no depth of the prism is smaller than through its face.
    if (triangle_surrounds(lowest - triangle_normal * max(height, 0.0), max(-height, 0.0))) {
        deepest = deeper(deepest, contact_below(lowest));
        add_list(thread_field(TERRAIN_FACE), face_list_count, COUNTED, -UNMOVABLE);
        return NOTHING;
    }
    // A convex edge or vertex touches along one normal with all of the prisms around it.
    for (var k = 0u; k < feature_count; k++) {
        if (has_feature(features[k])) {
            best = features[k].gap;
            patch_is = KNOWN;
            return SHARED;
        }
    }
    return SEARCH;
}

// Decides what the largest gap of a triangle, in `best`, means. Whether its patch is needed.
fn classify() -> bool {
    if (patch_is == KNOWN) {
        return true;
    }
    if (length(best.normal - triangle_normal) <= FACE_NORMAL_RATIO * SAME_DIRECTION) {
        patch_is = ALONG_NORMAL;
        return true;
    }
    if (admits_normal(feature_of_triangle(best))) {
        patch_is = ADMITTED;
        return true;
    }
    patch_is = REJECTED;
    if (face_touches) {
        shallowest = max(shallowest, face_distance);
    }
    add_list(thread_field(TERRAIN_FACE), face_list_count, PROVISIONAL, -UNMOVABLE);
    return best.gap - body_b.radius < rejected.distance;
}

// Lists a contact of the present triangle's patch; a patch has fewer than there is room for.
fn add_to_patch(point: TerrainPoint) {
    if (patch_count < PATCH_LIST_POINTS) {
        put_terrain_point(thread_field(TERRAIN_PATCH) + TERRAIN_POINT_SIZE * patch_count, point);
        patch_count++;
    }
}

// Takes the patch of a triangle, if it has one, and adds what the round has listed to a manifold.
fn end_round() {
    for (var k = 0u; k < patch_count; k++) {
        let point = terrain_point(thread_field(TERRAIN_PATCH) + TERRAIN_POINT_SIZE * k);
        if (patch_is == REJECTED) {
            rejected = deeper(rejected, point);
        } else if (patch_is != KNOWN) {
            deepest = deeper(deepest, point);
        }
    }
    if (patch_count > 0u && patch_is == ALONG_NORMAL && face_touches) {
        add_list(thread_field(TERRAIN_FACE), face_list_count, COUNTED, -UNMOVABLE);
    } else if (patch_count > 0u && patch_is != REJECTED) {
        add_list(thread_field(TERRAIN_PATCH), patch_count, COUNTED, -UNMOVABLE);
        // Where there is no more room it is found again.
        if (patch_is != KNOWN && feature_count < MAX_FEATURES) {
            features[feature_count] = feature_of_triangle(best);
            feature_count++;
        }
    }
    for (var k = 0u; k < added_count; k++) {
        let point = terrain_point(added_from + TERRAIN_POINT_SIZE * k);
        if (point.distance >= added_least) {
            add_to_manifold(added_to, point);
        }
    }
}

// The rounds after the triangles leave all contacts in the manifold of those that count. The body is in the field at least as deep as
// in any prism.
fn close(round: u32) {
    if (round == 1u) {
        var least = deepest.distance;
        if (rejected.distance < UNMOVABLE) {
            least = min(least, rejected.distance * FACE_DEPTH_RATIO);
        }
        if (deepest.distance == UNMOVABLE) {
            least = min(least, shallowest);
        }
        add_list(manifold_point(PROVISIONAL, 0u), manifold_counts[PROVISIONAL], COUNTED, least - terrain_tolerance);
        return;
    }
    // Contacts that no face has: a corner in a groove, or a body between faces.
    var witness = deepest;
    if (round == 3u) {
        witness = rejected;
    }
    if (witness.distance < UNMOVABLE && deepest_of_manifold() > witness.distance + terrain_tolerance) {
        put_terrain_point(thread_field(TERRAIN_PATCH), witness);
        add_list(thread_field(TERRAIN_PATCH), 1u, COUNTED, -UNMOVABLE);
    }
}

// Gives the contacts that count to the pool; `a` is the field.
fn end_terrain(pair: u32, a: Placed) {
    for (var k = 0u; k < manifold_counts[COUNTED]; k++) {
        let point = terrain_point(manifold_point(COUNTED, k));
        let normal = a.axes * point.normal;
        add_contact(pair, point.distance, a.center + a.axes * point.position, normal, tangent_from_normal(normal));
    }
}
