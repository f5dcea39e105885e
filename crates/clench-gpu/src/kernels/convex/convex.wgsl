// Any two bounded convex shapes, by their support functions. CPU counterpart:
// `clench-collide/src/narrow/convex/mod.rs`.

// Finds the largest gap between two cores, in `best`; returns false if the bodies are more than `range` apart.
fn find_largest_gap(range: f32) -> bool {
    let radii = body_a.radius + body_b.radius;
    let curved = CURVED_PAIRS && (is_curved(body_a) || is_curved(body_b));
    let start = start_direction();
    best = Gap(start, -UNMOVABLE, false);
    let how = gjk(range + radii);
    if (how == BEYOND) {
        return false;
    }
    let overlapping = how == INSIDE;
    if (overlapping) {
        if (!enclose()) {
            return best.gap - radii <= range;
        }
        begin_expansion(start);
    }
    // Newton's method has one call site: after the search, and whenever the expansion requests it.
    for (var round = 0u; round < bound(POLYTOPE_VERTICES); round++) {
        var done = true;
        if (overlapping) {
            done = expand(curved);
        }
        if (curved && !(overlapping && done && refined) && !best.is_exact) {
            find_edges();
            let improved = improve(refine(best.normal));
            refined = refined || improved;
        }
        if (done) {
            break;
        }
    }
    if (overlapping && !converged) {
        try_crossings();
    }
    return best.gap - radii <= range;
}

// Finds the largest gap of the two bodies, unless it is already in `best`, and begins a simplex there. Returns false if
// they are more than `range` apart.
fn find_touching(given_gap: bool, range: f32) -> bool {
    var certain = given_gap;
    var direct = Gap(vec3f(), -UNMOVABLE, false);
    if (ANY_CYLINDER_POLYHEDRON && has_creases(body_a, body_b)) {
        direct = polyhedron_gap(range);
    } else if (ANY_CYLINDER_PAIR && body_a.kind == CYLINDER && body_b.kind == CYLINDER) {
        direct = cylinders_gap();
    }
    if (direct.gap > range) {
        best = direct;
        return false;
    }
    // For separate bodies it gives no distance.
    if (direct.is_exact && direct.gap <= 0.0) {
        certain = true;
        best = direct;
    }
    if (!certain) {
        if (!find_largest_gap(range)) {
            return false;
        }
        certain = direct.gap > best.gap + exactness;
        if (certain) {
            best = direct;
        }
    }
    touching_vertex = vertex_along(best.normal);
    searched = !certain;
    if (certain) {
        begin_simplex(touching_vertex);
    }
    return true;
}

// Adds the contacts of a pair; `given_gap` if the largest gap is already in `best`, its normal in the first shape's
// frame. A height field is processed triangle by triangle: the long functions called here have only one call site.
fn convex(pair: u32, a: Placed, b: Placed, given_gap: bool, range: f32) {
    let geom = words[PAIR_GEOM + 2u * pair];
    let first = body_of(geom);
    let second = body_of(words[PAIR_GEOM + 2u * pair + 1u]);
    let back = transpose(a.axes);
    var rotation = back * b.axes;
    var offset = back * (b.center - a.center);
    if (first.kind == SPHERE) {
        rotation = b.axes;
        offset = b.center - a.center;
    }
    begin_pair(first, second, rotation, offset);
    var frame = a;
    var given = given_gap;
    on_terrain = ANY_TERRAIN && first.kind == HEIGHT_FIELD;
    if (on_terrain) {
        frame.axes = mat3x3f(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        begin_terrain(pair, geom, second, offset, range);
    }
    for (var round = 0u; on_terrain || round < 1u; round++) {
        var remaining = SEARCH;
        var reach = range;
        if (on_terrain) {
            if (search_begins) {
                begin_search(second, rotation);
            }
            if (!find_round()) {
                if (widens_search()) {
                    continue;
                }
                break;
            }
            reach = terrain_range;
            remaining = begin_round(second, rotation);
            frame.center = triangle_origin;
            given = remaining == SHARED;
        }
        if (remaining != NO_WORK) {
            var touches = find_touching(given, reach);
            if (on_terrain) {
                if (touches) {
                    touches = classify();
                } else {
                    apart_along = best.normal;
                }
            }
            if (touches) {
                add_contacts(pair, frame, reach);
            }
        }
        if (on_terrain) {
            end_round();
            narrow_search(pair);
        }
    }
    if (on_terrain) {
        on_terrain = false;
        end_terrain(pair, a);
    }
}
