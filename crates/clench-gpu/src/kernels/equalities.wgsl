// Equalities as blocks: connects, welds, and couplings of joints or tendons. CPU counterparts: `constraint/connect.rs`,
// `weld.rs` and `joint_equality.rs`; of slots, `constraint/dynamic.rs`.

fn push_coupling(equality: u32, prm: u32) {
    let follower = words[EQ_PAIR + 2u * equality];
    let leader = words[EQ_PAIR + 2u * equality + 1u];
    var value = parameter(prm + COUPLING_POLYCOEF);
    var slope: f32 = 0.0;
    if (leader != NONE) {
        let e = coordinate_value(leader) - parameter(prm + COUPLING_INITIAL + 1u);
        value = parameter(prm + COUPLING_POLYCOEF + 4u);
        for (var k = 4u; k > 0u; k--) {
            slope = slope * e + value;
            value = value * e + parameter(prm + COUPLING_POLYCOEF + k - 1u);
        }
    }
    let violation = coordinate_value(follower) - parameter(prm + COUPLING_INITIAL) - value;
    let soft = soften(prm + COUPLING_SOLREF, violation);
    begin_block(COUPLING, COST_QUADRATIC, 1u, equality, soft.impedance);
    // The slope is stored as the cost's shape, which this cost does not use.
    let r = regularization(soft.impedance, parameter(prm + COUPLING_INVWEIGHT));
    add_row(violation, -soft.stiffness * violation, soft.stiffness, soft.damping, r, slope);
}

// Returns J̇ v of the last three rows of a weld, for bias accelerations with the difference `alpha`.
fn weld_bias(equality: u32, alpha: vec3f) -> vec3f {
    let omega1 = fetch3(CVEL + 6u * anchor_body(equality, 0u));
    let omega2 = fetch3(CVEL + 6u * anchor_body(equality, 1u));
    let to_second = to_second_frame(equality);
    let rho = relative_quat(equality);
    let u = quat_rotate(to_second, omega1 - omega2);
    let u_dot = quat_rotate(to_second, alpha - cross(omega2, omega1 - omega2));
    let rho_dot = quat_product(vec4f(0.0, u), rho);
    return (half_product(u_dot, rho) + 0.5 * half_product(u, rho_dot)) * torquescale(equality);
}

// Adds three rows at a violation, with their bias acceleration.
fn add_frame_rows(violation: vec3f, bias: vec3f, soft: Softness, a0: f32) {
    for (var k = 0u; k < 3u; k++) {
        let aref = -soft.stiffness * violation[k] - bias[k];
        add_row(violation[k], aref, soft.stiffness, soft.damping, regularization(soft.impedance, a0), 0.0);
    }
}

// Returns the sum of the bodies' inverse weights: of translations (part 0) or rotations (part 1).
fn frames_invweight(equality: u32, part: u32) -> f32 {
    if (!is_in_slot(equality)) {
        return parameter(words[EQ_PRM + equality] + FRAMES_INVWEIGHT + part);
    }
    let first = parameter(BODY_INVWEIGHT0 + 2u * anchor_body(equality, 0u) + part);
    return first + parameter(BODY_INVWEIGHT0 + 2u * anchor_body(equality, 1u) + part);
}

fn push_frames(equality: u32, is_weld: bool) {
    let p = anchor_point(equality, 0u);
    let q = anchor_point(equality, 1u);
    let first = bias_acceleration(anchor_body(equality, 0u), p);
    let second = bias_acceleration(anchor_body(equality, 1u), q);
    let apart = p - q;
    var turned = vec3f();
    if (is_weld) {
        turned = relative_quat(equality).yzw * torquescale(equality);
    }
    let soft = soften(equality_parameters(equality) + FRAMES_SOLREF, sqrt(dot(apart, apart) + dot(turned, turned)));
    begin_block(FRAMES, COST_QUADRATIC, select(3u, 6u, is_weld), equality, soft.impedance);
    add_frame_rows(apart, first.linear - second.linear, soft, frames_invweight(equality, 0u));
    if (is_weld) {
        add_frame_rows(turned, weld_bias(equality, first.angular - second.angular), soft, frames_invweight(equality, 1u));
    }
}

// Returns the kind of an equality. It is static if the equality is inactive, or ties static bodies in a slot.
fn active_kind(equality: u32) -> u32 {
    if (is_in_slot(equality)) {
        let kind = kind_in_slot(equality - FIRST_SLOT);
        if (kind != EQ_STATIC && move_together(anchor_body(equality, 0u), 0u) && move_together(anchor_body(equality, 1u), 0u)) {
            return EQ_STATIC;
        }
        return kind;
    }
    return select(words[EQ_KIND + equality], EQ_STATIC, fetch_state(EQ_ACTIVE + equality) == 0.0);
}

// Returns true if an equality couples any awake object.
fn is_equality_awake(equality: u32, kind: u32) -> bool {
    if (kind != EQ_COUPLING) {
        return is_either_awake(anchor_body(equality, 0u), anchor_body(equality, 1u));
    }
    let first = words[EQ_PAIR + 2u * equality];
    let second = words[EQ_PAIR + 2u * equality + 1u];
    return is_coordinate_awake(first) || (second != NONE && is_coordinate_awake(second));
}

fn push_equality(equality: u32) {
    let kind = active_kind(equality);
    if (SLEEP && kind != EQ_STATIC && !is_equality_awake(equality, kind)) {
        return;
    }
    switch kind {
        case EQ_COUPLING: {
            push_coupling(equality, words[EQ_PRM + equality]);
        }
        case EQ_CONNECT, EQ_WELD: {
            push_frames(equality, kind == EQ_WELD);
        }
        case EQ_STATIC, default: {
        }
    }
}
