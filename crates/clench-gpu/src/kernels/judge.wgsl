// The verdict on a forward pass that is no step: one thread an environment.

@compute @workgroup_size(GROUP)
fn verdict(@builtin(global_invocation_id) id: vec3u) {
    if (begin(id.x)) {
        judge_results();
    }
}
