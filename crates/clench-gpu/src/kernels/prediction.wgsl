// Predicts the normal forces that a Newton step of Coulomb's law leads to. CPU counterparts:
// `clench-solver/src/prediction.rs`, which explains it, and `sliding.rs`. Nothing is predicted with more than
// MAX_ELIMINATED sliding contacts.

// The numbers of a row of the system: its right-hand side comes last.
const SYSTEM_WIDTH: u32 = MAX_ELIMINATED + 1u;

// The number of predictions in a solve.
var<private> predictions: u32;
// True if the predicted step is a candidate for the next direction.
var<private> predicted: bool;

// Returns true if another Newton step predicts λ first.
fn can_predict() -> bool {
    return NEWTON && COULOMB_CONTACTS && f32(updates) < MAX_UPDATES && f32(predictions) < MAX_PREDICTIONS;
}

fn presses(b: u32) -> bool {
    return (u32(row(ACTIVE_SET + b)) & PRESSES) != 0u;
}

// Returns true if the friction of a contact slides under a load.
fn slides_under_load(b: u32) -> bool {
    if (block(b, BLOCK_COST) != COST_COULOMB || (u32(row(ACTIVE_SET + b)) & SLIDES) == 0u) {
        return false;
    }
    return presses(b) || row(LAMBDA + block(b, BLOCK_ROW)) > 0.0;
}

// Lists the sliding contacts, in order; returns their number, of which at most MAX_ELIMINATED are listed.
fn list_sliding(nblock: u32) -> u32 {
    var count = 0u;
    for (var start = 0u; start < nblock; start += GROUP) {
        let b = start + lane;
        var slides = false;
        if (b < nblock) {
            slides = slides_under_load(b);
        }
        let sums = sums_up_to(vec4f(select(f32(0.0), f32(1.0), slides), 0.0, 0.0, 0.0));
        let k = count + u32(sums.before.x);
        if (slides && k < MAX_ELIMINATED) {
            put_row(SLIDING_BLOCKS + k, f32(b));
        }
        count += u32(sums.all.x);
    }
    join();
    return count;
}

// Returns D J_n x of a contact, for the vector at RAY_AT; zero if its normal does not press.
fn normal_growth(b: u32) -> f32 {
    if (!presses(b)) {
        return 0.0;
    }
    let first = block(b, BLOCK_ROW);
    var sum: f32 = 0.0;
    for (var i = 0u; i < bound(NV); i++) {
        sum += row(JACOBIAN + first * NV + i) * vector(RAY_AT + i);
    }
    return row(D + first) * sum;
}

// Returns f − λ of a contact.
fn missing_force(b: u32) -> f32 {
    let first = block(b, BLOCK_ROW);
    return row(FORCE + first) - row(LAMBDA + first);
}

// Returns entry `i` of the direction of sliding friction of a contact.
fn friction_column(b: u32, i: u32) -> f32 {
    let first = block(b, BLOCK_ROW);
    let dim = block(b, BLOCK_DIM);
    let inverse = slip_of(first, dim, 0.0).inverse;
    var sum: f32 = 0.0;
    for (var a = first + 1u; a < first + dim; a++) {
        sum += scaled_residual(a, 0.0) * inverse * row(SHAPE + a) * row(JACOBIAN + a * NV + i);
    }
    return sum;
}

// Builds the system. WEIGHED holds H⁻¹ B of each unknown, at the first row of its contact; RAY_AT then holds H⁻¹ g.
fn build_system(count: u32) {
    for (var k = 0u; k <= bound(count); k++) {
        let is_gradient = k == count;
        var b = 0u;
        if (!is_gradient) {
            b = u32(row(SLIDING_BLOCKS + k));
        }
        for (var i = lane; i < bound(TILE * NTILE); i += GROUP) {
            var x: f32 = 0.0;
            if (i < NV && is_gradient) {
                x = vector(GRADIENT_AT + i);
            } else if (i < NV) {
                x = friction_column(b, i);
            }
            put_vector(RAY_AT + i, x);
        }
        join_vectors();
        solve_hessian(RAY_AT, MASS_RAY_AT);
        for (var i = lane; !is_gradient && i < bound(NV); i += GROUP) {
            put_row(WEIGHED + block(b, BLOCK_ROW) * NV + i, vector(RAY_AT + i));
        }
        if (lane < count) {
            let own = u32(row(SLIDING_BLOCKS + lane));
            let growth = normal_growth(own);
            if (is_gradient) {
                put_row(SLIDING_SYSTEM + SYSTEM_WIDTH * lane + MAX_ELIMINATED, missing_force(own) + growth);
            } else {
                put_row(SLIDING_SYSTEM + SYSTEM_WIDTH * lane + k, select(f32(0.0), f32(1.0), lane == k) - growth);
            }
        }
        join();
    }
}

// Replaces the right-hand sides by the solution. A contact whose pivot is not positive jams: its unknown becomes
// zero.
fn eliminate(count: u32) {
    for (var k = 0u; k < bound(count); k++) {
        let pivots = SLIDING_SYSTEM + SYSTEM_WIDTH * k;
        if (!(row(pivots + k) > ROOT_OF_EPSILON)) {
            put_row(SLIDING_JAMS + k, 1.0);
            put_row(pivots + MAX_ELIMINATED, 0.0);
            put_row(pivots + k, 1.0);
            for (var j = k + 1u; j < count; j++) {
                put_row(pivots + j, 0.0);
            }
        } else {
            put_row(SLIDING_JAMS + k, 0.0);
        }
        let inverse = 1.0 / row(pivots + k);
        for (var i = k + 1u; i < count; i++) {
            let below = SLIDING_SYSTEM + SYSTEM_WIDTH * i;
            let multiplier = row(below + k) * inverse;
            for (var j = k + 1u; j < count; j++) {
                put_row(below + j, row(below + j) - multiplier * row(pivots + j));
            }
            put_row(below + MAX_ELIMINATED, row(below + MAX_ELIMINATED) - multiplier * row(pivots + MAX_ELIMINATED));
        }
    }
    for (var up = 0u; up < bound(count); up++) {
        let k = count - 1u - up;
        let pivots = SLIDING_SYSTEM + SYSTEM_WIDTH * k;
        var rest = row(pivots + MAX_ELIMINATED);
        for (var j = k + 1u; j < count; j++) {
            rest -= row(pivots + j) * row(SLIDING_SYSTEM + SYSTEM_WIDTH * j + MAX_ELIMINATED);
        }
        put_row(pivots + MAX_ELIMINATED, rest / row(pivots + k));
    }
}

// Returns δ of a contact, for the predicted step at RAY_AT.
fn predicted_change(b: u32, count: u32) -> f32 {
    for (var k = 0u; k < bound(count); k++) {
        if (u32(row(SLIDING_BLOCKS + k)) == b) {
            let jams = row(SLIDING_JAMS + k) > 0.0;
            return select(row(SLIDING_SYSTEM + SYSTEM_WIDTH * k + MAX_ELIMINATED), missing_force(b), jams);
        }
    }
    return missing_force(b) + normal_growth(b);
}

// Moves λ of every contact by δ; most cycles end because some moves are halved.
fn move_normal_forces(nblock: u32, count: u32) {
    predictions++;
    let over = f32(predictions) - FULL_PREDICTIONS;
    let halved = over > 0.0 && over - PREDICTION_CYCLE * floor(over / PREDICTION_CYCLE) == 0.0;
    let share = select(f32(1.0), f32(0.5), halved);
    for (var b = lane; b < nblock; b += GROUP) {
        if (block(b, BLOCK_COST) == COST_COULOMB) {
            let first = block(b, BLOCK_ROW);
            let lambda = row(LAMBDA + first);
            let moved = max(lambda + predicted_change(b, count), 0.0);
            put_row(LAMBDA + first, lambda + share * (moved - lambda));
        }
    }
    join();
}

// Moves λ to the prediction if a contact slides. RAY_AT then holds the predicted step d.
fn predict(nblock: u32) {
    predicted = false;
    let count = list_sliding(nblock);
    if (agreed(select(0u, 1u, count > 0u && count <= MAX_ELIMINATED)) == 0u) {
        return;
    }
    build_system(count);
    if (lane == 0u) {
        eliminate(count);
    }
    join();
    var jams: f32 = 0.0;
    for (var k = 0u; k < bound(count); k++) {
        jams += row(SLIDING_JAMS + k);
    }
    for (var i = lane; i < bound(NV); i += GROUP) {
        var x = vector(RAY_AT + i);
        for (var k = 0u; k < count; k++) {
            let delta = row(SLIDING_SYSTEM + SYSTEM_WIDTH * k + MAX_ELIMINATED);
            x += delta * row(WEIGHED + block(u32(row(SLIDING_BLOCKS + k)), BLOCK_ROW) * NV + i);
        }
        put_vector(RAY_AT + i, x);
    }
    join_vectors();
    move_normal_forces(nblock, count);
    for (var i = lane; i < bound(NV); i += GROUP) {
        put_vector(RAY_AT + i, -vector(RAY_AT + i));
    }
    join_vectors();
    predicted = jams == 0.0;
}

// Returns true if the predicted step is the next direction: if it descends steeply enough with the new limits.
fn takes_prediction(norm: f32) -> bool {
    if (!predicted) {
        return false;
    }
    var sum = vec4f();
    for (var i = lane; i < bound(NV); i += GROUP) {
        let d = vector(RAY_AT + i);
        sum += vec4f(-(d * vector(GRADIENT_AT + i)), d * d, 0.0, 0.0);
    }
    let sums = total(sum);
    return sums.x > MIN_COSINE * sqrt(sums.y) * norm;
}
