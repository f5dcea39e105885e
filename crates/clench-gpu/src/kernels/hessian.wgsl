// H = M + Σ JᵀW J, dense, in the memory of the workgroup, and its factor: LLᵀ, a column at a time, one barrier each.

var<workgroup> hessian: array<f32, PACKED>;
var<workgroup> inverse_pivots: array<f32, NV>;

// A pivot below this part of the diagonal that it is left of is nothing but rounding.
const MIN_PIVOT: f32 = 1.1920929e-7;

// The entry (i, j), i ≥ j, of a lower triangle.
fn packed(i: u32, j: u32) -> u32 {
    return i * (i + 1u) / 2u + j;
}

fn weigh_edge(a: u32, i: u32, weight: f32) {
    put_row(WEIGHED + a * NV + i, weight * row(JACOBIAN + a * NV + i));
}

fn weigh_pyramid(b: u32, first: u32, dim: u32, i: u32) {
    let active_set = u32(row(ACTIVE_SET + b));
    let d = row(D + first);
    let normal = row(JACOBIAN + first * NV + i);
    var sum = d * f32(countOneBits(active_set)) * normal;
    for (var k = 1u; k < dim; k++) {
        let a = first + k;
        let plus = f32((active_set >> (2u * k - 2u)) & 1u);
        let minus = f32((active_set >> (2u * k - 1u)) & 1u);
        let mu = row(SHAPE + a);
        let mixed = d * mu * (plus - minus);
        let j = row(JACOBIAN + a * NV + i);
        sum += mixed * j;
        put_row(WEIGHED + a * NV + i, mixed * normal + d * mu * mu * (plus + minus) * j);
    }
    put_row(WEIGHED + first * NV + i, sum);
}

// Writes column `i` of W J of block `b`.
fn weigh(b: u32, i: u32) {
    let first = block(b, BLOCK_ROW);
    let kind = block(b, BLOCK_KIND);
    if (ELLIPTIC_CONES && kind == CONTACT_ELLIPTIC) {
        weigh_elliptic(first, block(b, BLOCK_DIM), i);
        return;
    }
    switch kind {
        case CONTACT_PYRAMID: {
            weigh_pyramid(b, first, block(b, BLOCK_DIM), i);
        }
        // Of the pieces of quadratic costs, dry friction and one-sided costs alike, 1 has curvature.
        default: {
            let stiff = row(ACTIVE_SET + b) == 1.0;
            for (var a = first; a < first + block(b, BLOCK_DIM); a++) {
                weigh_edge(a, i, select(0.0, row(D + a), stiff));
            }
        }
    }
}

// Whether a block is on a piece with curvature.
fn is_stiff(b: u32) -> bool {
    let active_set = row(ACTIVE_SET + b);
    if (block(b, BLOCK_KIND) == DRY_FRICTION) {
        return active_set == 1.0;
    }
    return active_set != 0.0;
}

fn build_hessian(nblock: u32) {
    for (var k = lane; k < nblock * NV; k += GROUP) {
        if (is_stiff(k / NV)) {
            weigh(k / NV, k % NV);
        }
    }
    join();
    for (var k = lane; k < PACKED; k += GROUP) {
        let i = words[PACKED_ENTRY + k] >> 16u;
        let j = words[PACKED_ENTRY + k] & 0xffffu;
        var sum = row(MASS + k);
        for (var b = 0u; b < nblock; b++) {
            if (is_stiff(b)) {
                let first = block(b, BLOCK_ROW);
                let end = first + block(b, BLOCK_DIM);
                for (var a = first; a < end; a++) {
                    sum += row(JACOBIAN + a * NV + i) * row(WEIGHED + a * NV + j);
                }
            }
        }
        hessian[k] = sum;
    }
    workgroupBarrier();
}

// Row `i` of A in column `k`, less what the columns before have of it.
fn reduced(i: u32, k: u32) -> f32 {
    let own = packed(i, 0u);
    let other = packed(k, 0u);
    var sum = hessian[own + k];
    for (var j = 0u; j < k; j++) {
        sum -= hessian[own + j] * hessian[other + j];
    }
    return sum;
}

// A pivot that rounding has consumed is replaced by its diagonal, so that the direction stays one of descent. Every thread
// computes the pivot for itself.
fn factor_hessian() {
    for (var k = 0u; k < bound(NV); k++) {
        let diagonal = hessian[packed(k, k)];
        let left = reduced(k, k);
        let pivot = select(diagonal, left, left > MIN_PIVOT * diagonal);
        let inverse = inverseSqrt(pivot);
        for (var i = lane; i < bound(NV); i += GROUP) {
            if (i > k) {
                hessian[packed(i, k)] = reduced(i, k) * inverse;
            } else if (i == k) {
                inverse_pivots[k] = inverse;
            }
        }
        workgroupBarrier();
    }
}

// The vector at `x` becomes H⁻¹ x.
fn solve_hessian(x: u32) {
    for (var k = 0u; k < bound(NV); k++) {
        let known = vectors[x + k] * inverse_pivots[k];
        for (var i = lane; i < bound(NV); i += GROUP) {
            if (i > k) {
                vectors[x + i] -= hessian[packed(i, k)] * known;
            }
        }
        workgroupBarrier();
    }
    scale_by_pivots(x);
    for (var down = 0u; down < bound(NV); down++) {
        let k = NV - 1u - down;
        let known = vectors[x + k] * inverse_pivots[k];
        for (var i = lane; i < k; i += GROUP) {
            vectors[x + i] -= hessian[packed(k, i)] * known;
        }
        workgroupBarrier();
    }
    scale_by_pivots(x);
}

fn scale_by_pivots(x: u32) {
    for (var i = lane; i < bound(NV); i += GROUP) {
        vectors[x + i] *= inverse_pivots[i];
    }
    workgroupBarrier();
}
