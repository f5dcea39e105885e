// The points of a contact: the overlap of two bodies' features, projected along the normal. CPU counterparts:
// `clench-collide/src/narrow/convex/overlap.rs` and `patch.rs`.

// Contacts in the projection: the position across the normal, and the heights of both surfaces.
var<private> spots: array<vec4f, POLYGON_CORNERS + 1>;
var<private> spot_count: u32;

fn spot_distance(spot: vec4f) -> f32 {
    return spot.w - spot.z;
}

// Returns the spot with another distance.
fn at_distance(spot: vec4f, distance: f32) -> vec4f {
    let level = (spot.z + spot.w) * 0.5;
    return vec4f(spot.xy, level - 0.5 * distance, level + 0.5 * distance);
}

// The vertex along the normal of the largest gap. The nearest points of the cores are its points if they face each
// other, else those of the simplex.
var<private> touching_vertex: Vertex;
// True if a search by support functions found the gap.
var<private> searched: bool;

// Returns true if the support points along the normal face each other.
fn is_facing(n: vec3f) -> bool {
    return length(touching_vertex.w - n * best.gap) <= smallest * PATCH_MISS;
}

// Weighs the vertices of a triangle so that their sum is the point of its plane nearest to the origin. The point may
// lie beyond the triangle, which is half of the face that two edges span. Returns false for bodies other than
// overlapping polyhedra, or if the point is too far away for that.
fn weigh_face() -> bool {
    if (simplex_count != 3u || best.gap >= 0.0 || on_terrain || is_curved(body_a) || is_curved(body_b)) {
        return false;
    }
    let corner = simplex[0].w;
    let first = simplex[1].w - corner;
    let second = simplex[2].w - corner;
    let normal = cross(first, second);
    let inverse = 1.0 / max(dot(normal, normal), SMALLEST);
    let share = vec2f(dot(cross(second, corner), normal), dot(cross(corner, first), normal)) * inverse;
    let rest = 1.0 - share.x - share.y;
    if (min(rest, min(share.x, share.y)) < -1.0) {
        return false;
    }
    weights[0] = rest;
    weights[1] = share.x;
    weights[2] = share.y;
    return true;
}

fn witness(view: mat3x3f, n: vec3f) -> vec4f {
    let vertex = touching_vertex;
    var on_a = vertex.a;
    var on_b = vertex.b;
    if (!is_facing(n)) {
        if (!weigh_face()) {
            let count = simplex_count;
            simplex_count = 1u;
            weights[0] = 1.0;
            for (var k = 1u; k < count; k++) {
                add_vertex(simplex[k]);
            }
        }
        on_a = vec3f();
        on_b = vec3f();
        for (var k = 0u; k < simplex_count; k++) {
            on_a += simplex[k].a * weights[k];
            on_b += simplex[k].b * weights[k];
        }
    }
    let level = view * ((on_a + offset_b + rotation_b * on_b) * 0.5);
    return at_distance(vec4f(level.xy, level.z, level.z), best.gap);
}

// Returns the contact at a point of the projection of two features.
fn spot_at(a: Projected, b: Projected, p: vec2f) -> vec4f {
    let on_a = height_of(a, p);
    // Just beyond a corner the features' planes continue, but the bodies do not.
    return vec4f(p, on_a, max(height_of(b, p), on_a + best.gap));
}

fn least_distance() -> f32 {
    var least = UNMOVABLE;
    for (var k = 0u; k < spot_count; k++) {
        least = min(least, spot_distance(spots[k]));
    }
    return least;
}

// Returns the first spot whose distance is the least, to the tolerance.
fn deepest_spot(least: f32) -> u32 {
    var deepest = 0u;
    while (deepest + 1u < spot_count && spot_distance(spots[deepest]) > least + exactness) {
        deepest++;
    }
    return deepest;
}

// Fills the spots with the corners of the overlap of two features, and returns the least distance.
fn find_spots(a: Projected, b: Projected, beyond: f32) -> f32 {
    overlap(a, b, beyond);
    spot_count = polygon_count;
    for (var k = 0u; k < spot_count; k++) {
        spots[k] = spot_at(a, b, polygon_corner(k).xy);
    }
    return least_distance();
}

// Replaces many spots by points of the outline, with `first` the direction of the first: all corners if they fit a
// patch. If these miss the lowest spot by more than `slack`, the outline is sampled from its direction, and it is one
// of them.
fn sample_spots(a: Projected, b: Projected, first: vec2f, lowest: vec4f, slack: f32) {
    let same = smallest * PATCH_SAME_POINT;
    make_convex(same);
    find_moments();
    let few = polygon_count <= PATCH_POINTS;
    var toward = first;
    for (var attempt = 0u; attempt < bound(2u); attempt++) {
        if (few && attempt == 0u) {
            sampled_count = polygon_count;
            for (var k = 0u; k < sampled_count; k++) {
                sampled[k] = polygon_corner(k).xy;
            }
        } else {
            sample_outline(toward, same);
        }
        spot_count = sampled_count;
        for (var k = 0u; k < spot_count; k++) {
            spots[k] = spot_at(a, b, sampled[k]);
        }
        if (attempt == 1u) {
            spots[0] = lowest;
        } else if (least_distance() - spot_distance(lowest) <= slack) {
            break;
        } else if (few && spot_count < PATCH_POINTS) {
            spots[spot_count] = lowest;
            spot_count++;
            break;
        }
        toward = lowest.xy - outline_middle;
    }
    // The remaining difference is too small to move a point, but is still reported.
    let least = least_distance();
    for (var k = 0u; k < spot_count; k++) {
        if (spot_distance(spots[k]) <= least) {
            spots[k] = at_distance(spots[k], min(least, spot_distance(lowest)));
            break;
        }
    }
}

// Keeps the deepest of coincident spots, among those within reach.
fn merge_spots(reach: f32) {
    let same = smallest * PATCH_SAME_POINT;
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

// Adds a contact of a pair; its middle is in the first body's frame.
fn add_in_frame(pair: u32, a: Placed, middle_of_contact: vec3f, normal: vec3f, distance: f32, tangent: vec3f) {
    add_contact(pair, distance, a.center + a.axes * middle_of_contact, normal, tangent);
}

// Returns the start direction of many spots, which rotates with a body: to the first corner of a round cap, or along
// the first edge.
fn first_direction(a: Projected, b: Projected) -> vec2f {
    var cap = a;
    if (is_cap(b) && !is_cap(a)) {
        cap = b;
    }
    if (is_cap(cap)) {
        // From the opposite corner to the first; those of the second body are in reverse order.
        let start = cap.offset + select(0u, CAP_CORNERS - 1u, cap.offset > 0u);
        let opposite = cap.offset + select(CAP_CORNERS / 2u, CAP_CORNERS / 2u - 1u, cap.offset > 0u);
        return (feature_corners[start] - feature_corners[opposite]).xy;
    }
    return (feature_corners[a.offset + 1u] - feature_corners[a.offset]).xy;
}

// Adds the contacts of two features that are both more than a corner.
fn add_patch(pair: u32, a: Placed, n: vec3f, of_a: Feature, of_b: Feature, range: f32) {
    let frame = across(n);
    let view = transpose(mat3x3f(frame.e, frame.f, n));
    for (var k = 0u; k < of_a.count; k++) {
        feature_corners[k] = view * feature_corners[k];
    }
    // The normal points out of the second body's feature, which reverses the order of its corners.
    let first_of_b = FEATURE_CORNERS;
    let last_of_b = FEATURE_CORNERS + of_b.count - 1u;
    for (var k = 0u; 2u * k < of_b.count; k++) {
        let p = feature_corners[first_of_b + k];
        let q = feature_corners[last_of_b - k];
        feature_corners[first_of_b + k] = view * (offset_b + rotation_b * q);
        feature_corners[last_of_b - k] = view * (offset_b + rotation_b * p);
    }
    let first = project_feature(0u, of_a, view, vec3f());
    let second = project_feature(FEATURE_CORNERS, of_b, view * rotation_b, view * offset_b);

    let slack = max(smallest * PATCH_MISS, exactness);
    // The normal of a gap that is the largest up to the tolerance may be that of features which miss each other by the
    // root of the tolerance.
    let may_extend = !searched && !is_facing(n);
    let far = smallest * PATCH_MAX_EXTENSION;
    var least = UNMOVABLE;
    var beyond: f32 = 0.0;
    loop {
        least = find_spots(first, second, beyond);
        let misses = least > best.gap + slack;
        // Bodies that touch with an edge touch at the border of a face, which rounding may miss.
        let wider = beyond < slack || (may_extend && (beyond < far || (spot_count == 0u && beyond < largest)));
        if (!(misses && wider)) {
            break;
        }
        if (beyond < slack) {
            beyond = select(slack, exactness, beyond == 0.0);
        } else {
            beyond *= PATCH_EXTENSION;
        }
    }
    let reach = range + body_a.radius + body_b.radius;
    let extended = beyond > slack;
    if (extended || least > best.gap + slack) {
        // The features miss the deepest point.
        var lowest = at_distance(spots[deepest_spot(least)], best.gap);
        if (!extended || spot_count == 0u) {
            lowest = witness(view, n);
        }
        for (var k = spot_count; k > 0u; k--) {
            spots[k] = spots[k - 1u];
        }
        spots[0] = lowest;
        spot_count++;
        least = spot_distance(lowest);
    }
    let deepest = deepest_spot(least);
    let lowest = spots[deepest];
    if (spot_distance(lowest) > reach) {
        // They touch by less than the features show.
        spots[0] = at_distance(lowest, best.gap);
        spot_count = 1u;
    } else if (MANY_CORNERS && spot_count > PATCH_POINTS) {
        sample_spots(first, second, first_direction(first, second), lowest, slack);
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

// Adds the contacts of a pair whose largest gap is in `best`; the simplex gives the nearest points of the cores if no
// feature does.
fn add_contacts(pair: u32, a: Placed, range: f32) {
    let n = direction(best.normal).xyz;
    let half = 0.5 * best.gap;
    let shift = 0.5 * (body_a.radius - body_b.radius);
    let distance = best.gap - body_a.radius - body_b.radius;
    if (body_a.kind == SPHERE) {
        // A sphere's frame is upright regardless of its orientation.
        add_contact(pair, distance, a.center + n * (half + shift), n, tangent_from_normal(n));
        return;
    }
    let normal = a.axes * n;
    let tangent = tangent_from_normal(normal);
    var features = array<Feature, 2>();
    for (var k = 0u; k < bound(2u); k++) {
        var body = body_a;
        var outward = n;
        if (k == 1u) {
            body = body_b;
            outward = -(transpose(rotation_b) * n);
        }
        features[k] = feature_of(body, outward, FEATURE_CORNERS * k);
    }
    let of_a = features[0];
    let of_b = features[1];
    let q = offset_b + rotation_b * feature_corners[FEATURE_CORNERS];
    var level = q - n * half;
    if (of_a.count == 1u) {
        level = feature_corners[0] + n * half;
        // A corner's position is exact whatever the normal.
        if (of_b.count == 1u && is_curved(body_a)) {
            level = (feature_corners[0] + q) * 0.5;
        }
    } else if (FLAT_PAIRS && of_b.count != 1u) {
        add_patch(pair, a, n, of_a, of_b, range);
        return;
    }
    add_in_frame(pair, a, level + n * shift, normal, distance, tangent);
}
