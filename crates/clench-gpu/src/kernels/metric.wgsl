// The metric of the integrator `discrete`, M̂ = M + h B + h² K, the forces −h K v, and the acceleration of all forces
// except constraints. CPU counterparts: `dynamics/metric.rs`, which derives them, and `apply_metric` and
// `couple_smooth` in `dynamics/discrete.rs`.

// The rounds of the smooth solve: the first is exact up to rounding, the others refine it if couplings are stiff.
const SMOOTH_ROUNDS: u32 = 3u;

fn begin_metric() {
    copy_mass_to_factor();
    for (var p = member; p < bound(NNZ); p += TEAM) {
        put(PLAIN_MASS + p, fetch(QM + p));
    }
    for (var i = member; i < bound(NV); i += TEAM) {
        put(SHIFT + i, 0.0);
        put(ADDED + i, 0.0);
        put(TOUCHED + i, 0.0);
    }
    join();
}

// Adds a spring, with minus the derivative `slope` of its force, to `count` dofs.
fn stiffen(slope: f32, dof: u32, count: u32) {
    let scale = TIMESTEP * max(slope, 0.0);
    for (var i = dof; i < dof + count; i++) {
        add(SHIFT + i, -scale * fetch_state(QVEL + i));
        add(QLD + pivot_of(i), TIMESTEP * scale);
    }
}

fn add_joint_springs() {
    for (var s = member; s < NSPRING; s += TEAM) {
        let j = words[SPRING_JNT + s];
        let law = parameter3(SPRING_LAW + 3u * s);
        let kind = words[JNT_KIND + j];
        var q = words[JNT_QPOS + j];
        var dof = words[JNT_DOF + j];
        if (kind == SLIDE || kind == HINGE) {
            stiffen(stiffness_slope(law, joint_displacement(j, q)), dof, 1u);
            continue;
        }
        if (kind == FREE) {
            stiffen(stiffness_slope(law, length(joint_shift(j, q))), dof, 3u);
            q += 3u;
            dof += 3u;
        }
        stiffen(stiffness_slope(law, length(joint_rotation(j, q))), dof, 3u);
    }
    join();
}

fn add_dof_dampers() {
    for (var i = member; i < bound(NV); i += TEAM) {
        let slope = damping_slope(DOF_DAMPER + 3u * i, fetch_state(QVEL + i));
        add(QLD + pivot_of(i), TIMESTEP * max(slope, 0.0));
    }
    join();
}

// Stores a term s JᵀJ and its share of −h K v, from the negated derivatives of the force, at the velocity `rate`.
fn put_term(along: u32, by_length: f32, by_velocity: f32, rate: f32) {
    let stiffness = TIMESTEP * max(by_length, 0.0);
    put(ALONG_SCALE + along, TIMESTEP * stiffness + TIMESTEP * max(by_velocity, 0.0));
    put(ALONG_SHIFT + along, -stiffness * rate);
}

// Computes the terms of tendons and actuators. A spring has none within its dead band.
fn compute_terms() {
    for (var t = member; t < NTENDON; t += TEAM) {
        let stretch = tendon_stretch(t);
        let velocity = fetch(TEN_VELOCITY + t);
        let slope = stiffness_slope(parameter3(TENDON_SPRING + 5u * t + 2u), stretch);
        put_term(t, select(slope, 0.0, stretch == 0.0), damping_slope(TENDON_DAMPER + 3u * t, velocity), velocity);
    }
    for (var u = member; u < NU; u += TEAM) {
        var by_length: f32 = 0.0;
        var by_velocity: f32 = 0.0;
        if (ACTUATION) {
            by_length = -length_slope(u);
            by_velocity = -velocity_slope(u);
        }
        for (var o = output_of(u); o < output_of(u + 1u); o++) {
            put_term(NTENDON + o, by_length, by_velocity, fetch(ACTUATOR_VELOCITY + o));
        }
    }
    join();
}

// Adds a term to the matrix, or its diagonal to that of the couplings, which the solver receives as rows.
fn add_term(along: u32) {
    let scale = fetch(ALONG_SCALE + along);
    if (scale == 0.0) {
        return;
    }
    let arms = arms_along(along);
    let is_coupling = words[ALONG_COUPLING + along] != NONE;
    for (var n = arms.start; n < arms.end; n++) {
        let i = words[arms.dofs + n];
        let arm = fetch(arms.entries + n);
        put(TOUCHED + i, 1.0);
        add(SHIFT + i, fetch(ALONG_SHIFT + along) * arm);
        if (is_coupling) {
            add(ADDED + i, scale * arm * arm);
        }
        if (HAS_BACKBONE) {
            add(BACKBONE + pivot_of(i), scale * arm * arm);
        }
    }
    if (!is_coupling) {
        add_outer(QLD, arms.dofs, arms.entries, arms.start, arms.end, scale);
    }
}

// Computes M̂ without couplings in QM, and factors it, and the backbone, which has only the diagonal of tendon and
// actuator terms. Terms share entries, so one thread adds them.
fn apply_metric() {
    begin_metric();
    add_joint_springs();
    add_dof_dampers();
    compute_terms();
    if (is_first()) {
        add_fluid_derivatives();
    }
    join();
    for (var p = member; HAS_BACKBONE && p < bound(NNZ); p += TEAM) {
        put(BACKBONE + p, fetch(QLD + p));
    }
    join();
    for (var along = 0u; is_first() && along < NTENDON + NOUT; along++) {
        add_term(along);
    }
    join();
    for (var p = member; p < bound(NNZ); p += TEAM) {
        put(QM + p, fetch(QLD + p));
    }
    for (var i = member; i < bound(NV); i += TEAM) {
        add(ADDED + i, fetch(QLD + pivot_of(i)) - fetch(PLAIN_MASS + pivot_of(i)));
    }
    join();
    for (var round = select(1u, 0u, HAS_BACKBONE); round < bound(2u); round++) {
        if (HAS_BACKBONE) {
            exchange_backbone();
        }
        if (!factor_tree()) {
            fail(SINGULAR);
        }
    }
}

// Computes M̂⁻¹Jᵀ of all couplings, with rows √s jᵀ, and the factor of I + J M̂⁻¹Jᵀ.
fn factor_couplings() {
    for (var k = 0u; k < NCOUPLING; k++) {
        let response = COUPLING_RESPONSE + k * NV;
        for (var i = member; i < bound(NV); i += TEAM) {
            put(response + i, 0.0);
        }
        join();
        let arms = arms_along(words[COUPLING_ALONG + k]);
        for (var n = arms.start + member; n < arms.end; n += TEAM) {
            put(response + words[arms.dofs + n], sqrt(coupling_scale(k)) * fetch(arms.entries + n));
        }
        solve_tree(response);
    }
    for (var n = member; n < NCOUPLING * NCOUPLING; n += TEAM) {
        let i = n / NCOUPLING;
        let product = sqrt(coupling_scale(i)) * coupling_times(i, COUPLING_RESPONSE + n % NCOUPLING * NV);
        put(COUPLING_GRAM + n, product + select(f32(0.0), f32(1.0), i == n % NCOUPLING));
    }
    join();
    if (is_first()) {
        factor_gram();
    }
    join();
}

// Replaces the lower triangle of COUPLING_GRAM by its Cholesky factor.
fn factor_gram() {
    for (var j = 0u; j < NCOUPLING; j++) {
        for (var i = j; i < NCOUPLING; i++) {
            var rest = fetch(COUPLING_GRAM + i * NCOUPLING + j);
            for (var k = 0u; k < j; k++) {
                rest -= fetch(COUPLING_GRAM + i * NCOUPLING + k) * fetch(COUPLING_GRAM + j * NCOUPLING + k);
            }
            let pivot = fetch(COUPLING_GRAM + j * NCOUPLING + j);
            put(COUPLING_GRAM + i * NCOUPLING + j, select(rest / pivot, sqrt(rest), i == j));
        }
    }
}

// Computes τ − h K v in RATE; if the solve `refines` the acceleration so far, minus the product of the metric with it.
fn remaining_forces(refines: bool) {
    for (var k = member; refines && k < NCOUPLING; k += TEAM) {
        put(COUPLING_PULL + k, coupling_scale(k) * coupling_times(k, QACC_SMOOTH));
    }
    for (var i = member; i < bound(NV); i += TEAM) {
        var rest = fetch(QFRC_SMOOTH + i) + fetch(SHIFT + i);
        for (var p = words[TREE_START + i]; refines && p < words[TREE_START + i + 1u]; p++) {
            rest -= fetch(QM + p) * fetch(QACC_SMOOTH + words[TREE_DOF + p]);
        }
        for (var p = words[BELOW_START + i]; refines && p < words[BELOW_START + i + 1u]; p++) {
            rest -= fetch(QM + words[BELOW_PLACE + p]) * fetch(QACC_SMOOTH + words[BELOW_DOF + p]);
        }
        put(RATE + i, rest);
    }
    join();
    for (var k = 0u; refines && is_first() && k < NCOUPLING; k++) {
        let arms = arms_along(words[COUPLING_ALONG + k]);
        for (var n = arms.start; n < arms.end; n++) {
            add(RATE + words[arms.dofs + n], -fetch(COUPLING_PULL + k) * fetch(arms.entries + n));
        }
    }
}

// Computes the acceleration without constraints, couplings included.
fn accelerate_in_metric() {
    for (var i = member; i < bound(NV); i += TEAM) {
        put(QACC_SMOOTH + i, 0.0);
    }
    if (NCOUPLING > 0u) {
        factor_couplings();
    }
    join();
    let rounds = select(1u, SMOOTH_ROUNDS, NCOUPLING > 0u);
    for (var round = 0u; round < rounds; round++) {
        remaining_forces(round > 0u);
        solve_tree(RATE);
        if (NCOUPLING > 0u) {
            solve_couplings(RATE);
        }
        for (var i = member; i < bound(NV); i += TEAM) {
            add(QACC_SMOOTH + i, fetch(RATE + i));
        }
        join();
    }
}

// One team per environment.
@compute @workgroup_size(GROUP, TEAM)
fn metric(@builtin(global_invocation_id) id: vec3u) {
    begin_in_team(id);
    apply_metric();
    accelerate_in_metric();
    end_in_team();
}
