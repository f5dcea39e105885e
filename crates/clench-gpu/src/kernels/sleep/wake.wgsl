// The causes that wake sleeping trees once positions are known. CPU counterpart: `sleep/wake.rs`. One thread wakes
// trees, in the order of the processor; `TREE_AWAKE` is constant during each test.

// Wakes the island of a tree, with `counter` for each of its trees. An awake tree takes `counter` if that is further
// from sleep.
fn wake_tree(tree: u32, counter: f32) {
    let now = fetch(TREE_COUNTER + tree);
    if (now < 0.0) {
        put(TREE_COUNTER + tree, min(now, counter));
        return;
    }
    var at = tree;
    for (var k = 0u; k < bound(NTREE); k++) {
        let next = fetch(TREE_COUNTER + at);
        if (next < 0.0) {
            return;
        }
        put(TREE_COUNTER + at, counter);
        at = u32(next);
        if (at == tree || at >= NTREE) {
            return;
        }
    }
}

// Returns true if the first of two places is a tree that the second wakes.
fn is_woken(tree: u32, other: u32) -> bool {
    return tree < NTREE && !is_awake(tree) && is_awake(other);
}

// Wakes a tree if the other place wakes it. Mocap bodies do not sleep.
fn wake_by(tree: u32, other: u32) -> bool {
    if (!is_woken(tree, other)) {
        return false;
    }
    var counter = f32(COUNTER_AWAKE);
    if (other < NTREE) {
        counter = fetch(TREE_COUNTER + other);
    }
    wake_tree(tree, counter);
    return true;
}

// Wakes each of two trees where it sleeps and the other does not. Returns true if either slept.
fn wake_each_other(one: u32, other: u32) -> bool {
    let first = wake_by(one, other);
    return wake_by(other, one) || first;
}

// Updates the awake trees from the counters.
fn update_awake() {
    for (var t = 0u; t < bound(NTREE); t++) {
        put(TREE_AWAKE + t, select(f32(0.0), f32(1.0), fetch(TREE_COUNTER + t) < 0.0));
    }
}
