// Trees that awake trees wake by contacts and equalities. CPU counterparts: `wake_touching` and `wake_coupled` in
// `sleep/wake.rs`.

// Returns the places of a near pair with contacts; fixed ones if it has none.
fn touching_places(k: u32) -> vec2u {
    let of_pair = reports[(NEAR_PAIRS + k) * envs + env];
    if (of_pair % PAIR_CONTACTS == 0u) {
        return vec2u(NTREE);
    }
    let pair = u32(fetch(found_contact(of_pair / PAIR_CONTACTS)));
    if (pair >= NPAIR) {
        return vec2u(NTREE);
    }
    return vec2u(words[BODY_TREE + words[PAIR_BODY + 2u * pair]], words[BODY_TREE + words[PAIR_BODY + 2u * pair + 1u]]);
}

// Wakes trees in contact with awake trees or mocap bodies, and those that they wake in turn. The first of `near` pairs
// with a tree to wake, if any, is `first`.
fn wake_touching(near: u32, first: u32) {
    var start = first;
    for (var sweep = 0u; start < near && sweep <= bound(NTREE); sweep++) {
        var woke = false;
        for (var k = start; k < near; k++) {
            let places = touching_places(k);
            woke = wake_each_other(places.x, places.y) || woke;
        }
        start = select(near, 0u, woke);
        update_awake();
    }
}

// Returns the first near pair with a tree to wake.
fn first_to_wake(near: u32) -> u32 {
    for (var k = member; k < near; k += TEAM) {
        let places = touching_places(k);
        if (is_woken(places.x, places.y) || is_woken(places.y, places.x)) {
            return k;
        }
    }
    return NONE;
}

// Returns the lowest tree of the island with which a tree sleeps.
fn first_of_island(tree: u32) -> u32 {
    var lowest = tree;
    var at = tree;
    for (var k = 0u; k < bound(NTREE); k++) {
        let next = fetch(TREE_COUNTER + at);
        if (next < 0.0) {
            break;
        }
        lowest = min(lowest, at);
        at = u32(next);
        if (at == tree || at >= NTREE) {
            break;
        }
    }
    return lowest;
}

// Wakes both of two places unless they sleep in the same island. Returns true if either slept.
fn wake_couple(one: u32, other: u32) -> bool {
    let is_one_awake = is_awake(one);
    let is_other_awake = is_awake(other);
    if (is_one_awake && is_other_awake) {
        return false;
    }
    if (!is_one_awake && !is_other_awake && first_of_island(one) == first_of_island(other)) {
        return false;
    }
    if (!is_one_awake) {
        wake_tree(one, COUNTER_AWAKE);
    }
    if (!is_other_awake) {
        wake_tree(other, COUNTER_AWAKE);
    }
    return true;
}

// Wakes the trees that slots tie. A fixed body wakes nothing.
fn wake_tied() {
    for (var slot = 0u; slot < NSLOT; slot++) {
        if (kind_in_slot(slot) == EQ_STATIC) {
            continue;
        }
        let first = words[BODY_TREE + body_in_slot(slot, 0u)];
        let second = words[BODY_TREE + body_in_slot(slot, 1u)];
        if (first != NTREE && second != NTREE) {
            wake_couple(first, second);
        }
    }
}

// Wakes trees that an active equality, or a constraint in a slot, couples to an awake tree, to a mocap body, or to a
// tree that sleeps in another island.
fn wake_coupled() {
    for (var k = 0u; k < NCOUPLE; k++) {
        let couple = COUPLES + COUPLE_SIZE * k;
        if (fetch_state(EQ_ACTIVE + words[couple + COUPLE_EQUALITY]) != 0.0) {
            wake_couple(words[couple + COUPLE_FIRST], words[couple + COUPLE_SECOND]);
        }
    }
    if (ANY_SLOTS) {
        wake_tied();
    }
    update_awake();
}

// Records whether everything slept in this pass.
fn record_pass() {
    var all_asleep = 1u;
    for (var t = member; t < NTREE; t += TEAM) {
        all_asleep = select(all_asleep, 0u, is_awake(t));
    }
    all_asleep = least_of_team(all_asleep);
    if (is_first()) {
        reports[AT_REST * envs + env] = all_asleep;
    }
}
