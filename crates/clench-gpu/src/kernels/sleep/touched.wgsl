// The start of a pass: trees that the user changed wake, and an environment in which everything sleeps as the last pass
// left it rests. CPU counterparts: `wake_touched` in `sleep/wake.rs`, and `sleep/skipped_work.rs`.

// Returns true if a sleeping tree is as it fell asleep, apart from the forces on it.
fn is_untouched(tree: u32) -> bool {
    for (var q = of_sleeper(tree, SLEEPER_QPOS); q < of_sleeper(tree, SLEEPER_QPOS_END); q++) {
        if (fetch_state(QPOS + q) != fetch_state(POSE_ASLEEP + q)) {
            return false;
        }
    }
    let mocap = of_sleeper(tree, SLEEPER_MOCAP);
    for (var k = 0u; mocap != NONE && k < 7u; k++) {
        let number = NQ + 7u * mocap + k;
        if (pose_number(number) != fetch_state(POSE_ASLEEP + number)) {
            return false;
        }
    }
    for (var i = of_sleeper(tree, SLEEPER_DOF); i < of_sleeper(tree, SLEEPER_DOF_END); i++) {
        if (!is_blank(fetch_state(QVEL + i))) {
            return false;
        }
    }
    return of_sleeper(tree, SLEEPER_NEVER) == 0u;
}

// Wakes the island with which a tree sleeps in the state. Counters that users wrote may not form a cycle; then it wakes
// some of the trees and terminates.
fn wake_from_state(tree: u32) {
    var at = tree;
    for (var k = 0u; k < bound(NTREE); k++) {
        let next = fetch_state(TREE_ASLEEP + at);
        if (next < 0.0) {
            return;
        }
        put(TREE_COUNTER + at, COUNTER_AWAKE);
        at = u32(next);
        if (at == tree || at >= NTREE) {
            return;
        }
    }
}

// Starts from the state, and wakes touched trees. Returns true if all trees sleep.
fn wake_touched() -> bool {
    for (var t = member; t < NTREE; t += TEAM) {
        put(TREE_COUNTER + t, fetch_state(TREE_ASLEEP + t));
    }
    join();
    for (var t = member; t < NTREE; t += TEAM) {
        if (fetch_state(TREE_ASLEEP + t) >= 0.0 && !(is_untouched(t) && is_free(t))) {
            wake_from_state(t);
        }
    }
    join();
    var all_asleep = 1u;
    for (var t = member; t < NTREE; t += TEAM) {
        let awake = fetch(TREE_COUNTER + t) < 0.0;
        put(TREE_AWAKE + t, select(f32(0.0), f32(1.0), awake));
        all_asleep = select(all_asleep, 0u, awake);
    }
    return least_of_team(all_asleep) == 1u;
}

// Returns true if the results of the last pass are those of this one.
fn stays_at_rest() -> bool {
    var same = reports[AT_REST * envs + env] == 1u && words[MEASURES] == 0u;
    for (var k = member; k < NASLEEP_POSE; k += TEAM) {
        same = same && pose_number(k) == fetch(PASS_POSE + k);
    }
    for (var i = member; i < bound(NV); i += TEAM) {
        same = same && is_blank(fetch_state(QACC_WARMSTART + i));
    }
    return least_of_team(select(0u, 1u, same)) == 1u;
}

// Begins the environment of a thread, even if it rests.
fn begin_or_resume(id: vec3u) {
    column = id.x % GROUP;
    select_environment(id.x);
    var status = EXCLUDED;
    if (id.x < envs) {
        status = reports[STATUS * envs + env];
    }
    member = select(BEHIND_ALL, id.y, status == RUNNING || status == RESTING);
}

// One team per environment.
@compute @workgroup_size(GROUP, TEAM)
fn wake(@builtin(global_invocation_id) id: vec3u) {
    begin_or_resume(id);
    var rests = wake_touched();
    if (MAY_REST) {
        rests = stays_at_rest() && rests;
        for (var k = member; !rests && k < NASLEEP_POSE; k += TEAM) {
            put(PASS_POSE + k, pose_number(k));
        }
    }
    if (is_first()) {
        reports[STATUS * envs + env] = select(RUNNING, RESTING, MAY_REST && rests);
    }
    end_in_team();
}
