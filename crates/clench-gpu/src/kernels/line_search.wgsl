// The exact line search: the root of the slope by Newton's method inside a bracket. CPU counterpart:
// `clench-solver/src/line_search.rs`, with the same names and explanations.

// 0.01 √ε: the resolution of a root.
const RESOLUTION: f32 = 0.01 * ROOT_OF_EPSILON;
const UNBOUNDED: f32 = 3.0e38;

struct Step {
    alpha: f32,
    improvement: f32,
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

// Computes M p and J p of the direction at RAY_AT.
fn prepare_ray(nrow: u32) {
    multiply_mass(RAY_AT, MASS_RAY_AT);
    for (var a = lane; a < nrow; a += GROUP) {
        put_row(RAY + a, jacobian_times(a, RAY_AT));
    }
    join();
}

// Returns derivatives and change of the cost at α; `first` and `second` are the derivatives of its inertial part at 0.
fn along(nblock: u32, alpha: f32, first: f32, second: f32) -> Along {
    var sum = Along(0.0, 0.0, 0.0);
    for (var b = lane; b < nblock; b += GROUP) {
        sum = join_along(sum, block_along(b, alpha));
    }
    let all = total(vec4f(sum.first, sum.second, sum.change, 0.0));
    let inertial = Along(first + alpha * second, second, alpha * (first + 0.5 * alpha * second));
    return join_along(inertial, Along(all.x, all.y, all.z));
}

// Updates the bracket with the result at α and moves α; returns false if it barely moves.
fn narrow(bracket: ptr<function, Bracket>, at: Along) -> bool {
    let alpha = (*bracket).alpha;
    if (at.first < 0.0) {
        (*bracket).low = alpha;
        (*bracket).change_at_low = at.change;
    } else {
        (*bracket).high = alpha;
    }
    let low = (*bracket).low;
    let high = (*bracket).high;
    let newton = alpha - at.first / at.second;
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

// Returns g·p, p·p, and the derivatives of the inertial part.
fn ray_products() -> vec4f {
    var sum = vec4f();
    for (var i = lane; i < bound(NV); i += GROUP) {
        let p = vector(RAY_AT + i);
        sum += p * vec4f(vector(GRADIENT_AT + i), p, vector(INERTIAL_AT + i), vector(MASS_RAY_AT + i));
    }
    return total(sum);
}

// Finds the minimiser along the ray; `slope_limit` is the slope that counts as zero, relative to the length of p.
fn search(nblock: u32, slope_limit: f32) -> Step {
    let products = ray_products();
    let start = products.x;
    let descends = start < 0.0;
    let exact = max(4.0 * EPSILON * abs(products.z), -(RESOLUTION * start));
    let loose = min(slope_limit * sqrt(products.y), -(0.1 * start));
    // A full step is the first guess along Newton's direction; otherwise it comes from the derivatives at 0.
    let first = select(f32(0.0), f32(1.0), descends && NEWTON);
    let guesses = select(1u, 0u, NEWTON);
    var bracket = Bracket(0.0, UNBOUNDED, first, UNBOUNDED, UNBOUNDED, 0.0);
    var open = descends;
    var change: f32 = 0.0;
    for (var k = 0u; k <= LS_ITERATIONS + guesses; k++) {
        let at = along(nblock, bracket.alpha, products.z, products.w);
        if (k < guesses) {
            bracket.alpha = select(0.0, -start / at.second, descends);
            continue;
        }
        change = at.change;
        if (!open || k == LS_ITERATIONS + guesses) {
            break;
        }
        let steepness = abs(at.first);
        // The cost must fall regardless of the tolerance.
        let enough = steepness <= loose && change <= 1e-4 * bracket.alpha * start;
        open = steepness > exact && !enough;
        if (open) {
            open = narrow(&bracket, at);
        }
        if (!open) {
            break;
        }
    }
    var alpha = bracket.alpha;
    if (open && change > 0.0) {
        alpha = bracket.low;
        change = bracket.change_at_low;
    }
    // A convex function falls by no more than its slope at 0 predicts.
    let improvement = max(min(-change, -(alpha * start)), 0.0);
    return Step(alpha, improvement, open && bracket.high - bracket.low > RESOLUTION);
}
