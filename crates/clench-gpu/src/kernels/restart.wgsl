// Reset to the initial state of the model, if a word of `reports` requests it.

@compute @workgroup_size(GROUP)
fn restart(@builtin(global_invocation_id) id: vec3u) {
    select_environment(id.x);
    if (env >= envs || reports[RESTART * envs + env] == 0u) {
        return;
    }
    for (var k = 0u; k < STATE; k++) {
        put_state(k, initial_number(k));
    }
    reports[RESTART * envs + env] = 0u;
    reports[STATUS * envs + env] = RUNNING;
    reports[STEPS * envs + env] = 0u;
    reports[REPEATS * envs + env] = 0u;
}
