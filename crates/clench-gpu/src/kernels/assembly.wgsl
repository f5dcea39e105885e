// Jacobians of all rows, their velocities, and from these aref, R and D. One workgroup per environment. CPU
// counterpart: `constraint/assembly.rs`.

// The minimum of R relative to the inverse inertia: 4.5 ε of single precision, as on the processor.
const MIN_REGULARIZATION: f32 = 4.5 * EPSILON;

// The axes of dofs are in workgroup memory if there are no more than this. Adjacent numbers there belong to the same
// environment.
const NEAR_AXES: u32 = 96u;
var<workgroup> near_axes: array<f32, 6u * NEAR_AXES>;

fn fetch_axes() {
    for (var k = lane; NV <= NEAR_AXES && k < bound(6u * NV); k += GROUP) {
        near_axes[k] = fetch(CDOF + k);
    }
    workgroupBarrier();
}

fn axis_of(i: u32) -> Spatial {
    if (NV > NEAR_AXES) {
        return fetch_spatial(CDOF + 6u * i);
    }
    let k = 6u * i;
    return Spatial(
        vec3f(near_axes[k], near_axes[k + 1u], near_axes[k + 2u]),
        vec3f(near_axes[k + 3u], near_axes[k + 4u], near_axes[k + 5u]),
    );
}

// Returns an entry of row `k` of a connect or weld: the points' separation, then the frames' rotation.
fn frames_entry(equality: u32, k: u32, i: u32) -> f32 {
    let first = anchor_body(equality, 0u);
    let second = anchor_body(equality, 1u);
    var motion = Spatial(vec3f(), vec3f());
    if (moves(first, i)) {
        motion = motion_at(first, i, anchor_point(equality, 0u));
    }
    if (moves(second, i)) {
        motion = plus(motion, times(motion_at(second, i, anchor_point(equality, 1u)), -1.0));
    }
    if (k < 3u) {
        return motion.linear[k];
    }
    if (moves(first, i) && moves(second, i)) {
        return 0.0;
    }
    let u = quat_rotate(to_second_frame(equality), motion.angular);
    return (half_product(u, relative_quat(equality)) * torquescale(equality))[k - 3u];
}

// Returns the follower's derivative minus the slope, stored as the row's shape, times that of its leader.
fn coupling_entry(equality: u32, a: u32, i: u32) -> f32 {
    var sum = coordinate_entry(words[EQ_PAIR + 2u * equality], i);
    let leader = words[EQ_PAIR + 2u * equality + 1u];
    if (leader != NONE) {
        sum -= row(SHAPE + a) * coordinate_entry(leader, i);
    }
    return sum;
}

// Returns an entry of row `k` of a contact: along, then about the normal and the tangents; second body relative to
// first.
fn contact_entry(contact: u32, k: u32, i: u32) -> f32 {
    let offset = CONTACTS + CONTACT_SIZE * contact;
    let pair = u32(fetch(offset));
    let first = words[PAIR_BODY + 2u * pair];
    let second = words[PAIR_BODY + 2u * pair + 1u];
    let by_first = moves(first, i);
    let by_second = moves(second, i);
    if (by_first == by_second) {
        return 0.0;
    }
    let axis = fetch3(offset + 5u + 3u * (k % 3u));
    let motion = axis_of(i);
    let linear = motion.linear + cross(motion.angular, offset_of(select(first, second, by_second), fetch3(offset + 2u)));
    let along = dot(axis, select(motion.angular, linear, k < 3u));
    return select(-along, along, by_second);
}

fn friction_entry(source: u32, i: u32) -> f32 {
    if (source < NV) {
        return select(f32(0.0), f32(1.0), i == source);
    }
    return coordinate_entry(NJNT + source - NV, i);
}

fn limit_entry(source: u32, i: u32) -> f32 {
    let c = source >> 1u;
    if (!is_ball(c)) {
        let sign = select(f32(1.0), f32(-1.0), (source & 1u) == 1u);
        return sign * coordinate_entry(c, i);
    }
    let dof = words[JNT_DOF + c];
    if (i < dof || i >= dof + 3u) {
        return 0.0;
    }
    let rotation = quat_normalize(fetch_state4(QPOS + words[JNT_QPOS + c]));
    return -direction(quat_rotation_vector(rotation))[i - dof];
}

fn entry(a: u32, i: u32) -> f32 {
    let b = u32(row(ROW_BLOCK + a));
    let source = block(b, BLOCK_SOURCE);
    switch block(b, BLOCK_KIND) {
        case FRAMES: {
            return frames_entry(source, a - block(b, BLOCK_ROW), i);
        }
        case COUPLING: {
            return coupling_entry(source, a, i);
        }
        case DRY_FRICTION: {
            return friction_entry(source, i);
        }
        case LIMIT: {
            return limit_entry(source, i);
        }
        case METRIC_TERM: {
            return arm_along(source, i);
        }
        case CONTACT_NORMAL, CONTACT_PYRAMID, CONTACT_ELLIPTIC, default: {
            return contact_entry(source, a - block(b, BLOCK_ROW), i);
        }
    }
}

// Computes the reference acceleration of a term of the metric: J a_s.
fn finish_term(a: u32) {
    var aref: f32 = 0.0;
    for (var i = 0u; i < bound(NV); i++) {
        aref += row(COLUMNS + i * MAX_ROWS + a) * fetch(QACC_SMOOTH + i);
    }
    put_row(AREF + a, aref);
    put_row(RAY + a, 0.0);
}

// Computes the velocity along a row, and its inverse inertia as if dofs were independent.
fn finish_row(a: u32) {
    if (IN_METRIC && block(u32(row(ROW_BLOCK + a)), BLOCK_KIND) == METRIC_TERM) {
        finish_term(a);
        return;
    }
    var velocity = row(VELOCITY + a);
    var inertia: f32 = 0.0;
    for (var i = 0u; i < bound(NV); i++) {
        let j = row(COLUMNS + i * MAX_ROWS + a);
        velocity += j * fetch_state(QVEL + i);
        inertia += j * j * parameter(DOF_INVWEIGHT0 + i);
    }
    put_row(VELOCITY + a, velocity);
    if (IN_METRIC) {
        put_row(AREF + a, reference_at_end(a, velocity));
    } else {
        put_row(AREF + a, row(AREF + a) - row(DAMPING + a) * velocity);
    }
    put_row(RESIDUAL + a, inertia);
    // A step of length 0 along any finite ray is zero.
    put_row(RAY + a, 0.0);
}

// Raises R to the rounding level, for the rows of a cone together. RESIDUAL holds the inverse inertia of each row.
fn finish_cone(first: u32, dim: u32, is_pyramid: bool) {
    let normal = row(RESIDUAL + first);
    var factor: f32 = 1.0;
    for (var a = first; a < first + dim; a++) {
        var inertia = row(RESIDUAL + a);
        if (is_pyramid) {
            let mu = row(SHAPE + a);
            inertia = normal + mu * mu * inertia;
        }
        factor = max(factor, MIN_REGULARIZATION * inertia / row(R + a));
    }
    for (var a = first; a < first + dim; a++) {
        finish_stiffness(a, row(R + a) * factor);
    }
}

fn finish_stiffness(a: u32, r: f32) {
    put_row(R + a, r);
    put_row(D + a, 1.0 / r);
    if (ANY_ADHESION) {
        put_row(AREF + a, row(AREF + a) + r * row(PULL + a));
    }
}

fn finish_block(b: u32) {
    let kind = block(b, BLOCK_KIND);
    let first = block(b, BLOCK_ROW);
    let dim = block(b, BLOCK_DIM);
    if (IN_METRIC && kind == METRIC_TERM) {
        // D is s already.
        return;
    }
    if (EXACT_DIAGONAL) {
        regularize_exactly(kind, first, dim);
    }
    if (IN_METRIC) {
        regularize_at_end(kind, first, dim);
    }
    if (kind == CONTACT_PYRAMID || kind == CONTACT_ELLIPTIC) {
        finish_cone(first, dim, kind == CONTACT_PYRAMID);
        return;
    }
    for (var a = first; a < first + dim; a++) {
        finish_stiffness(a, max(row(R + a), MIN_REGULARIZATION * row(RESIDUAL + a)));
    }
    // A single row that nothing can affect is no constraint, except in contacts.
    if (dim == 1u && kind != CONTACT_NORMAL && row(RESIDUAL + first) == 0.0) {
        put_row(D + first, 0.0);
        put_row(SHAPE + first, 0.0);
    }
}

@compute @workgroup_size(GROUP)
fn assemble(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) index: u32) {
    lane = index;
    if (!begin_together(workgroup)) {
        return;
    }
    let nrow = reports[NROW * envs + env];
    let nblock = reports[NBLOCK * envs + env];
    fetch_axes();
    // Eight rows and eight dofs at a time: in both arrays adjacent numbers are written together.
    for (var first_row = 0u; first_row < nrow; first_row += 8u) {
        let a = first_row + lane / 8u;
        for (var i = lane % 8u; a < nrow && i < bound(NV); i += 8u) {
            let j = entry(a, i);
            put_row(JACOBIAN + a * NV + i, j);
            put_row(COLUMNS + i * MAX_ROWS + a, j);
        }
    }
    join();
    for (var a = lane; a < nrow; a += GROUP) {
        finish_row(a);
    }
    join();
    for (var b = lane; b < nblock; b += GROUP) {
        finish_block(b);
    }
    check_loops();
}
