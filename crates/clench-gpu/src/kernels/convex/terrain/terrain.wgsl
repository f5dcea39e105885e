// Height fields against bounded convex shapes. CPU counterpart: `clench-collide/src/narrow/convex/terrain/mod.rs`,
// which explains it.
//
// Each triangle is a round of `convex`: the first body is the ground below it. The contacts of a round are listed in
// memory and added to a manifold at its end. Closing rounds after the triangles merge the remaining contacts.

// Rounds after the triangles: provisional contacts, then the deepest of those that count and of those that do not.
const CLOSING_ROUNDS: u32 = 3u;

// The work for a triangle: none, find its gap, or take the gap of a feature that it shares.
const NO_WORK: u32 = 0u;
const SEARCH: u32 = 1u;
const SHARED: u32 = 2u;

// The kind of a triangle's patch: of a direction that counts, along its normal or not; of one that does not; of a known
// feature.
const ALONG_NORMAL: u32 = 0u;
const ADMITTED: u32 = 1u;
const REJECTED: u32 = 2u;
const KNOWN: u32 = 3u;

// True if contacts are those of a triangle, to be listed.
var<private> on_terrain: bool;
var<private> terrain_offset: vec3f;
// The range of the search, which may grow up to a limit.
var<private> terrain_range: f32;
var<private> terrain_limit: f32;
var<private> search_begins: bool;
// Contacts with the least distance along directions that count and that do not.
var<private> deepest: TerrainPoint;
var<private> rejected: TerrainPoint;
// The largest distance along normals of faces with provisional contacts.
var<private> shallowest: f32;
// The next half of a cell of the window, their number, and whether any is near the body; afterwards, the closing round.
var<private> next_half: u32;
var<private> half_count: u32;
var<private> any_is_near: bool;
// The direction that separated the last triangle's ground from the body.
var<private> apart_along: vec3f;
var<private> features: array<TerrainFeature, TERRAIN_MAX_FEATURES>;
var<private> feature_count: u32;
var<private> patch_count: u32;
var<private> patch_is: u32;
// The current triangle's distance along its normal.
var<private> face_distance: f32;
// The list of points that the round adds to a manifold, if they are not deeper than a limit.
var<private> added_from: u32;
var<private> added_count: u32;
var<private> added_to: u32;
var<private> added_least: f32;

// Begins with a body at `offset` in the field's frame. A distance is searched among near cells first, as
// `clench-collide/src/distance.rs` does. No point of the field is further away than the sum.
fn begin_terrain(pair: u32, geom: u32, body: Body, offset: vec3f, range: f32) {
    begin_grid(words[GEOM_HULL + geom]);
    terrain_size = body.reach;
    terrain_tolerance = max((body.reach + length(offset)) * EPSILON * 64.0, body.reach * 1e-9);
    terrain_offset = offset;
    terrain_limit = range;
    terrain_range = range;
    if (MEASURES_TERRAIN && pair >= NPAIR) {
        let furthest = grid.radius + body.reach + length(offset);
        terrain_limit = min(range, furthest);
        terrain_range = min(max(body.reach, furthest * TERRAIN_LEAST_SEARCH), terrain_limit);
    }
    search_begins = true;
}

// Begins a search within the range.
fn begin_search(body: Body, rotation: mat3x3f) {
    search_begins = false;
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
    if (begin_bounds(body, rotation, terrain_offset, body.radius + terrain_range + terrain_tolerance)) {
        // The cell below the lowest point comes first: the deepest contact saves much of the remaining work.
        half_count = 2u * (1u + u32(window_size.x * window_size.y));
    }
}

// Advances to the next triangle near the body, or closing round. Returns true if there is one.
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

// Reduces the range of a distance to the least one so far: what is further away does not matter.
fn narrow_search(pair: u32) {
    let least = min(deepest.distance, rejected.distance) + 2.0 * terrain_tolerance;
    if (MEASURES_TERRAIN && pair >= NPAIR && least > 2.0 * terrain_tolerance && least < terrain_range) {
        narrow_bounds(terrain_range - least);
        terrain_range = least;
        // A search that found something is the last one.
        terrain_limit = least;
    }
}

// Ends a search. Returns true if it found nothing and a larger range remains, in which the next one begins.
fn widens_search() -> bool {
    if (!MEASURES_TERRAIN || manifold_counts[COUNTED] > 0u || terrain_range >= terrain_limit) {
        return false;
    }
    terrain_range = min(terrain_range * TERRAIN_SEARCH_GROWTH, terrain_limit);
    search_begins = true;
    return true;
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

// Returns true if a direction separates the ground from the body, whose point nearest to the ground along it is given.
fn separates(n: vec3f, nearest: vec3f) -> bool {
    // Downwards, the prism's bottom would need to be considered too.
    if (n.z <= 0.0) {
        return false;
    }
    let gap = dot(n, nearest) - max(dot(n, triangle[0]), max(dot(n, triangle[1]), dot(n, triangle[2])));
    let reach = terrain_range + body_b.radius;
    return gap > 0.0 && gap * gap > reach * reach * dot(n, n);
}

// Finds the contact of a triangle and a ball with its centre above it. Returns false if it could not: a centre below
// the nearest point of the triangle may be nearer to the walls.
fn ball_on_triangle() -> bool {
    for (var k = 0u; k < bound(3u); k++) {
        simplex[k].w = triangle[k] - offset_b;
    }
    let near = nearest_on_triangle(0u, 1u, 2u);
    let toward = direction(-near.point);
    let normal = toward.xyz;
    let gap = toward.w;
    if (!(normal.z > 0.0 && gap > terrain_tolerance * TERRAIN_CLEAR)) {
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

// Makes the triangle of a round the first body, and does the work that does not need the gap between the two. Returns
// the remaining work.
fn begin_round(second: Body, rotation: mat3x3f) -> u32 {
    added_count = 0u;
    patch_count = 0u;
    patch_is = ALONG_NORMAL;
    if (next_half > half_count) {
        close(next_half - half_count);
        return NO_WORK;
    }
    begin_pair(Body(PRISM, vec3f(), 0.0, reach_of_prism(), NONE), second, rotation, terrain_offset - triangle_origin);
    if (second.kind == SPHERE && ball_on_triangle()) {
        return NO_WORK;
    }
    // Candidate separating directions, with the normal second, and the points of the body furthest against them.
    var directions = array<vec3f, 3>(offset_b - (triangle[0] + triangle[1] + triangle[2]) / 3.0, triangle_normal, apart_along);
    var nearest = array<vec3f, 3>();
    for (var k = 0u; k < bound(3u); k++) {
        let local = -(directions[k] * rotation_b);
        nearest[k] = rotation_b * support(body_b, local, local) + offset_b;
    }
    if (separates(directions[0], nearest[0])) {
        return NO_WORK;
    }
    let lowest = nearest[1];
    let height = dot(triangle_normal, lowest);
    face_distance = height - body_b.radius;
    if (face_distance > terrain_range) {
        return NO_WORK;
    }
    find_face_contacts(terrain_range);
    // No deeper than the deepest contact so far: only the face itself or a convex feature can add contacts.
    if (face_distance >= deepest.distance - terrain_tolerance && (face_touches || is_hollow())) {
        add_list(thread_field(TERRAIN_FACE), face_list_count, COUNTED, -UNMOVABLE);
        return NO_WORK;
    }
    if (separates(directions[2], nearest[2])) {
        return NO_WORK;
    }
    // Deep within its walls: no depth of the prism is smaller than through its face.
    if (triangle_surrounds(lowest - triangle_normal * max(height, 0.0), max(-height, 0.0))) {
        deepest = deeper(deepest, contact_below(lowest));
        add_list(thread_field(TERRAIN_FACE), face_list_count, COUNTED, -UNMOVABLE);
        return NO_WORK;
    }
    // A convex edge or vertex touches along the same normal in all adjacent prisms.
    for (var k = 0u; k < feature_count; k++) {
        if (has_feature(features[k])) {
            best = features[k].gap;
            patch_is = KNOWN;
            return SHARED;
        }
    }
    return SEARCH;
}

// Classifies the largest gap of a triangle, in `best`. Returns true if its patch is needed.
fn classify() -> bool {
    if (patch_is == KNOWN) {
        return true;
    }
    if (length(best.normal - triangle_normal) <= TERRAIN_FACE_NORMAL_RATIO * SAME_DIRECTION) {
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

// Lists a contact of the current triangle's patch, which has fewer than the capacity.
fn add_to_patch(point: TerrainPoint) {
    if (patch_count < PATCH_LIST_POINTS) {
        put_terrain_point(thread_field(TERRAIN_PATCH) + TERRAIN_POINT_SIZE * patch_count, point);
        patch_count++;
    }
}

// Processes the patch of a triangle, if any, and adds the round's list to a manifold.
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
        // Without capacity it is found again.
        if (patch_is != KNOWN && feature_count < TERRAIN_MAX_FEATURES) {
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

// Runs a closing round; they leave all contacts in the manifold of those that count. The body is at least as deep in
// the field as in any prism.
fn close(round: u32) {
    if (round == 1u) {
        var least = deepest.distance;
        if (rejected.distance < UNMOVABLE) {
            least = min(least, rejected.distance * TERRAIN_FACE_DEPTH_RATIO);
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

// Adds the contacts that count to the pool; `a` is the field.
fn end_terrain(pair: u32, a: Placed) {
    for (var k = 0u; k < manifold_counts[COUNTED]; k++) {
        let point = terrain_point(manifold_point(COUNTED, k));
        let normal = a.axes * point.normal;
        add_contact(pair, point.distance, a.center + a.axes * point.position, normal, tangent_from_normal(normal));
    }
}
