// Coulomb's law: friction is limited by the normal force of the solution. CPU counterpart:
// `clench-solver/src/normal_forces.rs`, which explains it.

// The mixing factor γ of the last update of λ, and the number of updates.
var<private> gamma: f32;
var<private> updates: u32;

// Sets λ to the normal forces at the last step's acceleration, or at the unconstrained one. Overwrites the iterate.
fn start_normal_forces(nrow: u32, nblock: u32) {
    updates = 0u;
    predictions = 0u;
    predicted = false;
    for (var i = lane; i < bound(NV); i += GROUP) {
        if (WARMSTART) {
            put_vector(QACC_AT + i, fetch_state(QACC_WARMSTART + i));
        } else {
            put_vector(QACC_AT + i, fetch(QACC_SMOOTH + i));
        }
    }
    join_vectors();
    compute_residual(nrow);
    for (var b = lane; b < nblock; b += GROUP) {
        if (block(b, BLOCK_COST) == COST_COULOMB) {
            let first = block(b, BLOCK_ROW);
            put_row(LAMBDA + first, -(row(D + first) * min(row(RESIDUAL + first), 0.0)));
            put_row(NORMAL_FORCE + first, 0.0);
            put_row(NORMAL_RESIDUAL + first, 0.0);
            put_row(NORMAL_CHANGE + first, 0.0);
        }
    }
    join();
}

// Sets λ to the normal forces of the iterate.
fn replace_normal_forces(nblock: u32) {
    var sum = vec4f();
    for (var b = lane; b < nblock; b += GROUP) {
        if (block(b, BLOCK_COST) == COST_COULOMB) {
            let first = block(b, BLOCK_ROW);
            let force = row(FORCE + first);
            let residual = force - row(LAMBDA + first);
            let growth = residual - row(NORMAL_RESIDUAL + first);
            sum += vec4f(residual * growth, growth * growth, 0.0, 0.0);
            put_row(NORMAL_CHANGE + first, force - row(NORMAL_FORCE + first));
            put_row(NORMAL_FORCE + first, force);
            put_row(NORMAL_RESIDUAL + first, residual);
            put_row(LAMBDA + first, force);
        }
    }
    let sums = total(sum);
    join();
    gamma = 0.0;
    if (updates > 0u && sums.y > 0.0) {
        gamma = max(sums.x / sums.y, MIXING_LEAST);
        gamma = select(MIXING_LEAST, gamma, gamma < MIXING_MOST);
    }
    updates++;
}

// Moves λ by −γ times the change of the normal forces.
fn mix_normal_forces(nblock: u32) {
    for (var b = lane; b < nblock; b += GROUP) {
        if (block(b, BLOCK_COST) == COST_COULOMB) {
            let first = block(b, BLOCK_ROW);
            put_row(LAMBDA + first, max(row(LAMBDA + first) - gamma * row(NORMAL_CHANGE + first), 0.0));
        }
    }
    join();
}
