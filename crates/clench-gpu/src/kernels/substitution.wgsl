// Substitution with the LᵀDL of the tree that is in QLD and QLD_INVERSE, by levels: the dofs that are equally far from the root do not wait for each other,
// each is a thread's. Sums run in the order of `clench-solver/src/tree/factor.rs`.
//
// Teams and workgroups share this text. Each says, in `tree.wgsl` and in `precondition.wgsl`, which of how many workers a thread is, where the unknowns
// at `x` are, and how its threads wait until all see them.

// x ← L⁻ᵀ x, in place: from the leaves to the root. Each dof subtracts all that is below it.
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

// x ← L⁻¹ D⁻¹ x, in place: from the root to the leaves. Each dof subtracts all that is above it.
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
