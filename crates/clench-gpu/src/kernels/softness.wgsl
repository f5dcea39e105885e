// The softness of a constraint. CPU counterpart: `constraint/softness.rs`, which derives the formulas.

const LEAST: f32 = 1e-15;

// The softness by solref and solimp (five numbers) at a violation: impedance d, stiffness k d, damping b.
struct Softness {
    impedance: f32,
    stiffness: f32,
    damping: f32,
}

fn clamp_impedance(d: f32) -> f32 {
    return clamp(d, MIN_IMPEDANCE, MAX_IMPEDANCE);
}

fn is_mixed(solref: vec2f) -> bool {
    return (solref.x > 0.0) != (solref.y > 0.0);
}

// Returns k, without the factor d, and b.
fn spring_damper(solref: vec2f, dmax_given: f32) -> vec2f {
    let dmax = clamp_impedance(dmax_given);
    if (solref.x > 0.0) {
        let timeconst = max(solref.x, MIN_TIMECONST);
        let squares = dmax * dmax * timeconst * timeconst * solref.y * solref.y;
        return vec2f(1.0 / max(squares, LEAST), 2.0 / max(dmax * timeconst, LEAST));
    }
    return vec2f(-solref.x / (dmax * dmax), -solref.y / dmax);
}

// Returns base^exponent for exponents of at least 1. It is exact for small integers, unlike a device's own power.
fn raise(base: f32, exponent: f32) -> f32 {
    if (exponent != round(exponent) || exponent > 8.0) {
        return power_of(base, exponent);
    }
    var power = base;
    for (var k = 1u; k < u32(exponent); k++) {
        power *= base;
    }
    return power;
}

// Maps x in [0, 1] to [0, 1].
fn spline(x: f32, midpoint: f32, power: f32) -> f32 {
    if (power == 1.0) {
        return x;
    }
    let below = x <= midpoint;
    let base = select(1.0 - x, x, below);
    let edge = select(1.0 - midpoint, midpoint, below);
    let y = raise(base, power) / raise(edge, power - 1.0);
    return select(1.0 - y, y, below);
}

// Returns the impedance at the violation `r`, with solimp at `offset`.
fn impedance(offset: u32, r: f32) -> f32 {
    let dmin = clamp_impedance(parameter(offset));
    let dmax = clamp_impedance(parameter(offset + 1u));
    let width = parameter(offset + 2u);
    if (dmin == dmax || width <= LEAST) {
        return 0.5 * (dmin + dmax);
    }
    let x = abs(r) / width;
    if (x >= 1.0) {
        return dmax;
    }
    if (x <= 0.0) {
        return dmin;
    }
    let midpoint = clamp_impedance(parameter(offset + 3u));
    return dmin + spline(x, midpoint, max(parameter(offset + 4u), 1.0)) * (dmax - dmin);
}

// Returns the softness, with solref at `offset`, then solimp.
fn soften(offset: u32, r: f32) -> Softness {
    var solref = vec2f(parameter(offset), parameter(offset + 1u));
    if (is_mixed(solref)) {
        solref = vec2f(0.02, 1.0);
    }
    let law = spring_damper(solref, parameter(offset + 3u));
    let d = impedance(offset + 2u, r);
    return Softness(d, law.x * d, law.y);
}

// Returns the softness for steps that evaluate it at their end, with solref at `offset`: a spring that a step cannot
// resolve becomes the stiffest that it can.
fn resolved(soft: Softness, offset: u32) -> Softness {
    let solref = vec2f(parameter(offset), parameter(offset + 1u));
    let kappa = TIMESTEP * TIMESTEP * soft.stiffness;
    if (!LIMITED_STIFFNESS || !(solref.x > 0.0 || is_mixed(solref)) || kappa <= 1.0) {
        return soft;
    }
    return Softness(soft.impedance, 1.0 / (TIMESTEP * TIMESTEP), soft.damping * sqrt(1.0 / kappa));
}

// Returns R of a row with the inverse inertia `a`.
fn regularization(d: f32, a: f32) -> f32 {
    return max((1.0 - d) * a / d, LEAST);
}
