// Trees fall asleep before the state advances. CPU counterparts: `sleep/fall.rs`, and `clench-solver/src/partition.rs`.

// Returns true if any constraint acts.
fn is_constrained() -> bool {
    var acts = false;
    for (var a = member; a < reports[NROW * envs + env]; a += TEAM) {
        acts = acts || row(D + a) > 0.0;
    }
    return least_of_team(select(1u, 0u, acts)) == 0u;
}

// Returns true if a tree may sleep, is slow and has no applied force.
fn is_slow(tree: u32) -> bool {
    let tolerance = parameter(SLEEP_TOLERANCE);
    for (var i = of_sleeper(tree, SLEEPER_DOF); i < of_sleeper(tree, SLEEPER_DOF_END); i++) {
        let velocity = fetch_state(QVEL + i);
        let speed = parameter(DOF_LENGTH + i) * abs(velocity);
        if (!(speed < tolerance || (tolerance == 0.0 && is_blank(velocity)))) {
            return false;
        }
    }
    return of_sleeper(tree, SLEEPER_NEVER) == 0u && is_free(tree);
}

// Counts the steps in which awake trees are slow. Returns true if any is ready.
fn count_slow_steps() -> bool {
    let counts = ISLANDS || !is_constrained();
    var ready = false;
    for (var t = member; counts && t < NTREE; t += TEAM) {
        if (!is_awake(t)) {
            continue;
        }
        let counter = fetch(TREE_COUNTER + t);
        let next = select(f32(COUNTER_AWAKE), min(max(counter, COUNTER_AWAKE) + 1.0, COUNTER_READY), is_slow(t));
        put(TREE_COUNTER + t, next);
        ready = ready || next == COUNTER_READY;
    }
    return least_of_team(select(1u, 0u, ready)) == 0u;
}

// Returns the lowest tree of the island of a tree, as far as it is known.
fn leader_of(tree: u32) -> u32 {
    var at = tree;
    for (var k = 0u; k < bound(NTREE); k++) {
        let above = u32(fetch(TREE_LEADER + at));
        if (above == at) {
            break;
        }
        at = above;
    }
    put(TREE_LEADER + tree, f32(at));
    return at;
}

// Joins the island of a place to that of the places before it, of which one is `first`. Returns one of them.
fn unite(first: u32, place: u32) -> u32 {
    if (place >= NTREE || place == first) {
        return first;
    }
    if (first != NONE) {
        let a = leader_of(first);
        let b = leader_of(place);
        put(TREE_LEADER + max(a, b), f32(min(a, b)));
    }
    return place;
}

fn unite_bodies(one: u32, other: u32) {
    unite(unite(NONE, words[BODY_TREE + one]), words[BODY_TREE + other]);
}

// Unites the trees of a joint or tendon with those of the coordinates before it.
fn unite_coordinate(before: u32, c: u32) -> u32 {
    if (c == NONE) {
        return before;
    }
    if (c < NJNT) {
        return unite(before, words[DOF_TREE + words[JNT_DOF + c]]);
    }
    var first = before;
    let t = c - NJNT;
    for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
        first = unite(first, words[DOF_TREE + words[TENDON_DOF + k]]);
    }
    return first;
}

// Unites the trees that a block couples.
fn unite_block(b: u32) {
    let source = block(b, BLOCK_SOURCE);
    switch block(b, BLOCK_KIND) {
        case FRAMES: {
            unite_bodies(anchor_body(source, 0u), anchor_body(source, 1u));
        }
        case COUPLING: {
            unite_coordinate(unite_coordinate(NONE, words[EQ_PAIR + 2u * source]), words[EQ_PAIR + 2u * source + 1u]);
        }
        case DRY_FRICTION: {
            if (source >= NV) {
                unite_coordinate(NONE, NJNT + source - NV);
            }
        }
        case METRIC_TERM: {
            // It acts on one tree, or on trees that never sleep.
        }
        case LIMIT: {
            unite_coordinate(NONE, source >> 1u);
        }
        case CONTACT_NORMAL, CONTACT_PYRAMID, CONTACT_ELLIPTIC, default: {
            let pair = u32(fetch(CONTACTS + CONTACT_SIZE * source));
            unite_bodies(words[PAIR_BODY + 2u * pair], words[PAIR_BODY + 2u * pair + 1u]);
        }
    }
}

// Finds the islands: the trees that the acting blocks couple.
fn find_islands() {
    for (var t = 0u; t < bound(NTREE); t++) {
        put(TREE_LEADER + t, f32(t));
    }
    for (var b = 0u; b < reports[NBLOCK * envs + env]; b++) {
        var acts = false;
        let first = block(b, BLOCK_ROW);
        for (var a = first; a < first + block(b, BLOCK_DIM); a++) {
            acts = acts || row(D + a) > 0.0;
        }
        if (acts) {
            unite_block(b);
        }
    }
}

// Deactivates the islands of which all trees are ready. The counter of each tree becomes the next of its island.
fn deactivate_islands() {
    for (var t = 0u; t < bound(NTREE); t++) {
        put(TREE_MARKED + t, 0.0);
        put(TREE_VISITED + t, f32(t));
    }
    for (var t = 0u; t < bound(NTREE); t++) {
        if (fetch(TREE_COUNTER + t) != COUNTER_READY) {
            put(TREE_MARKED + leader_of(t), 1.0);
        }
    }
    for (var up = 0u; up < bound(NTREE); up++) {
        let t = NTREE - 1u - up;
        let leader = leader_of(t);
        if (fetch(TREE_MARKED + leader) == 0.0) {
            put(TREE_COUNTER + t, fetch(TREE_VISITED + leader));
            put(TREE_VISITED + leader, f32(t));
            put(TREE_AWAKE + t, 0.0);
        }
    }
}

// Completes the step of an environment that rests: only time passes.
fn pass_at_rest(id: vec3u) {
    select_environment(id.x);
    if (id.x < envs && id.y == 0u && reports[STATUS * envs + env] == RESTING) {
        reports[STEPS * envs + env] += 1u;
    }
}

// One team per environment.
@compute @workgroup_size(GROUP, TEAM)
fn fall_asleep(@builtin(global_invocation_id) id: vec3u) {
    if (MAY_REST) {
        pass_at_rest(id);
    }
    begin_in_team(id);
    let ready = count_slow_steps();
    join();
    if (is_first() && ready) {
        find_islands();
        deactivate_islands();
    }
    join();
    for (var i = member; i < bound(NV); i += TEAM) {
        if (!is_dof_awake(i)) {
            put(QACC + i, 0.0);
        }
    }
    end_in_team();
}
