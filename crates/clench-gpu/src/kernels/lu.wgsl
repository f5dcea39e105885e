// A = U L in the pattern of the tree, for nonsymmetric A: U is unit upper, L lower triangular. CPU counterpart:
// `clench-solver/src/tree/lu.rs`. QLD holds the rows of the lower triangle, diagonal last, QLD_UPPER likewise the
// columns of the upper one.

// Replaces the matrix by its factors; returns false if a pivot is zero or not finite.
fn factor_lu() -> bool {
    var regular = true;
    for (var up = 0u; up < bound(NV); up++) {
        let k = NV - 1u - up;
        let start = words[TREE_START + k];
        let last = words[TREE_START + k + 1u] - 1u;
        let pivot = fetch(QLD + last);
        regular = regular && pivot != 0.0 && !is_wild(pivot);
        for (var p = start; p < last; p++) {
            let multiplier = fetch(QLD_UPPER + p) / pivot;
            put(QLD_UPPER + p, multiplier);
            let ancestor = words[TREE_START + words[TREE_DOF + p]];
            for (var q = start; q <= p; q++) {
                add(QLD + ancestor + q - start, -multiplier * fetch(QLD + q));
            }
            for (var q = p + 1u; q < last; q++) {
                let column = words[TREE_START + words[TREE_DOF + q]];
                add(QLD_UPPER + column + p - start, -multiplier * fetch(QLD + q));
            }
        }
    }
    return regular;
}

// Computes x ← A⁻¹ x, in place.
fn solve_lu(x: u32) {
    for (var up = 0u; up < bound(NV); up++) {
        let k = NV - 1u - up;
        let value = fetch(x + k);
        for (var p = words[TREE_START + k]; p + 1u < words[TREE_START + k + 1u]; p++) {
            add(x + words[TREE_DOF + p], -fetch(QLD_UPPER + p) * value);
        }
    }
    for (var k = 0u; k < bound(NV); k++) {
        let last = words[TREE_START + k + 1u] - 1u;
        var rest = fetch(x + k);
        for (var p = words[TREE_START + k]; p < last; p++) {
            rest -= fetch(QLD + p) * fetch(x + words[TREE_DOF + p]);
        }
        put(x + k, rest / fetch(QLD + last));
    }
}
