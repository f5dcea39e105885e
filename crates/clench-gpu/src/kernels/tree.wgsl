// LᵀDL in the pattern of the kinematic tree: row i has the path from the root to dof i, itself last. Sister of
// `clench-solver/src/tree/factor.rs`; the sums run in the same order.
//
// The factor replaces the matrix in QLD: L below the diagonal, and on it, as in QLD_INVERSE, 1 / D. A team goes through the dofs level by level, those
// that are equally far from the root at a time: what the rows below subtract from a row, the row gathers. In the memory of the workgroup the matrix
// is no sooner factored: a card has room for fewer teams then.

// Copies the mass matrix to be factored.
fn copy_mass_to_factor() {
    for (var p = member; p < bound(NNZ); p += TEAM) {
        put(QLD + p, fetch(QM + p));
    }
}

// Where the diagonal entry of row i is.
fn pivot_of(i: u32) -> u32 {
    return words[TREE_START + i + 1u] - 1u;
}

// The entry number `above` of row i, of `level`, less what all rows below subtract. Those are not divided by their pivots yet.
fn eliminated_entry(i: u32, above: u32, level: u32) -> f32 {
    var rest = fetch(QLD + words[TREE_START + i] + above);
    for (var p = words[BELOW_START + i + 1u]; p > words[BELOW_START + i]; p--) {
        let below = words[BELOW_PLACE + p - 1u];
        let multiplier = fetch(QLD + below) * fetch(QLD + words[TREE_PIVOT + below]);
        rest -= multiplier * fetch(QLD + below + above + 1u - level);
    }
    return rest;
}

// Factors what stands in QLD; false where this thread met a pivot that is not positive.
fn factor_tree() -> bool {
    var positive = true;
    for (var level = NLEVEL; level > 0u; level--) {
        let first = words[LEVEL_START + level - 1u];
        let entries = (words[LEVEL_START + level] - first) * level;
        for (var n = member; n < entries; n += TEAM) {
            let i = words[LEVEL_DOF + first + n / level];
            let above = n % level;
            var rest = eliminated_entry(i, above, level);
            if (above + 1u == level) {
                positive = positive && rest > 0.0 && !is_wild(rest);
                rest = 1.0 / rest;
                put(QLD_INVERSE + i, rest);
            }
            put(QLD + words[TREE_START + i] + above, rest);
        }
        join();
    }
    for (var p = member; p < bound(NNZ); p += TEAM) {
        let pivot = words[TREE_PIVOT + p];
        if (p != pivot) {
            put(QLD + p, fetch(QLD + p) * fetch(QLD + pivot));
        }
    }
    join();
    return positive;
}

// What `substitution.wgsl` asks for: the team, and where it has unknowns.
fn worker() -> u32 {
    return member;
}

fn workers() -> u32 {
    return TEAM;
}

fn unknown(x: u32, i: u32) -> f32 {
    return fetch(x + i);
}

fn put_unknown(x: u32, i: u32, value: f32) {
    put(x + i, value);
}

fn join_unknowns() {
    join();
}

// x ← (LᵀDL)⁻¹ x, in place.
fn solve_tree(x: u32) {
    join();
    substitute_towards_root(x);
    substitute_towards_leaves(x);
}
