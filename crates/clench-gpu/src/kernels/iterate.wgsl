// The iterate of a solve: vectors over the dofs in the memory of the workgroup, numbers of rows beside the Jacobian. Sister of
// `clench-solver/src/iterate.rs`.

// Six vectors over the dofs, at these places.
var<workgroup> vectors: array<f32, 6 * NV>;
const QACC_AT: u32 = 0u;
// M (a − a_unc).
const INERTIAL_AT: u32 = NV;
const GRADIENT_AT: u32 = 2u * NV;
const RAY_AT: u32 = 3u * NV;
// M p.
const MASS_RAY_AT: u32 = 4u * NV;
// Jᵀ f.
const CONSTRAINT_AT: u32 = 5u * NV;

// The number i of M x.
fn mass_times(x: u32, i: u32) -> f32 {
    var sum = 0.0;
    for (var j = 0u; j < bound(NV); j++) {
        let place = select(packed(j, i), packed(i, j), j <= i);
        sum += row(MASS + place) * vectors[x + j];
    }
    return sum;
}

// M x, for the vector at `x`, at `out`.
fn multiply_mass(x: u32, out: u32) {
    for (var i = lane; i < bound(NV); i += GROUP) {
        vectors[out + i] = mass_times(x, i);
    }
    workgroupBarrier();
}

// The number a of J x.
fn jacobian_times(a: u32, x: u32) -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < bound(NV); i++) {
        sum += row(JACOBIAN + a * NV + i) * vectors[x + i];
    }
    return sum;
}

// J a − aref, in RESIDUAL.
fn compute_residual(nrow: u32) {
    for (var a = lane; a < nrow; a += GROUP) {
        put_row(RESIDUAL + a, jacobian_times(a, QACC_AT) - row(AREF + a));
    }
    join();
}

// Evaluates every block, and the inertial cost ½ (a − a_unc)ᵀ M (a − a_unc): the cost of the blocks, how many changed their piece,
// how many are on a curved one, and the inertial cost.
fn evaluate(nblock: u32) -> vec4f {
    var sum = vec4f();
    for (var b = lane; b < nblock; b += GROUP) {
        let value = evaluate_block(b);
        let active_set = f32(value.active_set);
        let changed = select(0.0, 1.0, row(ACTIVE_SET + b) != active_set);
        put_row(ACTIVE_SET + b, active_set);
        sum += vec4f(value.cost, changed, select(0.0, 1.0, value.curved), 0.0);
    }
    for (var i = lane; i < bound(NV); i += GROUP) {
        sum.w += 0.5 * (vectors[QACC_AT + i] - fetch(QACC_SMOOTH + i)) * vectors[INERTIAL_AT + i];
    }
    storageBarrier();
    return total(sum);
}

// Jᵀf and the gradient; its norm.
fn differentiate(nrow: u32) -> f32 {
    var square = 0.0;
    for (var i = lane; i < bound(NV); i += GROUP) {
        var sum = 0.0;
        for (var a = 0u; a < nrow; a++) {
            sum += row(JACOBIAN + a * NV + i) * row(FORCE + a);
        }
        let gradient = vectors[INERTIAL_AT + i] - sum;
        vectors[CONSTRAINT_AT + i] = sum;
        vectors[GRADIENT_AT + i] = gradient;
        square += gradient * gradient;
    }
    return sqrt(total(vec4f(square, 0.0, 0.0, 0.0)).x);
}

// M (a − a_unc) and J a − aref anew, without the rounding that steps have added up.
fn refresh(nrow: u32) {
    for (var i = lane; i < bound(NV); i += GROUP) {
        vectors[RAY_AT + i] = vectors[QACC_AT + i] - fetch(QACC_SMOOTH + i);
    }
    workgroupBarrier();
    multiply_mass(RAY_AT, INERTIAL_AT);
    compute_residual(nrow);
}

fn advance_iterate(alpha: f32, nrow: u32) {
    for (var i = lane; i < bound(NV); i += GROUP) {
        vectors[QACC_AT + i] += alpha * vectors[RAY_AT + i];
        vectors[INERTIAL_AT + i] += alpha * vectors[MASS_RAY_AT + i];
    }
    for (var a = lane; a < nrow; a += GROUP) {
        put_row(RESIDUAL + a, row(RESIDUAL + a) + alpha * row(RAY + a));
    }
    join();
}
