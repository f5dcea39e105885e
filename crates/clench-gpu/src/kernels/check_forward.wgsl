// The check of a forward pass outside a step: one team per environment.

@compute @workgroup_size(GROUP, TEAM)
fn check_forward(@builtin(global_invocation_id) id: vec3u) {
    begin_in_team(id);
    check_results();
}
