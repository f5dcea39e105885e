// The contact manifold on terrain: coplanar points are replaced by the corners of their convex hull, and those nearest
// to each other are dropped beyond the capacity. CPU counterpart:
// `clench-collide/src/narrow/convex/terrain/manifold.rs`.
//
// The environment's memory holds two manifolds: of contacts that count, and of those whose depth may not be the
// smallest.

const COUNTED: u32 = 0u;
const PROVISIONAL: u32 = 1u;
// Directions within this angle are equal, rad.
const SAME_DIRECTION: f32 = max(1e-6, 100.0 * EPSILON);
// The points of a facet, including a new one.
const FACET_POINTS: u32 = PATCH_POINTS + 1u;

// A contact in the field's frame.
struct TerrainPoint {
    position: vec3f,
    normal: vec3f,
    distance: f32,
}

var<private> manifold_counts: array<u32, 2>;
// The size of the body, and the tolerance of distances, m.
var<private> terrain_size: f32;
var<private> terrain_tolerance: f32;

// The coplanar points of the terrain and a new one; their positions across the normal; the indices of their hull.
var<private> facet: array<TerrainPoint, FACET_POINTS>;
var<private> facet_count: u32;
var<private> facet_at: array<vec2f, FACET_POINTS>;
var<private> facet_hull: array<u32, 2u * FACET_POINTS + 2u>;
var<private> facet_hull_count: u32;

fn terrain_point(offset: u32) -> TerrainPoint {
    return TerrainPoint(fetch3(offset), fetch3(offset + 3u), fetch(offset + 6u));
}

fn put_terrain_point(offset: u32, point: TerrainPoint) {
    put3(offset, point.position);
    put3(offset + 3u, point.normal);
    put(offset + 6u, point.distance);
}

// Returns the offset of a point of a manifold.
fn manifold_point(manifold: u32, k: u32) -> u32 {
    return thread_field(TERRAIN) + TERRAIN_POINT_SIZE * (manifold * (MAX_TERRAIN_POINTS + 1u) + k);
}

// Returns the distance of the deepest point that counts.
fn deepest_of_manifold() -> f32 {
    var least = UNMOVABLE;
    for (var k = 0u; k < manifold_counts[COUNTED]; k++) {
        least = min(least, fetch(manifold_point(COUNTED, k) + 6u));
    }
    return least;
}

// Returns the point of a contact on the terrain.
fn ground_of(point: TerrainPoint) -> vec3f {
    return point.position - point.normal * (point.distance * 0.5);
}

fn is_on_plane(p: TerrainPoint, point: TerrainPoint) -> bool {
    let rotation = p.normal - point.normal;
    let apart = abs(dot(ground_of(p) - ground_of(point), point.normal));
    return dot(rotation, rotation) <= SAME_DIRECTION * SAME_DIRECTION && apart <= terrain_size * MANIFOLD_SAME_POINT;
}

fn is_same_point(p: TerrainPoint, q: TerrainPoint) -> bool {
    let apart = p.position - q.position;
    let same = terrain_size * MANIFOLD_SAME_POINT;
    return dot(apart, apart) <= same * same;
}

// Returns true if a point is within the area of the facet, or on one of its points, and no deeper.
fn is_redundant(point: TerrainPoint) -> bool {
    var least = UNMOVABLE;
    var twin = NONE;
    var within = facet_count > 2u;
    var start = facet[max(facet_count, 1u) - 1u].position;
    for (var k = 0u; k < facet_count; k++) {
        let other = facet[k];
        least = min(least, other.distance);
        if (twin == NONE && is_same_point(other, point)) {
            twin = k;
        }
        let side = other.position - start;
        let size = max(abs(side.x), max(abs(side.y), abs(side.z)));
        let rotation = dot(cross(side, point.position - start), other.normal);
        within = within && rotation >= -terrain_size * MANIFOLD_SAME_POINT * size;
        start = other.position;
    }
    if (point.distance < least - terrain_tolerance) {
        return false;
    }
    if (twin != NONE) {
        return facet[twin].distance <= point.distance + terrain_tolerance;
    }
    return within;
}

// Adds a point to a manifold, unless it is redundant.
fn add_to_manifold(manifold: u32, point: TerrainPoint) {
    // The points on its plane are adjacent, in order around their area.
    let count = manifold_counts[manifold];
    var start = 0u;
    while (start < count && !is_on_plane(terrain_point(manifold_point(manifold, start)), point)) {
        start++;
    }
    facet_count = 0u;
    while (start + facet_count < count && facet_count < PATCH_POINTS) {
        let other = terrain_point(manifold_point(manifold, start + facet_count));
        if (!is_on_plane(other, point)) {
            break;
        }
        facet[facet_count] = other;
        facet_count++;
    }
    if (is_redundant(point)) {
        return;
    }
    // The facet is removed from the manifold and appended at its end.
    var left = start;
    for (var k = start + facet_count; k < count; k++) {
        put_terrain_point(manifold_point(manifold, left), terrain_point(manifold_point(manifold, k)));
        left++;
    }
    // A coincident point is less deep.
    var kept = 0u;
    for (var k = 0u; k < facet_count; k++) {
        if (!is_same_point(facet[k], point)) {
            facet[kept] = facet[k];
            kept++;
        }
    }
    facet[kept] = point;
    facet_count = kept + 1u;
    find_corners_of_facet();
    for (var k = 0u; k < facet_hull_count; k++) {
        put_terrain_point(manifold_point(manifold, left), facet[facet_hull[k]]);
        left++;
        if (left > MAX_TERRAIN_POINTS) {
            thin_out(manifold);
            left--;
        }
    }
    manifold_counts[manifold] = left;
}

// Finds the hull of the facet: the corners of the area of its points, and the deepest of them.
fn find_corners_of_facet() {
    facet_hull_count = 0u;
    if (facet_count < 3u) {
        for (var k = 0u; k < facet_count; k++) {
            push_to_hull(k);
        }
        return;
    }
    sort_facet();
    let lowest = deepest_of_facet();
    for (var pass_index = 0u; pass_index < bound(2u); pass_index++) {
        let begin = facet_hull_count;
        for (var k = 0u; k < facet_count; k++) {
            extend_hull(begin, select(k, facet_count - 1u - k, pass_index == 1u));
        }
        // The last point begins the second chain, whose last began the first.
        facet_hull_count = max(facet_hull_count - 1u, begin + pass_index);
    }
    var has_deepest = false;
    for (var k = 0u; k < facet_hull_count; k++) {
        has_deepest = has_deepest || facet[facet_hull[k]].distance <= facet[lowest].distance + terrain_tolerance;
    }
    if (!has_deepest) {
        for (var k = facet_hull_count; k > 0u; k--) {
            facet_hull[k] = facet_hull[k - 1u];
        }
        facet_hull[0] = lowest;
        facet_hull_count++;
    }
    while (facet_hull_count > PATCH_POINTS) {
        remove_least_corner();
    }
}

fn push_to_hull(k: u32) {
    facet_hull[facet_hull_count] = k;
    facet_hull_count++;
}

// Sorts the points of the facet along the first direction across the normal, then along the second.
fn sort_facet() {
    let frame = across(facet[0].normal);
    for (var k = 0u; k < facet_count; k++) {
        let point = facet[k];
        let at = vec2f(dot(frame.e, point.position), dot(frame.f, point.position));
        var index = k;
        while (index > 0u) {
            let before = facet_at[index - 1u];
            if (before.x < at.x || (before.x == at.x && before.y <= at.y)) {
                break;
            }
            facet[index] = facet[index - 1u];
            facet_at[index] = before;
            index--;
        }
        facet[index] = point;
        facet_at[index] = at;
    }
}

// Adds a point to the convex chain from `begin` on (Andrew 1979): no point lies to its right. Nearly collinear points
// are dropped.
fn extend_hull(begin: u32, k: u32) {
    let at = facet_at[k];
    while (facet_hull_count >= begin + 2u) {
        let p = facet_at[facet_hull[facet_hull_count - 2u]];
        let q = facet_at[facet_hull[facet_hull_count - 1u]];
        if (cross_2d(q - p, at - p) > terrain_size * MANIFOLD_SAME_POINT * length(at - p)) {
            break;
        }
        facet_hull_count--;
    }
    push_to_hull(k);
}

// Returns the first of the deepest points of the facet, to the tolerance.
fn deepest_of_facet() -> u32 {
    var lowest = 0u;
    for (var k = 1u; k < facet_count; k++) {
        if (facet[k].distance < facet[lowest].distance - terrain_tolerance) {
            lowest = k;
        }
    }
    return lowest;
}

// Removes the corner of the hull that spans the smallest triangle with its neighbours, except the deepest.
fn remove_least_corner() {
    var lowest = 0u;
    for (var k = 1u; k < facet_hull_count; k++) {
        if (facet[facet_hull[k]].distance < facet[facet_hull[lowest]].distance - terrain_tolerance) {
            lowest = k;
        }
    }
    var least = UNMOVABLE;
    var removed = 0u;
    for (var k = 0u; k < facet_hull_count; k++) {
        let p = facet_at[facet_hull[select(k, facet_hull_count, k == 0u) - 1u]];
        let q = facet_at[facet_hull[k]];
        let r = facet_at[facet_hull[select(k + 1u, 0u, k + 1u == facet_hull_count)]];
        let area = abs(cross_2d(q - p, r - p));
        if (k != lowest && area < least) {
            least = area;
            removed = k;
        }
    }
    facet_hull_count--;
    for (var k = removed; k < facet_hull_count; k++) {
        facet_hull[k] = facet_hull[k + 1u];
    }
}

// Removes one of the two nearest points if there is one more than the maximum: the shallower, among equals the one
// nearer to the centre.
fn thin_out(manifold: u32) {
    let count = MAX_TERRAIN_POINTS + 1u;
    var nearest = UNMOVABLE;
    var pair = vec2u(0u, 1u);
    var middle_of_all = vec3f();
    for (var i = 0u; i < count; i++) {
        let p = terrain_point(manifold_point(manifold, i));
        middle_of_all += p.position;
        for (var j = i + 1u; j < count; j++) {
            let q = terrain_point(manifold_point(manifold, j));
            let rotation = (p.normal - q.normal) * terrain_size;
            let apart = p.position - q.position;
            let distance = dot(apart, apart) + dot(rotation, rotation);
            if (distance < nearest) {
                nearest = distance;
                pair = vec2u(i, j);
            }
        }
    }
    middle_of_all /= f32(count);
    let p = terrain_point(manifold_point(manifold, pair.x));
    let q = terrain_point(manifold_point(manifold, pair.y));
    let deeper = q.distance - p.distance;
    let out = vec2f(length(p.position - middle_of_all), length(q.position - middle_of_all));
    let removes_first = select((out.x < out.y), (deeper < 0.0), (abs(deeper) > terrain_tolerance));
    for (var k = select(pair.y, pair.x, removes_first); k + 1u < count; k++) {
        put_terrain_point(manifold_point(manifold, k), terrain_point(manifold_point(manifold, k + 1u)));
    }
}
