// The common loop of Newton and conjugate gradients, and the kernel: one workgroup per environment. CPU counterpart:
// `clench-solver/src/descent.rs`.

// The rounds of a solve. Drivers inline a function at every call site: hence one loop with one call site for each large
// one.
const AT_SMOOTH: u32 = 0u;
const AT_WARMSTART: u32 = 1u;
const BACK_AT_SMOOTH: u32 = 2u;
const DESCEND: u32 = 3u;
const REFRESH: u32 = 4u;
// Newton's method checks the duality gap before its first step, CG always. `gap.wgsl` computes the final gap on
// request.
const PROVE: u32 = 5u;
// Evaluates a new stage of continuation; at the end of a solve the original problem.
const SOFTEN: u32 = 6u;
const DONE: u32 = 7u;
// Coulomb's law: before the first round the limits of friction are set; at the end of a solve they are set again, and
// mixed with the last ones if the gradient with them is too large.
const START_LIMITS: u32 = 8u;
const SET_LIMITS: u32 = 9u;
const MIX_LIMITS: u32 = 10u;
// Newton's method predicts them before a step.
const PREDICT_LIMITS: u32 = 11u;

// The maximum number of iterations without noticeable progress.
const PATIENCE = select(CG_PATIENCE, NEWTON_PATIENCE, NEWTON);

// The state of a solve.
struct Convergence {
    // The cost at the unconstrained acceleration.
    cold: f32,
    // 1 / (mean inertia × nv), the scale of gradients and costs.
    scale: f32,
    // The norm of the gradient, and the duality gap.
    norm: f32,
    gap: f32,
    // No piece has changed since the last factorization, and none is curved: the factor is valid.
    same_hessian: bool,
    curved: bool,
    refreshed: bool,
    // True if there is a previous direction for conjugation.
    started: bool,
    // The smallest gradient norm so far, and the iterations since it fell noticeably.
    best: f32,
    idle: f32,
    iterations: u32,
    evaluations: u32,
    status: u32,
    // Coulomb's law: the status of the end if the limits of friction are those of the solution.
    pending: u32,
    // True once the status is final.
    ended: bool,
}

// Sets the iterate of a round: the unconstrained acceleration, that of the last step, or the current one.
fn start_at(round: u32) {
    for (var i = lane; i < bound(NV); i += GROUP) {
        if (round == AT_SMOOTH) {
            put_vector(SMOOTH_AT + i, fetch(QACC_SMOOTH + i));
            put_vector(CONSTRAINT_AT + i, 0.0);
        }
        // The processor solves each island alone: the acceleration of sleeping trees must not affect the choice.
        if (round == AT_WARMSTART && !(SLEEP && !is_dof_awake(i))) {
            put_vector(QACC_AT + i, fetch_state(QACC_WARMSTART + i));
        } else if (round != REFRESH) {
            put_vector(QACC_AT + i, vector(SMOOTH_AT + i));
        }
    }
    join_vectors();
}

// Ends the solve. Returns the next round: results are those of the original problem.
fn end(c: ptr<function, Convergence>, status: u32) -> u32 {
    (*c).status = status;
    (*c).ended = true;
    if (level > 0.0) {
        level = 0.0;
        return SOFTEN;
    }
    return DONE;
}

// Ends the solve if friction is limited by its own normal forces. Returns the next round.
fn end_if_consistent(c: ptr<function, Convergence>, status: u32) -> u32 {
    if (!COULOMB_CONTACTS) {
        return end(c, status);
    }
    (*c).pending = status;
    return SET_LIMITS;
}

// Returns the round after the limits of friction were set to the normal forces.
fn after_limits(c: ptr<function, Convergence>, nrow: u32) -> u32 {
    if ((*c).scale * (*c).norm <= TOLERANCE || (*c).norm <= rounding(nrow)) {
        return end(c, (*c).pending);
    }
    return MIX_LIMITS;
}

// Returns the next round of a solve that has not converged.
fn go_on(c: ptr<function, Convergence>) -> u32 {
    if ((*c).iterations >= ITERATIONS) {
        return end(c, SOLVE_ITERATION_LIMIT);
    }
    predicted = false;
    return select(DESCEND, PREDICT_LIMITS, can_predict());
}

// Returns the round after the choice of the start. Newton's forces are trusted as well: the gap alone, a bound in cost,
// would tolerate errors in stiff ones.
fn after_start(c: ptr<function, Convergence>, nblock: u32) -> u32 {
    if (is_wild((*c).norm)) {
        return end(c, SOLVE_NON_FINITE);
    }
    if (NEWTON && (*c).scale * (*c).norm <= TOLERANCE) {
        return PROVE;
    }
    return after_proof(c, nblock);
}

// Returns the round after the duality gap at the start is known, if it counts.
fn after_proof(c: ptr<function, Convergence>, nblock: u32) -> u32 {
    let gap_counts = !NEWTON || (*c).scale * (*c).norm <= TOLERANCE;
    if (gap_counts && (*c).scale * (*c).gap <= TOLERANCE) {
        return end_if_consistent(c, SOLVE_PROVEN);
    }
    if (NEWTON && ELLIPTIC_CONES && start_continuation(nblock)) {
        return SOFTEN;
    }
    return go_on(c);
}

// Returns the round after the iterate or the problem was changed by more than a step.
fn after_placing(c: ptr<function, Convergence>, round: u32, totals: vec4f, nblock: u32) -> u32 {
    (*c).curved = totals.z > 0.0;
    (*c).same_hessian = false;
    (*c).started = false;
    if (round == REFRESH || round == SOFTEN || round == MIX_LIMITS) {
        (*c).best = (*c).norm;
        (*c).idle = 0.0;
        (*c).refreshed = ((*c).refreshed || round == REFRESH) && round != MIX_LIMITS;
        if ((*c).ended) {
            return DONE;
        }
        return go_on(c);
    }
    if (round == AT_SMOOTH && nblock == 0u) {
        (*c).status = SOLVE_UNCONSTRAINED;
        return DONE;
    }
    if (round == AT_SMOOTH && WARMSTART) {
        (*c).cold = totals.x + totals.w;
        return AT_WARMSTART;
    }
    // The last acceleration is a good start if it costs less than the unconstrained one.
    if (round == AT_WARMSTART && !(totals.x + totals.w < (*c).cold)) {
        return BACK_AT_SMOOTH;
    }
    return after_start(c, nblock);
}

// Returns the round after a step. A stalled solve is refreshed once, without accumulated rounding.
fn after_step(c: ptr<function, Convergence>, step: Step, totals: vec4f, nrow: u32) -> u32 {
    let curved = totals.z > 0.0;
    // A full Newton step over a quadratic interval ends at the minimum: the size of that step is irrelevant.
    let exact = NEWTON && totals.y == 0.0 && !curved && !(*c).curved;
    // Predictions change pieces as well.
    (*c).same_hessian = exact && !COULOMB_CONTACTS;
    (*c).curved = curved;
    (*c).started = true;
    (*c).iterations++;
    (*c).evaluations += step.evaluations;
    if (is_wild((*c).norm)) {
        return end(c, SOLVE_NON_FINITE);
    }
    let cost = totals.x + totals.w;
    if (level > 0.0) {
        if (advance_continuation(step.improvement, cost)) {
            return SOFTEN;
        }
        record_progress(c, step, cost, exact);
        return go_on(c);
    }
    let small = select((*c).gap, (*c).norm, NEWTON);
    let settled = !NEWTON || (*c).scale * step.improvement <= TOLERANCE || exact;
    if ((*c).scale * small <= TOLERANCE && settled) {
        return end_if_consistent(c, SOLVE_CONVERGED);
    }
    // At this minimum, a gradient that rounding of its terms explains is zero to working precision.
    if (exact && (*c).norm <= rounding(nrow)) {
        return end_if_consistent(c, SOLVE_NO_PROGRESS);
    }
    record_progress(c, step, cost, exact);
    let stuck = step.alpha == 0.0 || (*c).idle >= PATIENCE;
    if (stuck && (*c).refreshed) {
        if (step.cut && step.alpha == 0.0) {
            return end(c, SOLVE_ITERATION_LIMIT);
        }
        return end_if_consistent(c, SOLVE_NO_PROGRESS);
    }
    if (stuck) {
        return REFRESH;
    }
    return go_on(c);
}

// Counts the iterations since the gradient fell noticeably or the cost improved.
fn record_progress(c: ptr<function, Convergence>, step: Step, cost: f32, exact: bool) {
    let negligible = step.improvement <= NEGLIGIBLE_ROUNDINGS * EPSILON * cost || exact;
    let fell = (*c).norm < NOTICEABLE_FALL * (*c).best;
    if (fell) {
        (*c).best = (*c).norm;
    }
    (*c).idle = select((*c).idle + 1.0, 0.0, fell || !negligible);
}

fn minimise(nrow: u32, nblock: u32, inertia: f32) -> Convergence {
    var c = Convergence();
    c.scale = 1.0 / inertia;
    c.best = UNBOUNDED;
    level = 0.0;
    var next = select(AT_SMOOTH, START_LIMITS, COULOMB_CONTACTS);
    loop {
        let round = agreed(next);
        if (round == DONE) {
            break;
        }
        var step = Step(0.0, 0.0, 0u, false);
        var totals = vec4f();
        if (NEWTON && (round == DESCEND || round == PREDICT_LIMITS)) {
            factor_newton(c.same_hessian, nblock);
        }
        if (round == DESCEND) {
            if (!NEWTON) {
                direct_conjugate(c.started);
            } else if (!(COULOMB_CONTACTS && takes_prediction(c.norm))) {
                direct_newton();
            }
            let products = prepare_ray(nrow, nblock);
            step = search(nblock, products, TOLERANCE * LS_TOLERANCE * inertia);
            advance_iterate(step.alpha, nrow);
        } else if (round < DESCEND || round == REFRESH) {
            start_at(round);
            refresh(nrow, round == AT_SMOOTH || round == BACK_AT_SMOOTH);
        } else if (COULOMB_CONTACTS && round == START_LIMITS) {
            start_normal_forces(nrow, nblock);
            next = AT_SMOOTH;
            continue;
        } else if (COULOMB_CONTACTS && round == SET_LIMITS) {
            replace_normal_forces(nblock);
        } else if (COULOMB_CONTACTS && round == MIX_LIMITS) {
            mix_normal_forces(nblock);
        } else if (COULOMB_CONTACTS && round == PREDICT_LIMITS) {
            predict(nblock);
        }
        if (round != PROVE) {
            totals = evaluate(nblock);
            // The gradient there is not needed if the last acceleration is tried next.
            if (round != AT_SMOOTH || !WARMSTART) {
                c.norm = differentiate(nrow);
            }
        }
        if (!NEWTON || round == PROVE) {
            c.gap = precondition();
        }
        switch round {
            case DESCEND: {
                next = after_step(&c, step, totals, nrow);
            }
            case PROVE: {
                next = after_proof(&c, nblock);
            }
            case SET_LIMITS: {
                next = after_limits(&c, nrow);
            }
            case PREDICT_LIMITS: {
                c.same_hessian = true;
                next = DESCEND;
            }
            default: {
                next = after_placing(&c, round, totals, nblock);
            }
        }
    }
    return c;
}

// Returns the force of the metric's couplings along a dof, which is no constraint's. Their blocks are the last.
fn pull_of_couplings(i: u32, nblock: u32) -> f32 {
    var sum: f32 = 0.0;
    for (var b = nblock; IN_METRIC && b > 0u && block(b - 1u, BLOCK_KIND) == METRIC_TERM; b--) {
        let a = block(b - 1u, BLOCK_ROW);
        sum += row(JACOBIAN + a * NV + i) * row(FORCE + a);
    }
    return sum;
}

@compute @workgroup_size(GROUP)
fn solve(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) index: u32) {
    lane = index;
    if (!begin_together(workgroup)) {
        return;
    }
    let nrow = reports[NROW * envs + env];
    let nblock = reports[NBLOCK * envs + env];
    let inertia = copy_mass();
    if (SLEEP && NEWTON) {
        find_awake_tiles();
    }
    let c = minimise(nrow, nblock, inertia);
    if (NOSLIP) {
        noslip(nrow, nblock, 1.0 / inertia);
    }
    for (var i = lane; i < bound(NV); i += GROUP) {
        put(QACC + i, vector(QACC_AT + i));
        if (SLEEP && !is_dof_awake(i)) {
            put(QACC + i, 0.0);
        }
        put(QFRC_CONSTRAINT + i, vector(CONSTRAINT_AT + i) - pull_of_couplings(i, nblock));
        put(GRADIENT + i, select(vector(GRADIENT_AT + i), 0.0, c.status == SOLVE_UNCONSTRAINED));
    }
    if (lane == 0u) {
        reports[NITER * envs + env] = c.iterations;
        reports[LS_EVALUATIONS * envs + env] = c.evaluations;
        reports[SOLVE_STATUS * envs + env] = c.status;
    }
    check_loops();
}
