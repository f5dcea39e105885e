// The displacements of dry friction of dofs and tendons after a solve. CPU counterpart: `drag_friction` in
// `stiction/friction.rs`.

// Limits the displacements to those that friction carries. Without friction they become zero, and asleep they remain.
fn drag_friction(nblock: u32) {
    for (var k = lane; k < NV + NTENDON; k += GROUP) {
        if (!SLEEP || is_friction_awake(k)) {
            put_state(STICK_FRICTION + k, 0.0);
        }
    }
    join();
    for (var b = lane; b < nblock; b += GROUP) {
        if (block(b, BLOCK_KIND) != DRY_FRICTION) {
            continue;
        }
        let first = block(b, BLOCK_ROW);
        let slope = slope_of_row(first);
        if (slope > 0.0) {
            let limit = row(SHAPE + first) * row(R + first) / slope;
            put_state(STICK_FRICTION + block(b, BLOCK_SOURCE), clamp(row(POSITION + first), -limit, limit));
        }
    }
}
