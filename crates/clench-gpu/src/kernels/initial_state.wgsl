// The initial state of the model.

// Returns the k-th number of the initial state. The fields of slots come last, and all slots are empty.
fn initial_number(k: u32) -> f32 {
    if (k < DYNAMIC_KIND) {
        return numbers[INITIAL_STATE + k];
    }
    return 0.0;
}
