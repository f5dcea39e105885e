// Back to the initial state of the model, where a word of `reports` asks for it.

@compute @workgroup_size(GROUP)
fn restart(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= N || reports[RESTART * N + env] == 0u) {
        return;
    }
    for (var k = 0u; k < STATE; k++) {
        keep(k, numbers[INITIAL_STATE + k]);
    }
    reports[RESTART * N + env] = 0u;
    reports[STATUS * N + env] = RUNNING;
    reports[STEPS * N + env] = 0u;
}
