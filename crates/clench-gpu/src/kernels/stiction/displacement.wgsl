// The displacement of contacts from the stick reference of their pair. CPU counterparts: `stiction/displacement.rs`,
// which derives the formulas, and `references.rs`.

// Returns the slot of a pair's reference: the first of its geoms. It is MAX_STICK_PAIRS if there is none.
fn slot_of(pair: u32) -> u32 {
    let first = f32(words[PAIR_GEOM + 2u * pair] + 1u);
    let second = f32(words[PAIR_GEOM + 2u * pair + 1u] + 1u);
    for (var slot = 0u; slot < MAX_STICK_PAIRS; slot++) {
        let tag = fetch_state(STICK_REFERENCES + REFERENCE_SIZE * slot);
        if (tag == 0.0) {
            break;
        }
        if (tag == first && fetch_state(STICK_REFERENCES + REFERENCE_SIZE * slot + 1u) == second) {
            return slot;
        }
    }
    return MAX_STICK_PAIRS;
}

// Returns the displacements of a contact along its friction rows, and stores the slot of its reference. A pair without
// a reference sticks from now on.
fn displacements_of(contact: u32) -> array<f32, 5> {
    let pair = pair_of(contact);
    let present = present_pose(pair);
    var reference = present;
    let slot = slot_of(pair);
    put(STICK_SLOT + contact, f32(slot));
    if (slot < MAX_STICK_PAIRS) {
        let offset = STICK_REFERENCES + REFERENCE_SIZE * slot;
        reference = RelativePose(fetch_state3(offset + 2u), fetch_state4(offset + 5u));
    }
    let first = words[PAIR_BODY + 2u * pair];
    let second = words[PAIR_BODY + 2u * pair + 1u];
    let frame = fetch_matrix(XMAT + 9u * first);
    let offset = CONTACTS + CONTACT_SIZE * contact;
    let point = fetch3(offset + 2u);
    let local = transpose(fetch_matrix(XMAT + 9u * second)) * (point - fetch3(XPOS + 3u * second));
    let before = reference.position + quat_rotate(reference.rotation, local);
    let slide = point - fetch3(XPOS + 3u * first) - frame * before;
    let rotation = frame * rotation_since(reference, present);
    let normal = fetch3(offset + 5u);
    let t1 = fetch3(offset + 8u);
    let t2 = fetch3(offset + 11u);
    return array<f32, 5>(dot(t1, slide), dot(t2, slide), dot(normal, rotation), dot(t1, rotation), dot(t2, rotation));
}

// Displaces row `a`, of a spring of the given stiffness.
fn displace(a: u32, displacement: f32, stiffness: f32) {
    put_row(POSITION + a, displacement);
    put_row(AREF + a, -stiffness * displacement);
}
