// Removal of the slow slip of soft friction: only friction forces are solved again, without regularization and with
// fixed normal forces. CPU counterpart: `clench-solver/src/noslip.rs`, which derives it. For every friction row WEIGHED
// holds M⁻¹Jᵀ, and for a pyramid RAY holds the sum of its two edges' forces.

// The maximum number of friction rows of a block.
const MAX_FRICTIONS: u32 = 5u;
// The maximum Newton steps for an ellipse's multiplier.
const MULTIPLIER_STEPS: u32 = 20u;

// A of the current block, row by row, then J a − aref of its friction rows.
var<workgroup> friction: array<f32, 30>;
const SLIP_AT: u32 = MAX_FRICTIONS * MAX_FRICTIONS;

// Returns the first friction row of a block; NONE if it has none.
fn first_friction(b: u32) -> u32 {
    let first = block(b, BLOCK_ROW);
    switch block(b, BLOCK_COST) {
        case COST_HUBER: {
            return first;
        }
        case COST_PYRAMID, COST_ELLIPTIC, COST_COULOMB: {
            return first + 1u;
        }
        case COST_QUADRATIC, COST_ONE_SIDED, default: {
            return NONE;
        }
    }
}

// Writes M⁻¹Jᵀ of a row. Corresponds to `solve_tree`.
fn respond(a: u32) {
    let x = WEIGHED + a * NV;
    for (var i = 0u; i < bound(NV); i++) {
        put_row(x + i, row(JACOBIAN + a * NV + i));
    }
    for (var up = 0u; up < bound(NV); up++) {
        let i = NV - 1u - up;
        let value = row(x + i);
        for (var p = words[TREE_START + i]; p + 1u < words[TREE_START + i + 1u]; p++) {
            let ancestor = x + words[TREE_DOF + p];
            put_row(ancestor, row(ancestor) - fetch(QLD + p) * value);
        }
    }
    for (var i = 0u; i < bound(NV); i++) {
        var sum = row(x + i) * fetch(QLD_INVERSE + i);
        for (var p = words[TREE_START + i]; p + 1u < words[TREE_START + i + 1u]; p++) {
            sum -= fetch(QLD + p) * row(x + words[TREE_DOF + p]);
        }
        put_row(x + i, sum);
    }
}

// Computes the responses and edge sums of a block; returns twice the cost of its regularization.
fn prepare_block(b: u32) -> f32 {
    let first = block(b, BLOCK_ROW);
    let end = first + block(b, BLOCK_DIM);
    let is_pyramid = block(b, BLOCK_COST) == COST_PYRAMID;
    let start = first_friction(b);
    var cost: f32 = 0.0;
    for (var a = first; a < end; a++) {
        if (start != NONE && a >= start) {
            respond(a);
        }
        if (!is_pyramid) {
            cost += row(R + a) * row(FORCE + a) * row(FORCE + a);
        } else if (a > first) {
            let side = row(SHAPE + a) * row(RESIDUAL + a);
            let edges = -row(D + first) * min(vec2f(row(RESIDUAL + first)) + vec2f(side, -side), vec2f());
            put_row(RAY + a, edges.x + edges.y);
            cost += row(R + first) * dot(edges, edges);
        }
    }
    return cost;
}

// Fills A and the slip of a block, an entry per thread.
fn fill_friction(start: u32, count: u32) {
    for (var k = lane; k < SLIP_AT + count; k += GROUP) {
        let i = k % MAX_FRICTIONS;
        let a = start + k / MAX_FRICTIONS;
        if (k >= SLIP_AT) {
            friction[k] = jacobian_times(start + k - SLIP_AT, QACC_AT) - row(AREF + start + k - SLIP_AT);
        } else if (i < count && k / MAX_FRICTIONS < count) {
            var sum: f32 = 0.0;
            for (var j = 0u; j < bound(NV); j++) {
                sum += row(JACOBIAN + a * NV + j) * row(WEIGHED + (start + i) * NV + j);
            }
            friction[k] = sum;
        }
    }
    join();
}

// Returns the change of a block's friction, solved row by row, each with the changes of those before it.
fn change_rows(start: u32, count: u32, is_pyramid: bool) -> array<f32, MAX_FRICTIONS> {
    var change = array<f32, MAX_FRICTIONS>();
    for (var j = 0u; j < count; j++) {
        let old = row(FORCE + start + j);
        var limit = row(SHAPE + start + j);
        if (is_pyramid) {
            limit *= row(RAY + start + j);
        }
        var slip = friction[SLIP_AT + j];
        for (var i = 0u; i < j; i++) {
            slip += friction[MAX_FRICTIONS * j + i] * change[i];
        }
        let a = friction[(MAX_FRICTIONS + 1u) * j];
        let free = select(0.0, old - slip / a, a > 0.0);
        change[j] = clamp(free, -limit, limit) - old;
    }
    return change;
}

// For a multiplier λ of an ellipse: g = −(B + λ I)⁻¹ c, its square, and gᵀ(B + λ I)⁻¹g.
struct Shifted {
    g: array<f32, MAX_FRICTIONS>,
    squared: f32,
    slope: f32,
}

// Solves by Cholesky; pivots lost to rounding are replaced by `least`.
fn shifted_minimum(b: array<f32, 25>, c: array<f32, MAX_FRICTIONS>, lambda: f32, least: f32, n: u32) -> Shifted {
    var l = b;
    var g = c;
    for (var j = 0u; j < n; j++) {
        for (var i = j; i < n; i++) {
            var sum = l[MAX_FRICTIONS * i + j] + select(0.0, lambda, i == j);
            for (var k = 0u; k < j; k++) {
                sum -= l[MAX_FRICTIONS * i + k] * l[MAX_FRICTIONS * j + k];
            }
            l[MAX_FRICTIONS * i + j] = select(sum / l[(MAX_FRICTIONS + 1u) * j], sqrt(max(sum, least)), i == j);
        }
        g[j] = -g[j];
    }
    // Forward and backward, then forward again for gᵀ(B + λ I)⁻¹g.
    var found = Shifted(g, 0.0, 0.0);
    for (var round = 0u; round < bound(3u); round++) {
        for (var step = 0u; step < n; step++) {
            let back = round == 1u;
            let i = select(step, n - 1u - step, back);
            var sum = g[i];
            for (var before = 0u; before < step; before++) {
                let k = select(before, n - 1u - before, back);
                sum -= l[MAX_FRICTIONS * max(i, k) + min(i, k)] * g[k];
            }
            g[i] = sum / l[(MAX_FRICTIONS + 1u) * i];
        }
        var square: f32 = 0.0;
        for (var i = 0u; i < n; i++) {
            square += g[i] * g[i];
        }
        if (round == 1u) {
            found.g = g;
            found.squared = square;
        }
        found.slope = square;
    }
    return found;
}

// Returns the change of a block's friction to the optimum within Σ (f / μ)² ≤ normal²; its rows begin at `start`, after
// the normal's.
fn change_ellipse(start: u32, count: u32) -> array<f32, MAX_FRICTIONS> {
    var change = array<f32, MAX_FRICTIONS>();
    var b = array<f32, 25>();
    var c = array<f32, MAX_FRICTIONS>();
    var trace: f32 = 0.0;
    for (var i = 0u; i < count; i++) {
        let mu = row(SHAPE + start + i);
        var linear = friction[SLIP_AT + i];
        for (var j = 0u; j < count; j++) {
            let a = friction[MAX_FRICTIONS * i + j];
            linear -= a * row(FORCE + start + j);
            b[MAX_FRICTIONS * i + j] = mu * a * row(SHAPE + start + j);
        }
        c[i] = mu * linear;
        trace += b[(MAX_FRICTIONS + 1u) * i];
        change[i] = -row(FORCE + start + i);
    }
    let radius = row(FORCE + start - 1u);
    if (radius <= 0.0 || trace <= 0.0) {
        return change;
    }
    var lambda: f32 = 0.0;
    var found = Shifted();
    for (var k = 0u; k < bound(MULTIPLIER_STEPS); k++) {
        found = shifted_minimum(b, c, lambda, trace * EPSILON, count);
        // Newton's step for 1/r − 1/|g(λ)|; λ only grows, so a step back means that it has converged.
        let step = found.squared / found.slope * (sqrt(found.squared) - radius) / radius;
        if (!(step > lambda * EPSILON) || is_wild(step)) {
            break;
        }
        lambda += step;
    }
    // Scales points left outside by rounding onto the ellipse.
    let size = sqrt(found.squared);
    let shrink = select(1.0, radius / size, size > radius);
    for (var i = 0u; i < count; i++) {
        change[i] += found.g[i] * shrink * row(SHAPE + start + i);
    }
    return change;
}

// Improves the friction of a block, from row `start` on; returns the decrease of the objective.
fn improve_friction(b: u32, start: u32) -> f32 {
    let count = block(b, BLOCK_ROW) + block(b, BLOCK_DIM) - start;
    let cost = block(b, BLOCK_COST);
    fill_friction(start, count);
    var change = array<f32, MAX_FRICTIONS>();
    if ((ELLIPTIC_CONES || COULOMB_CONTACTS) && (cost == COST_ELLIPTIC || cost == COST_COULOMB)) {
        change = change_ellipse(start, count);
    } else {
        change = change_rows(start, count, cost == COST_PYRAMID);
    }
    var fall: f32 = 0.0;
    for (var j = 0u; j < count; j++) {
        var slip = friction[SLIP_AT + j];
        for (var i = 0u; i < count; i++) {
            slip += 0.5 * friction[MAX_FRICTIONS * j + i] * change[i];
        }
        fall -= change[j] * slip;
    }
    // All threads have read the data that some now overwrite.
    join();
    for (var j = 0u; j < count; j++) {
        for (var i = lane; i < bound(NV); i += GROUP) {
            put_vector(QACC_AT + i, vector(QACC_AT + i) + change[j] * row(WEIGHED + (start + j) * NV + i));
        }
        if (lane == 0u) {
            put_row(FORCE + start + j, row(FORCE + start + j) + change[j]);
        }
    }
    join();
    return fall;
}

// Sweeps over dry friction, then over contacts, until convergence. `scale` converts costs to the units of the
// tolerance.
fn noslip(nrow: u32, nblock: u32, scale: f32) {
    if (HAS_BACKBONE) {
        if (!any_friction(nblock)) {
            return;
        }
        exchange_backbone();
        accelerate(nblock, false);
    }
    var cost: f32 = 0.0;
    for (var b = lane; b < nblock; b += GROUP) {
        cost += prepare_block(b);
    }
    join();
    var improvement = 0.5 * total_of(cost);
    for (var sweep = 0u; sweep < NOSLIP_ITERATIONS; sweep++) {
        for (var k = 0u; k < 2u * nblock; k++) {
            let b = k % nblock;
            let start = first_friction(b);
            let is_dry = block(b, BLOCK_COST) == COST_HUBER;
            if (start != NONE && is_dry == (k < nblock)) {
                improvement += improve_friction(b, start);
            }
        }
        if (!(scale * improvement >= NOSLIP_TOLERANCE)) {
            break;
        }
        improvement = 0.0;
    }
    differentiate(nrow);
    if (HAS_BACKBONE) {
        exchange_backbone();
        accelerate(nblock, true);
    }
}
