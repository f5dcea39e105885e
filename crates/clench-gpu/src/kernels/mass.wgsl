// The mass matrix of an environment for products in its workgroup. CPU counterpart: `clench-solver/src/tree/matrix.rs`.
// If Newton's method has a dense factor of H in workgroup memory, M is dense as well: adjacent threads read adjacent
// numbers. Else it has the pattern of the tree.

// Copies it to the data of the problem; returns its trace.
fn copy_mass() -> f32 {
    if (DENSE_MASS) {
        for (var k = lane; k < bound(NV * NV); k += GROUP) {
            put_row(MASS + k, 0.0);
        }
        join();
    }
    for (var p = lane; p < NNZ; p += GROUP) {
        let entry = fetch(QM + p);
        if (DENSE_MASS) {
            let i = words[TREE_DOF + words[TREE_PIVOT + p]];
            let j = words[TREE_DOF + p];
            put_row(MASS + NV * i + j, entry);
            put_row(MASS + NV * j + i, entry);
        } else {
            put_row(MASS + p, entry);
        }
    }
    var diagonal: f32 = 0.0;
    for (var i = lane; i < bound(NV); i += GROUP) {
        diagonal += fetch(QM + words[TREE_START + i + 1u] - 1u);
    }
    join();
    return total_of(diagonal);
}

// Returns the number of ancestors of a dof: its position in the rows of its descendants.
fn depth(i: u32) -> u32 {
    return words[TREE_START + i + 1u] - words[TREE_START + i] - 1u;
}

// Returns the entry (i, j) of M.
fn mass_entry(i: u32, j: u32) -> f32 {
    if (DENSE_MASS) {
        return row(MASS + NV * i + j);
    }
    let below = max(i, j);
    let above = min(i, j);
    let offset = words[TREE_START + below] + depth(above);
    if (offset < words[TREE_START + below + 1u] && words[TREE_DOF + offset] == above) {
        return row(MASS + offset);
    }
    return 0.0;
}

// Returns element i of M x: the terms before the diagonal, on it, and below it.
fn mass_times(x: u32, i: u32) -> f32 {
    var sum: f32 = 0.0;
    if (DENSE_MASS) {
        for (var j = 0u; j < bound(NV); j++) {
            sum += row(MASS + NV * j + i) * vector(x + j);
        }
        return sum;
    }
    for (var p = words[TREE_START + i]; p < words[TREE_START + i + 1u]; p++) {
        sum += row(MASS + p) * vector(x + words[TREE_DOF + p]);
    }
    for (var p = words[BELOW_START + i]; p < words[BELOW_START + i + 1u]; p++) {
        sum += row(MASS + words[BELOW_PLACE + p]) * vector(x + words[BELOW_DOF + p]);
    }
    return sum;
}

// Computes M x, for the vector at `x`, at `out`.
fn multiply_mass(x: u32, out: u32) {
    for (var i = lane; i < bound(NV); i += GROUP) {
        put_vector(out + i, mass_times(x, i));
    }
    join_vectors();
}
