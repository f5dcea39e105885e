// Continuation: very stiff elliptic cones are approached through softer ones. CPU counterpart:
// `clench-solver/src/continuation.rs`, which explains it. Only Newton's method uses it.

// The fraction of a cone's inverse inertia that is added to R; zero while the original problem is solved.
var<private> level: f32;
// The largest product of inverse inertia and D.
var<private> stiffest: f32;

// Returns the factor by which the current stage divides the stiffness of an elliptic cone.
fn stiffening(first: u32) -> f32 {
    if (level == 0.0) {
        // The inverse inertia may still be that of another step, even NaN.
        return 1.0;
    }
    return 1.0 + row(D + first) * level * row(CONE_INERTIA + first);
}

// Begins the first stage if a cone is very stiff; returns true if so. Overwrites a vector.
fn start_continuation(nblock: u32) -> bool {
    for (var i = lane; i < bound(NV); i += GROUP) {
        put_vector(RAY_AT + i, 1.0 / fetch(QM + words[TREE_START + i + 1u] - 1u));
    }
    join_vectors();
    var largest: f32 = 0.0;
    for (var b = lane; b < nblock; b += GROUP) {
        if (block(b, BLOCK_COST) == COST_ELLIPTIC) {
            let first = block(b, BLOCK_ROW);
            var sum: f32 = 0.0;
            for (var i = 0u; i < bound(NV); i++) {
                let j = row(JACOBIAN + first * NV + i);
                sum += j * j * vector(RAY_AT + i);
            }
            put_row(CONE_INERTIA + first, sum);
            largest = max(largest, sum * row(D + first));
        }
    }
    stiffest = greatest(largest);
    level = select(f32(0.0), f32(1.0 / CONTINUATION_FIRST), stiffest > CONTINUATION_STIFF);
    return level > 0.0;
}

// Moves to the next stage if the current one has ended; returns true if so.
fn advance_continuation(improvement: f32, cost: f32) -> bool {
    if (improvement > CONTINUATION_SETTLED * cost) {
        return false;
    }
    let next = level / CONTINUATION_STAGE;
    level = select(next, 0.0, next * stiffest < 1.0);
    return true;
}
