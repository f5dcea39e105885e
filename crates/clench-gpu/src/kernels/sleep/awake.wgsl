// The trees that are awake during a step. CPU counterpart: `sleep/mod.rs`. Kernels of models in which nothing sleeps
// omit it (`SLEEP`).
//
// A place is a tree; NTREE for fixed bodies, and NTREE + 1 for those that a mocap body carries.

// Returns true if a place is awake: fixed bodies never are, mocap bodies always, because the user may move them.
fn is_awake(place: u32) -> bool {
    if (place >= NTREE) {
        return place > NTREE;
    }
    return fetch(TREE_AWAKE + place) != 0.0;
}

fn is_dof_awake(i: u32) -> bool {
    return is_awake(words[DOF_TREE + i]);
}

// Returns true if constraints between two bodies act, because either is awake.
fn is_either_awake(first: u32, second: u32) -> bool {
    return is_awake(words[BODY_TREE + first]) || is_awake(words[BODY_TREE + second]);
}

// Returns true if both bodies of a pair sleep or are fixed.
fn does_pair_sleep(pair: u32) -> bool {
    return !is_either_awake(words[PAIR_BODY + 2u * pair], words[PAIR_BODY + 2u * pair + 1u]);
}

// Returns true if any dof of a tendon is awake.
fn is_tendon_awake(t: u32) -> bool {
    for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
        if (is_dof_awake(words[TENDON_DOF + k])) {
            return true;
        }
    }
    return false;
}

// Returns true if a dof or tendon with dry friction is awake.
fn is_friction_awake(source: u32) -> bool {
    if (source < NV) {
        return is_dof_awake(source);
    }
    return is_tendon_awake(source - NV);
}

// Returns true if any dof of a joint or tendon is awake.
fn is_coordinate_awake(c: u32) -> bool {
    if (c < NJNT) {
        return is_dof_awake(words[JNT_DOF + c]);
    }
    return is_tendon_awake(c - NJNT);
}

// Returns a number of the poses that sleeping trees keep: positions, then those of mocap bodies.
fn pose_number(k: u32) -> f32 {
    if (k < NQ) {
        return fetch_state(QPOS + k);
    }
    let mocap = (k - NQ) / 7u;
    let part = (k - NQ) % 7u;
    if (part < 3u) {
        return fetch_state(MOCAP_POS + 3u * mocap + part);
    }
    return fetch_state(MOCAP_QUAT + 4u * mocap + part - 3u);
}

// Returns a word of a tree.
fn of_sleeper(tree: u32, field: u32) -> u32 {
    return words[SLEEPERS + SLEEPER_SIZE * tree + field];
}
