// M⁻¹ by the LᵀDL of the tree, and the duality gap.
//
// Substitution with Lᵀ, from the leaves to the root, runs by levels or by dofs. By dofs, each dof in turn is subtracted
// from its ancestors, one per thread. Many small trees have few levels; in a large tree a dof near the root has many
// descendants, so that the second takes fewer iterations.

// The interface of `substitution.wgsl`, for a workgroup.
fn worker() -> u32 {
    return lane;
}

fn workers() -> u32 {
    return GROUP;
}

fn unknown(x: u32, i: u32) -> f32 {
    return vector(x + i);
}

fn put_unknown(x: u32, i: u32, value: f32) {
    put_vector(x + i, value);
}

fn join_unknowns() {
    join_vectors();
}

// Computes x ← L⁻ᵀ x, in place, by dofs.
fn substitute_by_dofs(x: u32) {
    for (var up = 1u; up < bound(NV); up++) {
        let i = NV - up;
        let value = vector(x + i);
        for (var p = words[TREE_START + i] + lane; p + 1u < words[TREE_START + i + 1u]; p += GROUP) {
            let above = x + words[TREE_DOF + p];
            put_vector(above, vector(above) - fetch(QLD + p) * value);
        }
        join_vectors();
    }
}

// Computes M⁻¹g at PRECONDITIONED_AT for conjugate gradients; for Newton's method only L⁻ᵀg. Returns the duality gap ½
// gᵀM⁻¹g: the cost minus ½ |a|²_M is convex, so the cost exceeds its minimum by at most this.
fn precondition() -> f32 {
    for (var i = lane; i < bound(NV); i += GROUP) {
        put_vector(PRECONDITIONED_AT + i, vector(GRADIENT_AT + i));
    }
    join_vectors();
    if (DOF_BY_DOF) {
        substitute_by_dofs(PRECONDITIONED_AT);
    } else {
        substitute_towards_root(PRECONDITIONED_AT);
    }
    var square: f32 = 0.0;
    for (var i = lane; i < bound(NV); i += GROUP) {
        let x = vector(PRECONDITIONED_AT + i);
        square += x * x * fetch(QLD_INVERSE + i);
    }
    // Each thread reads its own elements before they change.
    join_vectors();
    if (!NEWTON) {
        substitute_towards_leaves(PRECONDITIONED_AT);
    }
    return 0.5 * total_of(square);
}
