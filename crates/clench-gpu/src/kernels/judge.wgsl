// The verdict on a forward pass that is no step: a team an environment.

@compute @workgroup_size(GROUP, TEAM)
fn verdict(@builtin(global_invocation_id) id: vec3u) {
    begin_in_team(id);
    judge_results();
}
