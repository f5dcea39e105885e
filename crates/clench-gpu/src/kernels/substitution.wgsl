// Substitution with the LᵀDL of the tree in QLD and QLD_INVERSE, by levels: dofs equally far from the root are
// independent, one per thread. The order of sums is that of `clench-solver/src/tree/factor.rs`.
//
// Teams and workgroups share this text. Each defines, in `tree.wgsl` and `precondition.wgsl`, the index of a thread and
// the number of workers, the memory of the unknowns at `x`, and the barrier after which all see them.

// Computes x ← L⁻ᵀ x, in place, from the leaves to the root. Each dof subtracts the terms of all its descendants.
fn substitute_towards_root(x: u32) {
    for (var level = NLEVEL; level > 0u; level--) {
        for (var n = words[LEVEL_START + level - 1u] + worker(); n < words[LEVEL_START + level]; n += workers()) {
            let i = words[LEVEL_DOF + n];
            var rest = unknown(x, i);
            for (var p = words[BELOW_START + i + 1u]; p > words[BELOW_START + i]; p--) {
                rest -= fetch(QLD + words[BELOW_PLACE + p - 1u]) * unknown(x, words[BELOW_DOF + p - 1u]);
            }
            put_unknown(x, i, rest);
        }
        join_unknowns();
    }
}

// Computes x ← L⁻¹ D⁻¹ x, in place, from the root to the leaves. Each dof subtracts the terms of all its ancestors.
fn substitute_towards_leaves(x: u32) {
    for (var level = 0u; level < bound(NLEVEL); level++) {
        for (var n = words[LEVEL_START + level] + worker(); n < words[LEVEL_START + level + 1u]; n += workers()) {
            let i = words[LEVEL_DOF + n];
            var rest = unknown(x, i) * fetch(QLD_INVERSE + i);
            for (var p = words[TREE_START + i]; p + 1u < words[TREE_START + i + 1u]; p++) {
                rest -= fetch(QLD + p) * unknown(x, words[TREE_DOF + p]);
            }
            put_unknown(x, i, rest);
        }
        join_unknowns();
    }
}
