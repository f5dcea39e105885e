// The contacts of an environment: a pool of MAX_CONTACTS, in canonical order; and the nearest points of pairs whose distance is measured.

fn copy_contacts(start: u32, place: u32, count: u32) {
    for (var x = 0u; x < CONTACT_SIZE * count; x++) {
        put(place + x, fetch(start + x));
    }
}

// One thread an environment: puts together what the threads of the narrow phase found.
@compute @workgroup_size(GROUP)
fn contacts(@builtin(global_invocation_id) id: vec3u) {
    if (!begin(id.x)) {
        return;
    }
    for (var thread = 0u; thread < NTHREAD; thread++) {
        trouble(reports[(THREAD_FAULT + thread) * envs + env]);
    }
    for (var k = 0u; k < NMEASURED; k++) {
        put(MEASURED + CONTACT_SIZE * k + 1u, TOO_FAR);
    }
    let near = reports[NNEAR * envs + env];
    var count = 0u;
    for (var k = 0u; k < near; k++) {
        let of_pair = reports[(NEAR_PAIRS + k) * envs + env];
        let first = of_pair / PAIR_CONTACTS;
        let start = THREADS + THREAD_SIZE * (first / THREAD_CONTACTS) + FOUND_CONTACTS + CONTACT_SIZE * (first % THREAD_CONTACTS);
        let here = of_pair % PAIR_CONTACTS;
        if (here == 0u) {
            continue;
        }
        let pair = u32(fetch(start));
        if (pair >= NPAIR) {
            copy_contacts(start, MEASURED + CONTACT_SIZE * (pair - NPAIR), 1u);
            continue;
        }
        if (here > MAX_CONTACTS - count) {
            trouble(CONTACT_OVERFLOW);
            break;
        }
        copy_contacts(start, CONTACTS + CONTACT_SIZE * count, here);
        count += here;
    }
    reports[NCON * envs + env] = count;
    note_end();
}
