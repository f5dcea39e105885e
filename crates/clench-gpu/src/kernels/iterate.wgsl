// The iterate of a solve: vectors over the dofs, and row data other than the Jacobian. CPU counterpart:
// `clench-solver/src/iterate.rs`.

// The vectors over the dofs, at these offsets, if they fit workgroup memory; else they are stored with the rows of the
// environment. Each is as long as a row of the tiles of H.
var<workgroup> vectors: array<f32, SHARED_VECTORS>;
const QACC_AT: u32 = 0u;
// M (a − a_unc).
const INERTIAL_AT: u32 = WIDTH;
const GRADIENT_AT: u32 = 2u * WIDTH;
const RAY_AT: u32 = 3u * WIDTH;
// M p.
const MASS_RAY_AT: u32 = 4u * WIDTH;
// Jᵀ f.
const CONSTRAINT_AT: u32 = 5u * WIDTH;
// The unconstrained acceleration.
const SMOOTH_AT: u32 = 6u * WIDTH;
// Conjugate gradients: M⁻¹g; it and the gradient at the last direction. Newton's method: the direction.
const PRECONDITIONED_AT: u32 = select(7u, 3u, NEWTON) * WIDTH;
const LAST_PRECONDITIONED_AT: u32 = 8u * WIDTH;
const LAST_GRADIENT_AT: u32 = 9u * WIDTH;

fn vector(offset: u32) -> f32 {
    if (SHARE_VECTORS) {
        return vectors[offset];
    }
    return row(VECTORS + offset);
}

// Writes an element; all threads see it after the next `join_vectors`.
fn put_vector(offset: u32, x: f32) {
    if (SHARE_VECTORS) {
        vectors[offset] = x;
    } else {
        put_row(VECTORS + offset, x);
    }
}

// Makes all writes to vectors and tiles visible to all threads of the group. If these are in workgroup memory, it is
// faster than `join`, which waits for global memory.
fn join_vectors() {
    if (!SHARE_ALL) {
        storageBarrier();
    }
    workgroupBarrier();
}

// Returns element a of J x. Adjacent threads have adjacent rows, so they read J column by column.
fn jacobian_times(a: u32, x: u32) -> f32 {
    var sum: f32 = 0.0;
    for (var i = 0u; i < bound(NV); i++) {
        sum += row(COLUMNS + i * MAX_ROWS + a) * vector(x + i);
    }
    return sum;
}

// Computes J a − aref, in RESIDUAL.
fn compute_residual(nrow: u32) {
    for (var a = lane; a < nrow; a += GROUP) {
        put_row(RESIDUAL + a, jacobian_times(a, QACC_AT) - row(AREF + a));
    }
    join();
}

// Evaluates every block, and the inertial cost ½ (a − a_unc)ᵀ M (a − a_unc). Returns the cost of the blocks, the number
// that changed their piece, the number on a curved one, and the inertial cost.
fn evaluate(nblock: u32) -> vec4f {
    var sum = vec4f();
    for (var b = lane; b < nblock; b += GROUP) {
        let value = evaluate_block(b);
        let active_set = f32(value.active_set);
        let changed = select(f32(0.0), f32(1.0), row(ACTIVE_SET + b) != active_set);
        put_row(ACTIVE_SET + b, active_set);
        sum += vec4f(value.cost, changed, select(f32(0.0), f32(1.0), value.curved), 0.0);
    }
    for (var i = lane; i < bound(NV); i += GROUP) {
        sum.w += 0.5 * (vector(QACC_AT + i) - vector(SMOOTH_AT + i)) * vector(INERTIAL_AT + i);
    }
    storageBarrier();
    return total(sum);
}

// Computes Jᵀf and the gradient; returns its norm.
fn differentiate(nrow: u32) -> f32 {
    var square: f32 = 0.0;
    for (var i = lane; i < bound(NV); i += GROUP) {
        var sum: f32 = 0.0;
        for (var a = 0u; a < nrow; a++) {
            sum += row(JACOBIAN + a * NV + i) * row(FORCE + a);
        }
        let gradient = vector(INERTIAL_AT + i) - sum;
        put_vector(CONSTRAINT_AT + i, sum);
        put_vector(GRADIENT_AT + i, gradient);
        square += gradient * gradient;
    }
    if (!SHARE_ALL) {
        storageBarrier();
    }
    return sqrt(total_of(square));
}

// Returns the norm of the rounding errors of the gradient, in which opposing forces cancel.
fn rounding(nrow: u32) -> f32 {
    var square: f32 = 0.0;
    for (var i = lane; i < bound(NV); i += GROUP) {
        var size = abs(vector(INERTIAL_AT + i));
        for (var a = 0u; a < nrow; a++) {
            size += abs(row(JACOBIAN + a * NV + i) * row(FORCE + a));
        }
        square += size * size;
    }
    return EPSILON * sqrt(total_of(square));
}

// Recomputes M (a − a_unc) and J a − aref, without accumulated rounding.
fn refresh(nrow: u32, at_smooth: bool) {
    if (at_smooth) {
        for (var i = lane; i < bound(NV); i += GROUP) {
            put_vector(INERTIAL_AT + i, 0.0);
        }
    } else {
        for (var i = lane; i < bound(NV); i += GROUP) {
            put_vector(RAY_AT + i, vector(QACC_AT + i) - vector(SMOOTH_AT + i));
        }
        join_vectors();
        multiply_mass(RAY_AT, INERTIAL_AT);
    }
    compute_residual(nrow);
}

fn advance_iterate(alpha: f32, nrow: u32) {
    for (var i = lane; i < bound(NV); i += GROUP) {
        put_vector(QACC_AT + i, vector(QACC_AT + i) + alpha * vector(RAY_AT + i));
        put_vector(INERTIAL_AT + i, vector(INERTIAL_AT + i) + alpha * vector(MASS_RAY_AT + i));
    }
    for (var a = lane; a < nrow; a += GROUP) {
        put_row(RESIDUAL + a, row(RESIDUAL + a) + alpha * row(RAY + a));
    }
    join();
}
