// The points of a contact: where the features of two bodies overlap, seen along the normal. Sister of
// `clench-collide/src/narrow/convex/patch.rs`.

// Shares of the smaller body: points nearer to each other are one; a patch may miss the deepest point by so much.
const SAME_SPOT: f32 = 1e-5;
const MISSED: f32 = 1e-6;

// Contacts in the projection: where each is across the normal, and the heights of both surfaces.
var<private> spots: array<vec4f, 13>;
var<private> spot_count: u32;

fn spot_distance(spot: vec4f) -> f32 {
    return spot.w - spot.z;
}

// The same with another distance.
fn at_distance(spot: vec4f, distance: f32) -> vec4f {
    let level = (spot.z + spot.w) * 0.5;
    return vec4f(spot.xy, level - 0.5 * distance, level + 0.5 * distance);
}

// The nearest points of the cores: those that support the normal if they face each other, else as the simplex has them.
fn witness(view: mat3x3f, n: vec3f) -> vec4f {
    let vertex = vertex_along(n);
    var on_a = vertex.a;
    var on_b = vertex.b;
    if (length(vertex.w - n * best.gap) > smallest * MISSED) {
        let count = simplex_count;
        simplex_count = 1u;
        weights[0] = 1.0;
        for (var k = 1u; k < count; k++) {
            add_vertex(simplex[k]);
        }
        on_a = vec3f();
        on_b = vec3f();
        for (var k = 0u; k < simplex_count; k++) {
            on_a += simplex[k].a * weights[k];
            on_b += simplex[k].b * weights[k];
        }
    }
    let level = view * ((on_a + offset_b + turn_b * on_b) * 0.5);
    return at_distance(vec4f(level.xy, level.z, level.z), best.gap);
}

// Fills the spots with the corners of the overlap of two features, and gives the deepest distance among them.
fn find_spots(a: Projected, b: Projected, beyond: f32) -> f32 {
    overlap(a, b, beyond);
    var least = UNMOVABLE;
    for (var k = 0u; k < polygon_count; k++) {
        let on_a = height_of(a, polygon[k].xy);
        // Just beyond a corner the features' planes go on, but the bodies do not.
        let on_b = max(height_of(b, polygon[k].xy), on_a + best.gap);
        spots[k] = vec4f(polygon[k].xy, on_a, on_b);
        least = min(least, on_b - on_a);
    }
    spot_count = polygon_count;
    return least;
}

// Leaves one of spots that coincide, the deepest, of those that are within reach.
fn merge_spots(reach: f32) {
    let same = smallest * SAME_SPOT;
    var kept = 0u;
    for (var k = 0u; k < spot_count; k++) {
        let spot = spots[k];
        if (spot_distance(spot) > reach) {
            continue;
        }
        var twin = kept;
        for (var other = 0u; other < kept; other++) {
            let apart = spots[other].xy - spot.xy;
            if (twin == kept && dot(apart, apart) <= same * same) {
                twin = other;
            }
        }
        if (twin == kept) {
            kept++;
            spots[twin] = spot;
        } else if (spot_distance(spot) < spot_distance(spots[twin])) {
            spots[twin] = spot;
        }
    }
    spot_count = kept;
}

// Adds a contact of a pair whose middle is in the first body's frame.
fn add_in_frame(pair: u32, a: Placed, middle_of_contact: vec3f, normal: vec3f, distance: f32, tangent: vec3f) {
    add_contact(pair, distance, a.center + a.axes * middle_of_contact, normal, tangent);
}

// The contacts of two features that are both more than a corner.
fn add_patch(pair: u32, a: Placed, n: vec3f, of_a: Feature, of_b: Feature, range: f32) {
    let frame = across(n);
    let view = transpose(mat3x3f(frame.e, frame.f, n));
    for (var k = 0u; k < of_a.count; k++) {
        feature_corners[k] = view * feature_corners[k];
    }
    // The normal points out of the second body's feature, which turns the order of its corners round.
    var turned = array<vec3f, 4>();
    for (var k = 0u; k < of_b.count; k++) {
        turned[of_b.count - 1u - k] = view * (offset_b + turn_b * feature_corners[MOST_CORNERS + k]);
    }
    for (var k = 0u; k < of_b.count; k++) {
        feature_corners[MOST_CORNERS + k] = turned[k];
    }
    let first = project_feature(0u, of_a.count, view * of_a.normal);
    let second = project_feature(MOST_CORNERS, of_b.count, view * (turn_b * of_b.normal));

    let slack = max(smallest * MISSED, exactness);
    var least = UNMOVABLE;
    // Bodies that touch with an edge touch at the border of a face, where rounding may miss it.
    for (var k = 0u; k < bound(3u); k++) {
        least = find_spots(first, second, select(select(slack, exactness, k == 1u), 0.0, k == 0u));
        if (least <= best.gap + slack) {
            break;
        }
    }
    let reach = range + body_a.radius + body_b.radius;
    if (least > best.gap + slack) {
        // The features miss the deepest point.
        for (var k = spot_count; k > 0u; k--) {
            spots[k] = spots[k - 1u];
        }
        spots[0] = witness(view, n);
        spot_count++;
    } else if (least > reach) {
        // They touch by less than the features tell.
        var deepest = 0u;
        while (deepest + 1u < spot_count && spot_distance(spots[deepest]) > least + exactness) {
            deepest++;
        }
        spots[0] = at_distance(spots[deepest], best.gap);
        spot_count = 1u;
    }
    merge_spots(reach);
    let normal = a.axes * n;
    let tangent = tangent_from_normal(normal);
    for (var k = 0u; k < spot_count; k++) {
        let low = spots[k].z + body_a.radius;
        let high = spots[k].w - body_b.radius;
        let level = vec3f(spots[k].xy, 0.5 * (low + high));
        add_in_frame(pair, a, transpose(view) * level, normal, high - low, tangent);
    }
}

// Adds the contacts of a pair whose largest gap is in `best`; the simplex tells the nearest points of the cores where no feature does.
fn add_contacts(pair: u32, a: Placed, range: f32) {
    let n = direction(best.normal).xyz;
    let half = 0.5 * best.gap;
    let shift = 0.5 * (body_a.radius - body_b.radius);
    let distance = best.gap - body_a.radius - body_b.radius;
    if (body_a.kind == SPHERE) {
        // Its frame is upright, however it is turned.
        add_contact(pair, distance, a.center + n * (half + shift), n, tangent_from_normal(n));
        return;
    }
    let normal = a.axes * n;
    let tangent = tangent_from_normal(normal);
    let of_a = feature_of(body_a, n, 0u);
    let of_b = feature_of(body_b, -(transpose(turn_b) * n), MOST_CORNERS);
    let q = offset_b + turn_b * feature_corners[MOST_CORNERS];
    var level = q - n * half;
    if (of_a.count == 1u) {
        level = feature_corners[0] + n * half;
        // A corner is where it is, however exact the normal.
        if (of_b.count == 1u && is_curved(body_a)) {
            level = (feature_corners[0] + q) * 0.5;
        }
    } else if (FLAT_PAIRS && of_b.count != 1u) {
        add_patch(pair, a, n, of_a, of_b, range);
        return;
    }
    add_in_frame(pair, a, level + n * shift, normal, distance, tangent);
}
