// LᵀDL in the pattern of the kinematic tree: row i has the path from the root to dof i, itself last. CPU counterpart:
// `clench-solver/src/tree/factor.rs`; the order of sums is the same.
//
// The factor replaces the matrix in QLD: L below the diagonal, and on it, as in QLD_INVERSE, 1 / D. A team processes
// the dofs level by level, those equally far from the root together: each row gathers the terms that the rows below
// subtract from it. Workgroup memory would not make it faster: a GPU would fit fewer teams.

// Copies the mass matrix for the factorization.
fn copy_mass_to_factor() {
    for (var p = member; p < bound(NNZ); p += TEAM) {
        put(QLD + p, fetch(QM + p));
    }
}

// Returns the position of the diagonal entry of row i.
fn pivot_of(i: u32) -> u32 {
    return words[TREE_START + i + 1u] - 1u;
}

// Returns the entry number `above` of row i, of `level`, minus the terms of all rows below. Those are not yet divided
// by their pivots.
fn eliminated_entry(i: u32, above: u32, level: u32) -> f32 {
    var rest = fetch(QLD + words[TREE_START + i] + above);
    for (var p = words[BELOW_START + i + 1u]; p > words[BELOW_START + i]; p--) {
        let below = words[BELOW_PLACE + p - 1u];
        let multiplier = fetch(QLD + below) * fetch(QLD + words[TREE_PIVOT + below]);
        rest -= multiplier * fetch(QLD + below + above + 1u - level);
    }
    return rest;
}

// Factors the matrix in QLD; returns false if this thread found a pivot that is not positive.
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

// The interface of `substitution.wgsl`, for a team.
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

// Computes x ← (LᵀDL)⁻¹ x, in place.
fn solve_tree(x: u32) {
    join();
    substitute_towards_root(x);
    substitute_towards_leaves(x);
}
