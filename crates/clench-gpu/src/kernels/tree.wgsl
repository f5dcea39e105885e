// LᵀDL in the pattern of the kinematic tree: row i has the path from the root to dof i, itself last. Sister of
// `clench-solver/src/tree/factor.rs`; the sums run in the same order.
//
// The factor replaces the matrix in QLD: L below the diagonal, and 1 / D in QLD_INVERSE.

// Cards wait long for each number, and cannot know that the next one does not depend on what was just written: hence four at a time. Beyond the
// end of a row nothing changes.

// Which of four entries from `p` on are before `end`.
fn within(p: u32, end: u32) -> vec4<bool> {
    return vec4u(p, p + 1u, p + 2u, p + 3u) < vec4u(end);
}

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
        // The entry at hand, fetched before what it does not depend on is written.
        var unscaled = fetch(QLD + max(last, start + 1u) - 1u);
        for (var p = last; p > start; p--) {
            let entry = p - 1u;
            let ancestor = words[TREE_START + words[TREE_DOF + entry]];
            let multiplier = unscaled * inverse;
            unscaled = fetch(QLD + max(entry, start + 1u) - 1u);
            for (var q = start; q <= entry; q += 4u) {
                let place = QLD + ancestor + q - start;
                let rest = fetch4(place);
                put4(place, select(rest, rest - multiplier * fetch4(QLD + q), within(q, p)));
            }
            put(QLD + entry, multiplier);
        }
    }
    return positive;
}

// The numbers at four dofs.
fn fetch_at(x: u32, dofs: vec4u) -> vec4f {
    return vec4f(fetch(x + dofs.x), fetch(x + dofs.y), fetch(x + dofs.z), fetch(x + dofs.w));
}

// Four dofs of row i of the tree, from entry `p` on; beyond the end i itself.
fn ancestors(p: u32, i: u32) -> vec4u {
    let dofs = vec4u(words[TREE_DOF + p], words[TREE_DOF + p + 1u], words[TREE_DOF + p + 2u], words[TREE_DOF + p + 3u]);
    return select(vec4u(i), dofs, within(p, words[TREE_START + i + 1u]));
}

// x ← (LᵀDL)⁻¹ x, in place.
fn solve_tree(x: u32) {
    for (var up = 0u; up < bound(NV); up++) {
        let i = NV - 1u - up;
        let value = fetch(x + i);
        let last = words[TREE_START + i + 1u] - 1u;
        for (var p = words[TREE_START + i]; p < last; p += 4u) {
            let dofs = ancestors(p, i);
            let rest = fetch_at(x, dofs);
            let left = select(rest, rest - fetch4(QLD + p) * value, within(p, last));
            put(x + dofs.x, left.x);
            put(x + dofs.y, left.y);
            put(x + dofs.z, left.z);
            put(x + dofs.w, left.w);
        }
    }
    for (var i = 0u; i < bound(NV); i++) {
        var sum = fetch(x + i) * fetch(QLD_INVERSE + i);
        let last = words[TREE_START + i + 1u] - 1u;
        for (var p = words[TREE_START + i]; p < last; p += 4u) {
            let parts = select(vec4f(), fetch4(QLD + p) * fetch_at(x, ancestors(p, i)), within(p, last));
            sum = sum - parts.x - parts.y - parts.z - parts.w;
        }
        put(x + i, sum);
    }
}
