// Any two bounded convex shapes, by their support functions. Sister of `clench-collide/src/narrow/convex/mod.rs`.

// The largest gap between two cores, in `best`; false if the bodies are more than `range` apart.
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
    // Newton's method has one place: after the search, and wherever the expansion asks for it.
    for (var round = 0u; round < bound(POLYTOPE_VERTICES); round++) {
        var done = true;
        if (overlapping) {
            done = expand(curved);
        }
        if (curved && !(overlapping && done && refined) && !best.settled) {
            find_edges();
            let improved = improve(refine(best.normal));
            refined = refined || improved;
        }
        if (done) {
            break;
        }
    }
    if (overlapping && !known) {
        try_crossings();
    }
    return best.gap - radii <= range;
}

// The contacts of a pair; `given_gap` where the largest gap is in `best` already, its normal in the first shape's frame.
fn convex(pair: u32, a: Placed, b: Placed, given_gap: bool, range: f32) {
    let first = body_of(words[PAIR_GEOM + 2u * pair]);
    let second = body_of(words[PAIR_GEOM + 2u * pair + 1u]);
    let back = transpose(a.axes);
    var turn = back * b.axes;
    var offset = back * (b.center - a.center);
    if (first.kind == SPHERE) {
        turn = b.axes;
        offset = b.center - a.center;
    }
    begin_pair(first, second, turn, offset);
    var certain = given_gap;
    var direct = Gap(vec3f(), -UNMOVABLE, false);
    if (ANY_CYLINDER_POLYHEDRON && has_creases(first, second)) {
        direct = polyhedron_gap(range);
    } else if (ANY_CYLINDER_PAIR && first.kind == CYLINDER && second.kind == CYLINDER) {
        direct = cylinders_gap();
    }
    if (direct.gap > range) {
        return;
    }
    // For bodies that are apart it gives no distance.
    if (direct.settled && direct.gap <= 0.0) {
        certain = true;
        best = direct;
    }
    if (!certain) {
        if (!find_largest_gap(range)) {
            return;
        }
        certain = direct.gap > best.gap + exactness;
        if (certain) {
            best = direct;
        }
    }
    touching_vertex = vertex_along(best.normal);
    if (certain) {
        begin_simplex(touching_vertex);
    }
    add_contacts(pair, a, range);
}
