// Constraints that are added at run time: equalities from FIRST_SLOT on, whose bodies and frames are in slots of the
// state. CPU counterpart: `state/slots.rs`.

fn is_in_slot(equality: u32) -> bool {
    return ANY_SLOTS && equality >= FIRST_SLOT;
}

// Returns a number of the state that is an index or a code; NONE if it is not a whole number.
fn whole_number(x: f32) -> u32 {
    let number = u32(x);
    return select(NONE, number, f32(number) == x);
}

// Returns the first or second body of the constraint in a slot.
fn body_in_slot(slot: u32, side: u32) -> u32 {
    return whole_number(fetch_state(select(DYNAMIC_BODY2, DYNAMIC_BODY1, side == 0u) + slot));
}

// Returns the first or second body of a connect or weld.
fn anchor_body(equality: u32, side: u32) -> u32 {
    if (is_in_slot(equality)) {
        return body_in_slot(equality - FIRST_SLOT, side);
    }
    return words[EQ_PAIR + 2u * equality + side];
}

// Returns the kind of the constraint in a slot: static if the slot is empty or does not name two bodies.
fn kind_in_slot(slot: u32) -> u32 {
    let first = body_in_slot(slot, 0u);
    let second = body_in_slot(slot, 1u);
    if (max(first, second) >= NBODY || first == second) {
        return EQ_STATIC;
    }
    switch whole_number(fetch_state(DYNAMIC_KIND + slot)) {
        case SLOT_CONNECT: {
            return EQ_CONNECT;
        }
        case SLOT_WELD: {
            return EQ_WELD;
        }
        default: {
            return EQ_STATIC;
        }
    }
}
