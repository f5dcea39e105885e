// M⁻¹ by the LᵀDL of the tree. Sums run in the order of `clench-solver/src/tree/factor.rs`.
//
// Substitution with Lᵀ, from the leaves to the root, goes by levels or by dofs. The dofs of a level are equally far from the root and do not
// wait for each other: each is a thread's, which subtracts all that is below it. Or one dof after the other is subtracted from its ancestors,
// each a thread's. Many small trees have few levels; of a large tree a dof near the root has much below it, so that the second takes fewer turns.

// The dofs of a level, for each of which a thread does its part.
struct Level {
    first: u32,
    end: u32,
}

fn level_at(k: u32) -> Level {
    return Level(words[LEVEL_START + k], words[LEVEL_START + k + 1u]);
}

// L⁻ᵀg at PRECONDITIONED_AT, by levels.
fn substitute_by_levels() {
    for (var k = NLEVEL; k > 0u; k--) {
        let level = level_at(k - 1u);
        for (var n = level.first + lane; n < level.end; n += GROUP) {
            let i = words[LEVEL_DOF + n];
            var sum = vector(GRADIENT_AT + i);
            for (var p = words[BELOW_START + i + 1u]; p > words[BELOW_START + i]; p--) {
                sum -= fetch(QLD + words[BELOW_PLACE + p - 1u]) * vector(PRECONDITIONED_AT + words[BELOW_DOF + p - 1u]);
            }
            put_vector(PRECONDITIONED_AT + i, sum);
        }
        join_vectors();
    }
}

// The same, by dofs.
fn substitute_by_dofs() {
    for (var i = lane; i < bound(NV); i += GROUP) {
        put_vector(PRECONDITIONED_AT + i, vector(GRADIENT_AT + i));
    }
    join_vectors();
    for (var up = 1u; up < bound(NV); up++) {
        let i = NV - up;
        let value = vector(PRECONDITIONED_AT + i);
        for (var p = words[TREE_START + i] + lane; p + 1u < words[TREE_START + i + 1u]; p += GROUP) {
            let above = PRECONDITIONED_AT + words[TREE_DOF + p];
            put_vector(above, vector(above) - fetch(QLD + p) * value);
        }
        join_vectors();
    }
}

// M⁻¹g at PRECONDITIONED_AT, for conjugate gradients; for Newton's method only L⁻ᵀg. Returns the duality gap ½ gᵀM⁻¹g: the cost less
// ½ |a|²_M is convex, so the cost exceeds its minimum by at most this.
fn precondition() -> f32 {
    if (DOF_BY_DOF) {
        substitute_by_dofs();
    } else {
        substitute_by_levels();
    }
    var square: f32 = 0.0;
    for (var i = lane; i < bound(NV); i += GROUP) {
        let x = vector(PRECONDITIONED_AT + i);
        square += x * x * fetch(QLD_INVERSE + i);
    }
    if (!NEWTON) {
        for (var k = 0u; k < bound(NLEVEL); k++) {
            let level = level_at(k);
            for (var n = level.first + lane; n < level.end; n += GROUP) {
                let i = words[LEVEL_DOF + n];
                var sum = vector(PRECONDITIONED_AT + i) * fetch(QLD_INVERSE + i);
                for (var p = words[TREE_START + i]; p + 1u < words[TREE_START + i + 1u]; p++) {
                    sum -= fetch(QLD + p) * vector(PRECONDITIONED_AT + words[TREE_DOF + p]);
                }
                put_vector(PRECONDITIONED_AT + i, sum);
            }
            join_vectors();
        }
    }
    return 0.5 * total(vec4f(square, 0.0, 0.0, 0.0)).x;
}
