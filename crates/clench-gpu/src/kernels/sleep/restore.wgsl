// The state of sleeping trees after a step. CPU counterpart: `restore_sleeping` in `sleep/fall.rs`.

// Stores which trees sleep, and resets those to their positions at the start of the step.
fn restore_sleeping() {
    for (var t = member; t < NTREE; t += TEAM) {
        put_state(TREE_ASLEEP + t, fetch(TREE_COUNTER + t));
        for (var q = of_sleeper(t, SLEEPER_QPOS); !is_awake(t) && q < of_sleeper(t, SLEEPER_QPOS_END); q++) {
            put_state(QPOS + q, fetch(START_QPOS + q));
            put_state(POSE_ASLEEP + q, fetch(START_QPOS + q));
        }
    }
    for (var k = NQ + member; k < NASLEEP_POSE; k += TEAM) {
        put_state(POSE_ASLEEP + k, pose_number(k));
    }
}
