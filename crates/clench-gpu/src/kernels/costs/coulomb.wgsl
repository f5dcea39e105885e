// Frictional contact by Coulomb's law. CPU counterpart: `clench-solver/src/costs/coulomb.rs`, which derives the
// formulas. The active set has a bit for a normal that presses, and one for friction that slides.

const PRESSES: u32 = 1u;
const SLIDES: u32 = 2u;

// The disc of a block.
struct Disc {
    // K.
    k: f32,
    // λ.
    radius: f32,
    // λ / K, the slip at which friction reaches its limit.
    limit: f32,
}

fn disc_of(first: u32) -> Disc {
    let mu = row(SHAPE + first + 1u);
    let radius = row(LAMBDA + first);
    return Disc(row(D + first + 1u) / (mu * mu), radius, radius * row(R + first + 1u) * mu * mu);
}

fn evaluate_coulomb(first: u32, dim: u32) -> Value {
    // The ray has no effect at α = 0.
    let slip = slip_of(first, dim, 0.0);
    let disc = disc_of(first);
    let slides = slip.t >= disc.limit;
    let d = row(D + first);
    let m = min(row(RESIDUAL + first), 0.0);
    put_row(FORCE + first, -(d * m));
    for (var a = first + 1u; a < first + dim; a++) {
        let limit = disc.radius * scaled_residual(a, 0.0) * slip.inverse * row(SHAPE + a);
        put_row(FORCE + a, -select(row(D + a) * row(RESIDUAL + a), limit, slides));
    }
    let sticking = 0.5 * disc.k * slip.t * slip.t;
    let cost = 0.5 * d * m * m + select(sticking, disc.radius * (slip.t - 0.5 * disc.limit), slides);
    return Value(cost, select(0u, PRESSES, m < 0.0) + select(0u, SLIDES, slides), slides && disc.radius > 0.0);
}

fn coulomb_along(first: u32, dim: u32, alpha: f32) -> Along {
    let normal = edge_along(row(D + first), row(RESIDUAL + first), row(RAY + first), alpha);
    let disc = disc_of(first);
    let before = slip_of(first, dim, 0.0);
    let after = slip_of(first, dim, alpha);
    let slip = slip_path(first, dim, alpha, before, after);
    let huber = move_row(disc.limit, before.t, alpha * slip.along + slip.bend);
    let growth = disc.k * (huber.change * slip.along + min(after.t, disc.limit) * slip.turn);
    let u = slip.along + slip.turn;
    let across = max(slip.squares - u * u, 0.0);
    let second = select(disc.k * slip.squares, disc.radius * after.inverse * across, after.t >= disc.limit);
    let divergence = disc.k * (huber.change * huber.beyond + min(before.t, disc.limit) * slip.bend);
    return join_along(normal, Along(growth, second, divergence));
}

// Returns true if a block has curvature. Friction that sticks has it, with a normal that presses or not.
fn is_stiff_coulomb(b: u32) -> bool {
    let active_set = u32(row(ACTIVE_SET + b));
    return active_set != SLIDES || row(LAMBDA + block(b, BLOCK_ROW)) > 0.0;
}

// Writes column `i` of W J of a block.
fn weigh_coulomb(b: u32, first: u32, dim: u32, i: u32) {
    let active_set = u32(row(ACTIVE_SET + b));
    weigh_edge(first, i, select(0.0, row(D + first), (active_set & PRESSES) != 0u));
    if ((active_set & SLIDES) == 0u) {
        for (var a = first + 1u; a < first + dim; a++) {
            weigh_edge(a, i, row(D + a));
        }
        return;
    }
    let slip = slip_of(first, dim, 0.0);
    let curvature = row(LAMBDA + first) * slip.inverse;
    var along: f32 = 0.0;
    for (var a = first + 1u; a < first + dim; a++) {
        along += scaled_residual(a, 0.0) * slip.inverse * row(SHAPE + a) * row(JACOBIAN + a * NV + i);
    }
    for (var a = first + 1u; a < first + dim; a++) {
        let u = scaled_residual(a, 0.0) * slip.inverse;
        let across = row(SHAPE + a) * row(JACOBIAN + a * NV + i) - u * along;
        put_row(WEIGHED + a * NV + i, curvature * row(SHAPE + a) * across);
    }
}
