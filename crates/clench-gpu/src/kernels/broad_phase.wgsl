// The near pairs. CPU counterpart: `bounding_sphere.rs`. The pairs of the model are listed once, in canonical order,
// followed by those whose distance is requested.

// Returns true if the bounding spheres of a pair overlap; a plane has none.
fn may_touch(pair: u32) -> bool {
    let a = words[PAIR_GEOM + 2u * pair];
    let b = words[PAIR_GEOM + 2u * pair + 1u];
    let reach = parameter(PAIR_REACH + pair);
    let offset = fetch3(GEOM_XPOS + 3u * b) - fetch3(GEOM_XPOS + 3u * a);
    if (words[GEOM_KIND + a] == PLANE) {
        let start = GEOM_XMAT + 9u * a;
        let normal = vec3f(fetch(start + 2u), fetch(start + 5u), fetch(start + 8u));
        return dot(normal, offset) <= reach;
    }
    return dot(offset, offset) <= reach * max(reach, 0.0);
}

// Tests four consecutive pairs, so that a GPU waits only once for their data. Pairs from `end` on are not near.
fn near_of_four(pair: u32, end: u32) -> vec4<bool> {
    let last = end - 1u;
    let near = vec4<bool>(may_touch(pair), may_touch(min(pair + 1u, last)), may_touch(min(pair + 2u, last)), may_touch(min(pair + 3u, last)));
    return near & (vec4u(pair, pair + 1u, pair + 2u, pair + 3u) < vec4u(end));
}

// The number of near pairs for each thread and method.
var<workgroup> near_counts: array<u32, GROUP * TEAM * METHODS>;

fn near_count(thread: u32, method: u32) -> u32 {
    return GROUP * (METHODS * thread + method) + column;
}

// Lists the near pairs of an environment in canonical order, and their order by method. One team per environment. Each
// thread tests consecutive pairs, and stores near ones in the memory of the order until all know the counts of the
// others.
@compute @workgroup_size(GROUP, TEAM)
fn broad_phase(@builtin(global_invocation_id) id: vec3u) {
    begin_in_team(id);
    if (SLEEP) {
        if (is_first()) {
            wake_pulled();
        }
        join();
    }
    let pairs = NPAIR + NMEASURED * words[MEASURES];
    let share = (pairs + 4u * TEAM - 1u) / (4u * TEAM) * 4u;
    let start = share * min(member, TEAM);
    let end = min(start + share, pairs);
    // The number of pairs for each method, then the next position.
    var next: array<u32, METHODS>;
    var count = 0u;
    for (var pair = start; pair < end; pair += 4u) {
        let near = near_of_four(pair, end);
        for (var k = 0u; k < 4u; k++) {
            if (near[k]) {
                reports[(NEAR_BY_METHOD + start + count) * envs + env] = pair + k;
                count++;
                next[words[PAIR_METHOD + pair + k]]++;
            }
        }
    }
    if (SLEEP) {
        count = drop_sleeping(start, count, &next);
    }
    for (var method = 0u; member < TEAM && method < METHODS; method++) {
        near_counts[near_count(member, method)] = next[method];
    }
    workgroupBarrier();
    var before = 0u;
    var all = 0u;
    for (var method = 0u; method < METHODS; method++) {
        for (var thread = 0u; thread < bound(TEAM); thread++) {
            let of_thread = near_counts[near_count(thread, method)];
            if (thread == member) {
                next[method] = all;
            }
            before += select(0u, of_thread, thread < member);
            all += of_thread;
        }
    }
    if (is_first()) {
        reports[NNEAR * envs + env] = all;
    }
    for (var k = 0u; k < count; k++) {
        reports[(NEAR_PAIRS + before + k) * envs + env] = reports[(NEAR_BY_METHOD + start + k) * envs + env];
    }
    join();
    for (var k = before; k < before + count; k++) {
        let method = words[PAIR_METHOD + reports[(NEAR_PAIRS + k) * envs + env]];
        reports[(NEAR_BY_METHOD + next[method]) * envs + env] = k;
        next[method]++;
    }
    end_in_team();
}
