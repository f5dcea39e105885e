// The contacts of an environment: a pool of MAX_CONTACTS, in canonical order; and the nearest points of pairs whose
// distance is measured.

// Returns the offset of a contact in the memory of the threads.
fn found_contact(index: u32) -> u32 {
    return THREADS + THREAD_SIZE * (index / THREAD_CONTACTS) + FOUND_CONTACTS + CONTACT_SIZE * (index % THREAD_CONTACTS);
}

// Copies all numbers of a contact at once: a GPU waits as long for one.
fn copy_contact(start: u32, offset: u32) {
    let first = fetch4(start);
    let second = fetch4(start + 4u);
    let third = fetch4(start + 8u);
    let last = vec2f(fetch(start + 12u), fetch(start + 13u));
    put4(offset, first);
    put4(offset + 4u, second);
    put4(offset + 8u, third);
    put(offset + 12u, last.x);
    put(offset + 13u, last.y);
}

// Gathers the contacts found by the threads of the narrow phase. One team per environment; each thread traverses the
// whole list and copies its share.
@compute @workgroup_size(GROUP, TEAM)
fn contacts(@builtin(global_invocation_id) id: vec3u) {
    begin_in_team(id);
    for (var thread = 0u; is_first() && thread < NTHREAD; thread++) {
        fail(reports[(THREAD_FAULT + thread) * envs + env]);
    }
    for (var k = member; k < NMEASURED; k += TEAM) {
        put(MEASURED + CONTACT_SIZE * k + 1u, TOO_FAR);
    }
    join();
    var near = 0u;
    if (member < TEAM) {
        near = reports[NNEAR * envs + env];
    }
    if (SLEEP) {
        let first = least_of_team(first_to_wake(near));
        if (is_first()) {
            wake_touching(near, first);
        }
        join();
    }
    var count = 0u;
    for (var k = 0u; k < near; k++) {
        let of_pair = reports[(NEAR_PAIRS + k) * envs + env];
        let first = of_pair / PAIR_CONTACTS;
        let start = found_contact(first);
        let here = of_pair % PAIR_CONTACTS;
        if (here == 0u) {
            continue;
        }
        let pair = u32(fetch(start));
        if (pair >= NPAIR) {
            if (k % TEAM == member) {
                copy_contact(start, MEASURED + CONTACT_SIZE * (pair - NPAIR));
            }
            continue;
        }
        if (SLEEP && does_pair_sleep(pair)) {
            continue;
        }
        if (here > MAX_CONTACTS - count) {
            fail(CONTACT_OVERFLOW);
            break;
        }
        for (var c = 0u; c < here; c++) {
            if ((count + c) % TEAM == member) {
                copy_contact(start + CONTACT_SIZE * c, CONTACTS + CONTACT_SIZE * (count + c));
            }
        }
        count += here;
    }
    if (is_first()) {
        reports[NCON * envs + env] = count;
    }
    if (SLEEP) {
        join();
        if (is_first()) {
            wake_coupled();
        }
        join();
        record_pass();
    }
    end_in_team();
}
