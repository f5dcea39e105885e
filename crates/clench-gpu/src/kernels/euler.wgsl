// Semi-implicit Euler: one team per environment. CPU counterpart: `dynamics/euler.rs`.

@compute @workgroup_size(GROUP, TEAM)
fn euler(@builtin(global_invocation_id) id: vec3u) {
    begin_in_team(id);
    save_start();
    damped_acceleration();
    advance_semi_implicit();
}
