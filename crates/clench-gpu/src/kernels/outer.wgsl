// Products of sparse rows in the pattern of the mass matrix. CPU counterpart: `add_outer` in `dynamics/derivatives.rs`.

// Adds `scale` JᵀJ of a sparse row J, with its dofs at `dofs` and its entries at `entries`, to the matrix at `matrix`,
// where the pattern has an entry.
fn add_outer(matrix: u32, dofs: u32, entries: u32, start: u32, end: u32, scale: f32) {
    for (var k = start; scale != 0.0 && k < end; k++) {
        let i = words[dofs + k];
        for (var l = start; l < end; l++) {
            for (var p = words[TREE_START + i]; p < words[TREE_START + i + 1u]; p++) {
                if (words[TREE_DOF + p] == words[dofs + l]) {
                    add(matrix + p, scale * fetch(entries + k) * fetch(entries + l));
                }
            }
        }
    }
}
