// The forces of contacts, connects and welds. CPU counterpart: `of_contact` in `output/forces.rs`.

// Returns the three numbers of rows from `first` on, zero beyond the block's end.
fn three_forces(first: u32, end: u32) -> vec3f {
    var f = vec3f();
    for (var k = 0u; k < 3u; k++) {
        if (first + k < end) {
            f[k] = row(FORCE + first + k);
        }
    }
    return f;
}

// Returns the force and torque of a block's rows; for a contact, those on its second body in its frame, minus its
// adhesion, which pulls as a passive force.
fn block_wrench(b: u32) -> Spatial {
    let first = block(b, BLOCK_ROW);
    let end = first + block(b, BLOCK_DIM);
    var force = three_forces(first, end);
    if (block(b, BLOCK_KIND) >= CONTACT_NORMAL) {
        force.x -= contact_adhesion(block(b, BLOCK_SOURCE));
    }
    return Spatial(three_forces(first + 3u, end), force);
}
