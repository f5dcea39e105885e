// Newton's method: one workgroup an environment. Sister of `clench-solver/src/descent.rs` and `newton.rs`.

// What a round of a solve does before it evaluates. Drivers put the text of a function wherever it is called: hence one loop, in
// which each of the large ones is called at one place.
const AT_SMOOTH: u32 = 0u;
const AT_WARMSTART: u32 = 1u;
const BACK_AT_SMOOTH: u32 = 2u;
const DESCEND: u32 = 3u;
const REFRESH: u32 = 4u;
const DONE: u32 = 5u;

// Where a solve stands.
struct Convergence {
    // The cost at the unconstrained acceleration.
    cold: f32,
    // No piece changed since the last factorization, none is curved: the factor holds.
    same_hessian: bool,
    curved: bool,
    refreshed: bool,
    // The smallest gradient norm so far, and iterations since it fell noticeably.
    best: f32,
    idle: u32,
    iterations: u32,
    status: u32,
}

// Lets a branch that contains barriers be taken by all threads or none. All come with the same answer.
fn agreed(answer: u32) -> u32 {
    if (lane == 0u) {
        verdict = answer;
    }
    return workgroupUniformLoad(&verdict);
}

// Puts the iterate where a round begins: at the unconstrained acceleration, at that of the last step, or where it is.
fn place(round: u32) {
    for (var i = lane; i < bound(NV); i += GROUP) {
        if (round == AT_WARMSTART) {
            put_vector(QACC_AT + i, given(QACC_WARMSTART + i));
        } else if (round != REFRESH) {
            put_vector(QACC_AT + i, fetch(QACC_SMOOTH + i));
        }
    }
    join();
}

fn find_direction() {
    for (var i = lane; i < bound(WIDTH); i += GROUP) {
        put_vector(RAY_AT + i, select(0.0, -vector(GRADIENT_AT + i), i < NV));
    }
    join();
    solve_hessian(RAY_AT, MASS_RAY_AT);
}

// What comes after a round that did not descend.
fn after_start(c: ptr<function, Convergence>, round: u32, totals: vec4f, norm: f32, nblock: u32) -> u32 {
    (*c).curved = totals.z > 0.0;
    (*c).same_hessian = false;
    if (round == AT_SMOOTH && nblock == 0u) {
        (*c).status = SOLVE_UNCONSTRAINED;
        return DONE;
    }
    if (round == AT_SMOOTH && WARMSTART) {
        (*c).cold = totals.x + totals.w;
        return AT_WARMSTART;
    }
    // The last acceleration is a good start where it costs less than the unconstrained one.
    if (round == AT_WARMSTART && !(totals.x + totals.w < (*c).cold)) {
        return BACK_AT_SMOOTH;
    }
    if (round == REFRESH) {
        (*c).best = norm;
        (*c).idle = 0u;
        (*c).refreshed = true;
    }
    return DESCEND;
}

// What comes after a step. One that seems stuck gets a second chance, without the rounding that steps have added up.
fn after_step(c: ptr<function, Convergence>, step: Step, totals: vec4f, norm: f32, scale: f32) -> u32 {
    let curved = totals.z > 0.0;
    let exact = totals.y == 0.0 && !curved && !(*c).curved;
    (*c).same_hessian = exact;
    (*c).curved = curved;
    (*c).iterations++;
    if (is_wild(norm)) {
        (*c).status = SOLVE_NON_FINITE;
        return DONE;
    }
    if (scale * norm <= TOLERANCE && (scale * step.improvement <= TOLERANCE || exact)) {
        (*c).status = SOLVE_CONVERGED;
        return DONE;
    }
    let negligible = step.improvement <= 4.0 * EPSILON * (totals.x + totals.w) || exact;
    let fell = norm < 0.7 * (*c).best;
    if (fell) {
        (*c).best = norm;
    }
    (*c).idle = select((*c).idle + 1u, 0u, fell || !negligible);
    let stuck = step.alpha == 0.0 || (*c).idle >= 2u;
    if (stuck && (*c).refreshed) {
        (*c).status = select(SOLVE_NO_PROGRESS, SOLVE_ITERATION_LIMIT, step.cut && step.alpha == 0.0);
        return DONE;
    }
    if ((*c).iterations >= ITERATIONS) {
        return DONE;
    }
    return select(DESCEND, REFRESH, stuck);
}

fn minimise(nrow: u32, nblock: u32, inertia: f32) -> Convergence {
    var c = Convergence(0.0, false, false, false, UNBOUNDED, 0u, 0u, SOLVE_ITERATION_LIMIT);
    var next = AT_SMOOTH;
    loop {
        let round = agreed(next);
        if (round == DONE) {
            break;
        }
        var step = Step(0.0, 0.0, false);
        if (round == DESCEND) {
            let rebuild = agreed(select(1u, 0u, c.same_hessian));
            if (rebuild == 1u) {
                factor_hessian(weigh_rows(nblock));
            }
            find_direction();
            prepare_ray(nrow);
            step = search(nblock, TOLERANCE * LS_TOLERANCE * inertia);
            advance_iterate(step.alpha, nrow);
        } else {
            place(round);
            refresh(nrow);
        }
        let totals = evaluate(nblock);
        let norm = differentiate(nrow);
        if (round == DESCEND) {
            next = after_step(&c, step, totals, norm, 1.0 / inertia);
        } else {
            next = after_start(&c, round, totals, norm, nblock);
        }
    }
    return c;
}

@compute @workgroup_size(GROUP)
fn solve(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) index: u32) {
    take_up(environment_of(workgroup));
    lane = index;
    if (env >= envs) {
        return;
    }
    let inertia = copy_mass();
    let c = minimise(reports[NROW * envs + env], reports[NBLOCK * envs + env], inertia);
    if (NOSLIP_ITERATIONS > 0u) {
        noslip(reports[NROW * envs + env], reports[NBLOCK * envs + env], 1.0 / inertia);
    }
    for (var i = lane; i < bound(NV); i += GROUP) {
        put(QACC + i, vector(QACC_AT + i));
        put(QFRC_CONSTRAINT + i, vector(CONSTRAINT_AT + i));
    }
    if (lane == 0u) {
        reports[NITER * envs + env] = c.iterations;
        reports[SOLVE_STATUS * envs + env] = c.status;
    }
    note_end();
}
