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
    let kind_a = words[GEOM_KIND + words[PAIR_GEOM + 2u * pair]];
    let kind_b = words[GEOM_KIND + words[PAIR_GEOM + 2u * pair + 1u]];
    let back = transpose(a.axes);
    var turn = back * b.axes;
    var offset = back * (b.center - a.center);
    if (kind_a == SPHERE) {
        turn = b.axes;
        offset = b.center - a.center;
    }
    begin_pair(body_of(kind_a, a.size), body_of(kind_b, b.size), turn, offset);
    if (given_gap) {
        begin_simplex(vertex_along(best.normal));
    } else if (!find_largest_gap(range)) {
        return;
    }
    add_contacts(pair, a, range);
}
