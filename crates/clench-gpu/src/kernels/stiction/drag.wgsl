// Drags the stick references and the displacements of dry friction along, after a solve: one workgroup per environment,
// one thread per pair. CPU counterparts: `stiction/return_mapping.rs` and `references.rs`.

// A pair after the solve.
struct Dragged {
    carries: bool,
    reference: RelativePose,
}

// Saves the memory at the start of the step; a step that fails restores it.
fn save_memory() {
    for (var k = lane; k < REFERENCE_SIZE * MAX_STICK_PAIRS; k += GROUP) {
        put(START_STICK_REFERENCES + k, fetch_state(STICK_REFERENCES + k));
    }
    for (var k = lane; k < NV + NTENDON; k += GROUP) {
        put(START_STICK_FRICTION + k, fetch_state(STICK_FRICTION + k));
    }
    join();
}

// Changes the reference of the pair whose contacts begin at block `b`, so that no contact stores more than it can
// carry.
fn drag_pair(b: u32, nblock: u32) -> Dragged {
    let contact = block(b, BLOCK_SOURCE);
    let pair = pair_of(contact);
    let end = end_of_pair(b, pair, nblock);
    let present = present_pose(pair);
    var reference = present;
    let slot = u32(fetch(STICK_SLOT + contact));
    if (slot < MAX_STICK_PAIRS) {
        let offset = START_STICK_REFERENCES + REFERENCE_SIZE * slot;
        reference = RelativePose(fetch3(offset + 2u), fetch4(offset + 5u));
    }
    let limit = limit_of(b, end);
    if (limit < 0.0) {
        return Dragged(false, reference);
    }
    let rotation = rotation_since(reference, present);
    let rolls = dot(rotation, rotation) > MAX_STICK_ROTATION * MAX_STICK_ROTATION;
    if (!(rolls || any_moves(b, end, limit))) {
        return Dragged(true, reference);
    }
    if (rolls) {
        reference = present;
    }
    let twist = fit(b, end, limit, rolls);
    return Dragged(true, displaced(reference, words[PAIR_BODY + 2u * pair], twist));
}

// Stores the reference of a pair in a slot.
fn store(slot: u32, pair: u32, reference: RelativePose) {
    let offset = STICK_REFERENCES + REFERENCE_SIZE * slot;
    for (var k = 0u; k < 2u; k++) {
        put_state(offset + k, f32(words[PAIR_GEOM + 2u * pair + k] + 1u));
    }
    for (var k = 0u; k < 3u; k++) {
        put_state(offset + 2u + k, reference.position[k]);
    }
    for (var k = 0u; k < 4u; k++) {
        put_state(offset + 5u + k, reference.rotation[k]);
    }
}

// Returns true if the bodies of a reference, at `offset` (in work), sleep. Users may write any number.
fn does_reference_sleep(offset: u32) -> bool {
    let first = u32(fetch(offset)) - 1u;
    let second = u32(fetch(offset + 1u)) - 1u;
    return max(first, second) < NGEOM && !is_either_awake(words[GEOM_BODY + first], words[GEOM_BODY + second]);
}

// Moves the references of pairs that sleep to the front. Returns their number.
fn keep_sleeping() -> u32 {
    var kept = 0u;
    var empty = 0u;
    for (var start = 0u; start < MAX_STICK_PAIRS; start += GROUP) {
        let offset = START_STICK_REFERENCES + REFERENCE_SIZE * min(start + lane, MAX_STICK_PAIRS - 1u);
        let ends = start + lane >= MAX_STICK_PAIRS || fetch(offset) == 0.0;
        let ended = sums_up_to(vec4f(select(f32(0.0), f32(1.0), ends), 0.0, 0.0, 0.0));
        let keeps = !ends && empty + u32(ended.before.x) == 0u && does_reference_sleep(offset);
        let sums = sums_up_to(vec4f(select(f32(0.0), f32(1.0), keeps), 0.0, 0.0, 0.0));
        for (var k = 0u; keeps && k < REFERENCE_SIZE; k++) {
            put_state(STICK_REFERENCES + REFERENCE_SIZE * (kept + u32(sums.before.x)) + k, fetch(offset + k));
        }
        empty += u32(ended.all.x);
        kept += u32(sums.all.x);
    }
    return kept;
}

// Replaces the references by those of the pairs that sleep, and of those that carry a load, in the order of their
// contacts.
fn drag_references(nblock: u32) {
    var used = 0u;
    if (SLEEP) {
        used = keep_sleeping();
    }
    for (var start = 0u; start < nblock; start += GROUP) {
        let b = start + lane;
        var dragged = Dragged();
        if (b < nblock && begins_pair(b)) {
            dragged = drag_pair(b, nblock);
        }
        let sums = sums_up_to(vec4f(select(f32(0.0), f32(1.0), dragged.carries), 0.0, 0.0, 0.0));
        let slot = used + u32(sums.before.x);
        if (dragged.carries && slot < MAX_STICK_PAIRS) {
            store(slot, pair_of(block(b, BLOCK_SOURCE)), dragged.reference);
        }
        used += u32(sums.all.x);
    }
    for (var k = REFERENCE_SIZE * used + lane; k < REFERENCE_SIZE * MAX_STICK_PAIRS; k += GROUP) {
        put_state(STICK_REFERENCES + k, 0.0);
    }
    if (lane == 0u && used > MAX_STICK_PAIRS) {
        fail(STICK_OVERFLOW);
    }
}

@compute @workgroup_size(GROUP)
fn drag(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) index: u32) {
    lane = index;
    if (!begin_together(workgroup)) {
        return;
    }
    let nblock = reports[NBLOCK * envs + env];
    save_memory();
    drag_references(nblock);
    drag_friction(nblock);
    check_loops();
}
