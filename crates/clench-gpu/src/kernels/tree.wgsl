// LᵀDL in the pattern of the kinematic tree: row i has the path from the root to dof i, itself last. Sister of
// `clench-solver/src/tree/factor.rs`; the sums run in the same order.
//
// The factor replaces the matrix in QLD: L below the diagonal, and 1 / D in QLD_INVERSE.

// Factors what stands in QLD; false where a pivot is not positive.
fn factor_tree() -> bool {
    var positive = true;
    for (var up = 0u; up < bound(NV); up++) {
        let i = NV - 1u - up;
        let start = words[TREE_START + i];
        let last = words[TREE_START + i + 1u] - 1u;
        let pivot = fetch(QLD + last);
        positive = positive && pivot > 0.0 && !is_wild(pivot);
        let inverse = 1.0 / pivot;
        put(QLD_INVERSE + i, inverse);
        for (var p = last; p > start; p--) {
            let entry = p - 1u;
            let ancestor = words[TREE_START + words[TREE_DOF + entry]];
            let multiplier = fetch(QLD + entry) * inverse;
            for (var q = start; q <= entry; q++) {
                add(QLD + ancestor + q - start, -multiplier * fetch(QLD + q));
            }
            put(QLD + entry, multiplier);
        }
    }
    return positive;
}

// x ← (LᵀDL)⁻¹ x, in place.
fn solve_tree(x: u32) {
    for (var up = 0u; up < bound(NV); up++) {
        let i = NV - 1u - up;
        let value = fetch(x + i);
        for (var p = words[TREE_START + i]; p + 1u < words[TREE_START + i + 1u]; p++) {
            add(x + words[TREE_DOF + p], -fetch(QLD + p) * value);
        }
    }
    for (var i = 0u; i < bound(NV); i++) {
        var sum = fetch(x + i) * fetch(QLD_INVERSE + i);
        for (var p = words[TREE_START + i]; p + 1u < words[TREE_START + i + 1u]; p++) {
            sum -= fetch(QLD + p) * fetch(x + words[TREE_DOF + p]);
        }
        put(x + i, sum);
    }
}
