// The exact line search: the root of the slope by Newton's method inside a bracket. CPU counterpart:
// `clench-solver/src/line_search.rs`, with the same names and explanations.

const RESOLUTION = LINE_SEARCH_RESOLUTION * ROOT_OF_EPSILON;
const UNBOUNDED: f32 = 3.0e38;

struct Step {
    alpha: f32,
    improvement: f32,
    evaluations: u32,
    // True if the evaluations ran out before convergence.
    cut: bool,
}

struct Bracket {
    low: f32,
    high: f32,
    alpha: f32,
    step: f32,
    last_step: f32,
    change_at_low: f32,
}

// Computes M p and J p of the direction at RAY_AT. Returns p·p, the slope at 0, and the second derivative of the parts
// that are quadratic everywhere: inertia and equalities.
fn prepare_ray(nrow: u32, nblock: u32) -> vec3f {
    multiply_mass(RAY_AT, MASS_RAY_AT);
    for (var a = lane; a < nrow; a += GROUP) {
        put_row(RAY + a, jacobian_times(a, RAY_AT));
    }
    join();
    var sum = vec4f();
    for (var i = lane; i < bound(NV); i += GROUP) {
        let p = vector(RAY_AT + i);
        sum += p * vec4f(p, vector(GRADIENT_AT + i), vector(MASS_RAY_AT + i), 0.0);
    }
    for (var b = lane; b < nblock; b += GROUP) {
        if (block(b, BLOCK_COST) == COST_QUADRATIC) {
            sum.z += quadratic_curvature(block(b, BLOCK_ROW), block(b, BLOCK_DIM));
        }
    }
    return total(sum).xyz;
}

// Returns the cost along the ray at α; `second` is the second derivative of the quadratic parts.
fn along(nblock: u32, alpha: f32, second: f32) -> Along {
    var sum = Along(0.0, 0.0, 0.0);
    for (var b = lane; b < nblock; b += GROUP) {
        sum = join_along(sum, block_along(b, alpha));
    }
    let all = total(vec4f(sum.growth, sum.second, sum.divergence, 0.0));
    let quadratic = Along(alpha * second, second, 0.5 * alpha * alpha * second);
    return join_along(quadratic, Along(all.x, all.y, all.z));
}

// Updates the bracket with the slope, the second derivative and the change of the cost at α, and moves α. Returns false
// if it barely moves.
fn narrow(bracket: ptr<function, Bracket>, first: f32, second: f32, change: f32) -> bool {
    let alpha = (*bracket).alpha;
    if (first < 0.0) {
        (*bracket).low = alpha;
        (*bracket).change_at_low = change;
    } else {
        (*bracket).high = alpha;
    }
    let low = (*bracket).low;
    let high = (*bracket).high;
    let newton = alpha - first / second;
    let inside = newton > low && newton < high;
    let headway = abs(newton - alpha) < 0.5 * (*bracket).last_step;
    var next = newton;
    if (high < UNBOUNDED && !(inside && headway)) {
        next = 0.5 * (low + high);
    }
    let step = abs(next - alpha);
    (*bracket).last_step = (*bracket).step;
    (*bracket).step = step;
    if (is_wild(next) || step <= RESOLUTION * abs(next)) {
        return false;
    }
    (*bracket).alpha = next;
    return true;
}

// Finds the minimiser along the ray, whose products are those of `prepare_ray`; `slope_limit` is the slope that counts
// as zero, relative to the length of p.
fn search(nblock: u32, products: vec3f, slope_limit: f32) -> Step {
    let start = products.y;
    if (!(start < 0.0)) {
        return Step(0.0, 0.0, 0u, false);
    }
    let exact = -(RESOLUTION * start);
    let loose = min(slope_limit * sqrt(products.x), -(LINE_SEARCH_CURVATURE * start));
    // A full step is the first guess along Newton's direction; otherwise it comes from the derivatives at 0.
    let guesses = select(1u, 0u, NEWTON);
    var bracket = Bracket(0.0, UNBOUNDED, select(f32(0.0), f32(1.0), NEWTON), UNBOUNDED, UNBOUNDED, 0.0);
    var open = true;
    var change: f32 = 0.0;
    var evaluations = 0u;
    for (var k = 0u; k <= LS_ITERATIONS + guesses; k++) {
        let at = along(nblock, bracket.alpha, products.z);
        change = bracket.alpha * start + at.divergence;
        // The last round evaluates the cost where the search was cut.
        if (k == LS_ITERATIONS + guesses) {
            break;
        }
        evaluations++;
        if (k < guesses) {
            bracket.alpha = -start / at.second;
            continue;
        }
        let first = start + at.growth;
        let steepness = abs(first);
        // The cost must decrease, however loose the tolerance: beyond a kink the slope can be small although the cost
        // has risen.
        let enough = steepness <= loose && change <= LINE_SEARCH_DECREASE * bracket.alpha * start;
        open = steepness > exact && !enough && narrow(&bracket, first, at.second, change);
        if (!open) {
            break;
        }
    }
    let cut = open && bracket.high - bracket.low > RESOLUTION;
    if (open && change > 0.0) {
        return Step(bracket.low, max(-bracket.change_at_low, 0.0), evaluations, cut);
    }
    return Step(bracket.alpha, max(-change, 0.0), evaluations, cut);
}
