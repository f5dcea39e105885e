// Blocks of rows of all active constraints: equalities, dry friction, limits, contacts, in this order. CPU
// counterparts: `constraint/friction.rs`, `limit.rs` and `contact.rs`. Jacobians and velocities are added by
// `assembly.wgsl`.
//
// A thread first counts the blocks and rows of its constraint, and writes them once it knows the counts before it.

var<private> nblock: u32;
var<private> nrow: u32;
var<private> writes: bool;
// The impedance of the current block.
var<private> block_impedance: f32;

// Begins a block of a kind, with a cost; its Jacobian is computed from the source.
fn begin_block(kind: u32, cost: u32, dim: u32, source: u32, impedance: f32) {
    block_impedance = impedance;
    let offset = BLOCKS + BLOCK_SIZE * nblock;
    if (writes) {
        put_row(offset + BLOCK_KIND, f32(kind));
        put_row(offset + BLOCK_COST, f32(cost));
        put_row(offset + BLOCK_DIM, f32(dim));
        put_row(offset + BLOCK_ROW, f32(nrow));
        put_row(offset + BLOCK_SOURCE, f32(source));
    }
    nblock++;
}

// Adds a row to the block. The velocity part of aref, −damping · velocity, is added later. Until then VELOCITY holds
// the part of the velocity other than J v, PULL the force that raises aref by R times itself, and D the impedance.
fn add_row(position: f32, aref: f32, stiffness: f32, damping: f32, r: f32, shape: f32) {
    if (writes) {
        put_row(ROW_BLOCK + nrow, f32(nblock - 1u));
        put_row(POSITION + nrow, position);
        put_row(AREF + nrow, aref);
        put_row(DAMPING + nrow, damping);
        put_row(R + nrow, r);
        put_row(SHAPE + nrow, shape);
        put_row(VELOCITY + nrow, 0.0);
        put_row(D + nrow, block_impedance);
    }
    if (writes && (IN_METRIC || STICTION)) {
        put_row(STIFFNESS + nrow, stiffness);
    }
    if (writes && ANY_ADHESION) {
        put_row(PULL + nrow, 0.0);
    }
    nrow++;
}

fn push_friction(k: u32) {
    let source = words[FRICTION_SOURCE + k];
    if (SLEEP && !is_friction_awake(source)) {
        return;
    }
    let prm = FRICTION_PRM + FRICTION_SIZE * k;
    let soft = soften(prm + FRICTION_SOLREF, 0.0);
    begin_block(DRY_FRICTION, COST_HUBER, 1u, source, soft.impedance);
    let r = regularization(soft.impedance, parameter(prm + FRICTION_INVWEIGHT));
    add_row(0.0, 0.0, select(0.0, soft.stiffness, STICTION), soft.damping, r, parameter(prm + FRICTION_LOSS));
    if (writes && STICTION) {
        displace(nrow - 1u, fetch_state(STICK_FRICTION + source), soft.stiffness);
    }
}

// Adds one end of a coordinate's range. `source` is twice the coordinate, plus one at the upper end.
fn push_limit(prm: u32, distance: f32, source: u32) {
    let margin = parameter(prm + LIMIT_MARGIN);
    if (distance >= margin) {
        return;
    }
    let soft = resolved(soften(prm + LIMIT_SOLREF, distance - margin), prm + LIMIT_SOLREF);
    begin_block(LIMIT, COST_ONE_SIDED, 1u, source, soft.impedance);
    let aref = -soft.stiffness * (distance - margin);
    let r = regularization(soft.impedance, parameter(prm + LIMIT_INVWEIGHT));
    add_row(distance, aref, soft.stiffness, soft.damping, r, 0.0);
}

// Adds both ends.
fn push_limits(k: u32) {
    let c = words[LIMIT_COORDINATE + k];
    if (SLEEP && !is_coordinate_awake(c)) {
        return;
    }
    let prm = LIMIT_PRM + LIMIT_SIZE * k;
    let low = parameter(prm + LIMIT_LOW);
    let high = parameter(prm + LIMIT_HIGH);
    if (is_ball(c)) {
        let rotation = quat_normalize(fetch_state4(QPOS + words[JNT_QPOS + c]));
        let angle = length(quat_rotation_vector(rotation));
        push_limit(prm, max(low, high) - angle, 2u * c);
        return;
    }
    let value = coordinate_value(c);
    push_limit(prm, value - low, 2u * c);
    push_limit(prm, high - value, 2u * c + 1u);
}

// Adds the friction rows of a contact, after the normal's, with the stiffness and the damping of their springs.
fn push_tangents(contact: u32, dim: u32, friction: u32, normal_r: f32, spring: vec2f) {
    let mu1 = parameter(friction);
    var drift = vec3f();
    if (writes && SURFACES_MOVE) {
        drift = surface_velocity(contact);
    }
    var displacements = array<f32, 5>();
    if (writes && STICTION) {
        displacements = displacements_of(contact);
    }
    for (var k = 1u; k < dim; k++) {
        let mu = parameter(friction + k - 1u);
        var r = normal_r;
        if (ELLIPTIC_CONES || COULOMB_CONTACTS) {
            r = normal_r / IMPRATIO * mu1 * mu1 / (mu * mu);
        }
        add_row(0.0, 0.0, spring.x, spring.y, r, mu);
        if (writes && SURFACES_MOVE && k < 4u) {
            put_row(VELOCITY + nrow - 1u, drift[k - 1u]);
        }
        if (writes && STICTION) {
            displace(nrow - 1u, displacements[k - 1u], spring.x);
        }
    }
}

// Adds the row along the normal, which pulls if the contact has adhesion.
fn push_normal(distance: f32, aref: f32, soft: Softness, r: f32, shape: f32, pull: f32) {
    add_row(distance, aref, soft.stiffness, soft.damping, r, shape);
    if (writes && ANY_ADHESION) {
        put_row(PULL + nrow - 1u, pull);
    }
}

// Adds a contact. One with adhesion has no friction within the gap.
fn push_contact(contact: u32) {
    let offset = CONTACTS + CONTACT_SIZE * contact;
    let pair = u32(fetch(offset));
    let prm = PAIR_PRM + PAIR_SIZE * pair;
    let distance = fetch(offset + 1u);
    let margin = parameter(prm + PAIR_MARGIN);
    let adhesion = contact_adhesion(contact);
    let touches = distance < margin;
    if (!(touches || adhesion != 0.0) || move_together(words[PAIR_BODY + 2u * pair], words[PAIR_BODY + 2u * pair + 1u])) {
        return;
    }
    let a0 = parameter(prm + PAIR_INVWEIGHT);
    let friction = prm + PAIR_FRICTION;
    let unresolved = soften(prm + PAIR_SOLREF, distance - margin);
    let soft = resolved(unresolved, prm + PAIR_SOLREF);
    let aref = -soft.stiffness * (distance - margin);
    let dim = select(1u, words[PAIR_DIM + pair], touches);
    let plain = regularization(soft.impedance, a0);
    if (dim == 1u) {
        begin_block(CONTACT_NORMAL, COST_ONE_SIDED, 1u, contact, soft.impedance);
        push_normal(distance, aref, soft, plain, 0.0, adhesion);
        return;
    }
    let mu = parameter(friction);
    if (ELLIPTIC_CONES || COULOMB_CONTACTS) {
        begin_block(CONTACT_ELLIPTIC, select(COST_ELLIPTIC, COST_COULOMB, COULOMB_CONTACTS), dim, contact, soft.impedance);
        push_normal(distance, aref, soft, plain, mu * sqrt(1.0 / IMPRATIO), adhesion);
        var spring = vec2f(unresolved.stiffness, unresolved.damping);
        if (STICTION) {
            spring = vec2f(soft.stiffness, soft.damping);
        }
        let solref = vec2f(parameter(prm + PAIR_SOLREFFRICTION), parameter(prm + PAIR_SOLREFFRICTION + 1u));
        if (any(solref != vec2f()) && !is_mixed(solref)) {
            spring = spring_damper(solref, parameter(prm + PAIR_SOLIMP + 1u)) * vec2f(soft.impedance, 1.0);
        }
        // Friction of a cone has no spring unless it sticks.
        spring.x = select(0.0, spring.x, STICTION);
        push_tangents(contact, dim, friction, plain, spring);
        return;
    }
    let edge = regularization(soft.impedance, a0 + mu * mu * a0);
    let r = 2.0 * (mu * mu / IMPRATIO) * edge;
    begin_block(CONTACT_PYRAMID, COST_PYRAMID, dim, contact, soft.impedance);
    // The edges share the adhesion.
    push_normal(distance, aref, soft, r, 0.0, adhesion / (2.0 * (f32(dim) - 1.0)));
    push_tangents(contact, dim, friction, r, vec2f(soft.stiffness, soft.damping));
}

// Returns true if a coupling acts on an awake dof. It acts on one tree, or only on trees that never sleep.
fn is_coupling_awake(k: u32) -> bool {
    let arms = arms_along(words[COUPLING_ALONG + k]);
    return arms.start < arms.end && is_dof_awake(words[arms.dofs + arms.start]);
}

// Adds the couplings of the metric, ½ s (J a − J a_s)², as the last blocks. Those of sleeping trees have no force.
fn push_couplings() {
    for (var k = 0u; k < NCOUPLING; k++) {
        if (SLEEP && !is_coupling_awake(k)) {
            continue;
        }
        let scale = fetch(ALONG_SCALE + words[COUPLING_ALONG + k]);
        if (scale > 0.0) {
            begin_block(METRIC_TERM, COST_QUADRATIC, 1u, words[COUPLING_ALONG + k], scale);
            add_row(0.0, 0.0, 0.0, 0.0, 1.0 / scale, 0.0);
        }
    }
}

// Adds the n-th constraint, if it is active.
fn push(n: u32) {
    var k = n;
    if (k < NEQ) {
        push_equality(k);
        return;
    }
    k -= NEQ;
    if (k < NFRICTION) {
        push_friction(k);
        return;
    }
    k -= NFRICTION;
    if (k < NLIMIT) {
        push_limits(k);
        return;
    }
    push_contact(k - NLIMIT);
}

// One workgroup per environment, one thread per constraint.
@compute @workgroup_size(GROUP)
fn constraints(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) index: u32) {
    lane = index;
    if (!begin_together(workgroup)) {
        return;
    }
    let all = NEQ + NFRICTION + NLIMIT + reports[NCON * envs + env];
    // Blocks and rows of the threads in earlier iterations.
    var earlier = vec2u();
    for (var start = 0u; start < all; start += GROUP) {
        var first = vec2u();
        for (var round = 0u; round < bound(2u); round++) {
            writes = round == 1u;
            nblock = first.x;
            nrow = first.y;
            if (start + lane < all) {
                push(start + lane);
            }
            if (round == 0u) {
                let sums = sums_up_to(vec4f(f32(nblock), f32(nrow), 0.0, 0.0));
                first = earlier + vec2u(sums.before.xy);
                earlier += vec2u(sums.all.xy);
            }
        }
    }
    if (lane == 0u) {
        nblock = earlier.x;
        nrow = earlier.y;
        if (IN_METRIC && nblock > 0u) {
            push_couplings();
        }
        reports[NBLOCK * envs + env] = nblock;
        reports[NROW * envs + env] = nrow;
    }
    check_loops();
}
