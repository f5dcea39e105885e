// Near pairs that may wake trees by touch. CPU counterpart: `contact/awake_pairs.rs`.
//
// The processor detects contacts again until no tree wakes. The device detects them once, for all trees that could wake:
// those that near pairs and islands connect to awake ones.

// Returns true if a place may wake; mocap bodies are awake, and fixed bodies wake nothing.
fn is_marked(place: u32) -> bool {
    if (place >= NTREE) {
        return place > NTREE;
    }
    return fetch(TREE_MARKED + place) != 0.0;
}

// Marks a tree and the island with which it sleeps.
fn mark(tree: u32) {
    var at = tree;
    for (var k = 0u; k < bound(NTREE); k++) {
        put(TREE_MARKED + at, 1.0);
        let next = fetch(TREE_COUNTER + at);
        if (next < 0.0) {
            return;
        }
        at = u32(next);
        if (at == tree || at >= NTREE) {
            return;
        }
    }
}

// Marks the trees that a near pair connects to marked ones. Returns true if there were any.
fn mark_over(pair: u32) -> bool {
    let one = words[BODY_TREE + words[PAIR_BODY + 2u * pair]];
    let other = words[BODY_TREE + words[PAIR_BODY + 2u * pair + 1u]];
    if (one == NTREE || other == NTREE || is_marked(one) == is_marked(other)) {
        return false;
    }
    mark(select(one, other, is_marked(one)));
    return true;
}

// Returns true if `x` is true for any thread of the workgroup. Threads that write at once write the same number, in
// memory that is not in use yet.
fn any_of_group(x: bool) -> bool {
    workgroupBarrier();
    near_counts[0] = 0u;
    workgroupBarrier();
    if (x) {
        near_counts[0] = 1u;
    }
    return workgroupUniformLoad(&near_counts[0]) == 1u;
}

// Returns the index of the k-th near pair of this thread.
fn own_near_pair(start: u32, k: u32) -> u32 {
    return reports[(NEAR_BY_METHOD + start + k) * envs + env];
}

// Marks the trees that may wake, from the near pairs of all threads; this one has `count` from `start` on. The trees
// that are marked do not depend on the order.
fn mark_trees(start: u32, count: u32) {
    for (var t = member; t < NTREE; t += TEAM) {
        put(TREE_MARKED + t, fetch(TREE_AWAKE + t));
    }
    join();
    for (var sweep = 0u; sweep <= bound(NTREE); sweep++) {
        var marked = false;
        for (var k = 0u; k < count; k++) {
            let pair = own_near_pair(start, k);
            if (pair < NPAIR && mark_over(pair)) {
                marked = true;
            }
        }
        join();
        if (!any_of_group(marked)) {
            break;
        }
    }
}

// Removes the near pairs whose bodies cannot be awake, also from the numbers of pairs by method. Returns the number of
// those that stay.
fn drop_sleeping(start: u32, count: u32, by_method: ptr<function, array<u32, METHODS>>) -> u32 {
    mark_trees(start, count);
    var kept = 0u;
    for (var k = 0u; k < count; k++) {
        let pair = own_near_pair(start, k);
        var stays = pair >= NPAIR;
        for (var side = 0u; !stays && side < 2u; side++) {
            stays = is_marked(words[BODY_TREE + words[PAIR_BODY + 2u * pair + side]]);
        }
        if (stays) {
            reports[(NEAR_BY_METHOD + start + kept) * envs + env] = pair;
            kept++;
        } else {
            (*by_method)[words[PAIR_METHOD + pair]]--;
        }
    }
    return kept;
}
