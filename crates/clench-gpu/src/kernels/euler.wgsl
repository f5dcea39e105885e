// Semi-implicit Euler: one thread an environment. Sister of `dynamics/euler.rs`.

@compute @workgroup_size(GROUP)
fn euler(@builtin(global_invocation_id) id: vec3u) {
    if (!begin(id.x)) {
        return;
    }
    save_start();
    damped_acceleration();
    advance_semi_implicit();
}
