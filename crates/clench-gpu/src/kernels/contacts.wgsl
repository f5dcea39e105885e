// The contacts of an environment: a pool of MAX_CONTACTS, in canonical order.

// One thread an environment: puts together what the threads of the narrow phase found.
@compute @workgroup_size(GROUP)
fn contacts(@builtin(global_invocation_id) id: vec3u) {
    if (!begin(id.x)) {
        return;
    }
    for (var thread = 0u; thread < NTHREAD; thread++) {
        trouble(reports[(THREAD_FAULT + thread) * envs + env]);
    }
    let near = reports[NNEAR * envs + env];
    var count = 0u;
    for (var k = 0u; k < near; k++) {
        let of_pair = reports[(NEAR_PAIRS + k) * envs + env];
        let first = of_pair / PAIR_CONTACTS;
        let start = THREADS + THREAD_SIZE * (first / MAX_CONTACTS) + FOUND_CONTACTS + CONTACT_SIZE * (first % MAX_CONTACTS);
        let here = of_pair % PAIR_CONTACTS;
        if (here > MAX_CONTACTS - count) {
            trouble(CONTACT_OVERFLOW);
            break;
        }
        for (var x = 0u; x < here * CONTACT_SIZE; x++) {
            put(CONTACTS + CONTACT_SIZE * count + x, fetch(start + x));
        }
        count += here;
    }
    reports[NCON * envs + env] = count;
    note_end();
}
