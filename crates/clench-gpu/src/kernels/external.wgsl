// Forces on bodies from outside their tree of joints: applied ones, contacts, connects, welds and strings. CPU
// counterparts: `output/forces.rs` and `output/tendon_forces.rs` of clench-rigid, which explain the signs.

// Adds a force and a couple on a body at a point.
fn push(body: u32, sign: f32, force: vec3f, couple: vec3f, at: vec3f) {
    if (body == 0u) {
        return;
    }
    let offset = CFRC_EXT + 6u * body;
    let torque = couple + cross(offset_of(body, at), force);
    put_spatial(offset, plus(fetch_spatial(offset), times(Spatial(torque, force), sign)));
}

// Does the same and adds them to the sum of contacts: the force, then the torque at the body's centre of mass.
fn push_by_contact(body: u32, sign: f32, force: vec3f, couple: vec3f, at: vec3f) {
    let offset = CONTACT_FORCE + 6u * body;
    let torque = couple + cross(at - fetch3(XIPOS + 3u * body), force);
    put3(offset, fetch3(offset) + force * sign);
    put3(offset + 3u, fetch3(offset + 3u) + torque * sign);
    push(body, sign, force, couple, at);
}

fn push_contact(source: u32, f: vec3f, t: vec3f) {
    let offset = CONTACTS + CONTACT_SIZE * source;
    let pair = u32(fetch(offset));
    let at = fetch3(offset + 2u);
    let axes = mat3x3f(fetch3(offset + 5u), fetch3(offset + 8u), fetch3(offset + 11u));
    push_by_contact(words[PAIR_BODY + 2u * pair], -1.0, axes * f, axes * t, at);
    push_by_contact(words[PAIR_BODY + 2u * pair + 1u], 1.0, axes * f, axes * t, at);
}

fn push_frames(equality: u32, force: vec3f, rotation: vec3f) {
    // Zero for a connect.
    let rho = relative_quat(equality);
    let turned = (rotation * rho.x + cross(rho.yzw, rotation)) * (0.5 * torquescale(equality));
    let couple = quat_rotate(anchor_quat(equality, 1u), turned);
    push(anchor_body(equality, 0u), 1.0, force, couple, anchor_point(equality, 0u));
    push(anchor_body(equality, 1u), -1.0, force, couple, anchor_point(equality, 1u));
}

// Returns the constraint force along tendon `t`.
fn tendon_constraint_force(t: u32) -> f32 {
    let c = NJNT + t;
    var sum: f32 = 0.0;
    for (var b = 0u; b < reports[NBLOCK * envs + env]; b++) {
        let source = block(b, BLOCK_SOURCE);
        let first = block(b, BLOCK_ROW);
        let force = row(FORCE + first);
        switch block(b, BLOCK_KIND) {
            case DRY_FRICTION: {
                sum += select(0.0, force, source == NV + t);
            }
            case LIMIT: {
                let along = select(force, -force, (source & 1u) == 1u);
                sum += select(0.0, along, (source >> 1u) == c);
            }
            case COUPLING: {
                sum += select(0.0, force, words[EQ_PAIR + 2u * source] == c);
                sum -= select(0.0, row(SHAPE + first) * force, words[EQ_PAIR + 2u * source + 1u] == c);
            }
            case FRAMES, METRIC_TERM, CONTACT_NORMAL, CONTACT_PYRAMID, CONTACT_ELLIPTIC, default: {
            }
        }
    }
    return sum;
}

// Returns the force of the inertia of tendon `t` along it.
fn tendon_inertial_force(t: u32) -> f32 {
    let armature = parameter(TENDON_ARMATURE + t);
    if (armature == 0.0) {
        return 0.0;
    }
    var acceleration = tendon_bias_acceleration(t);
    for (var k = words[TENDON_ROW + t]; k < words[TENDON_ROW + t + 1u]; k++) {
        acceleration += fetch(TEN_JACOBIAN + k) * fetch(QACC + words[TENDON_DOF + k]);
    }
    return -armature * acceleration;
}

fn push_strings() {
    for (var t = 0u; t < NTENDON; t++) {
        if (words[TENDON_SECTION + t] == words[TENDON_SECTION + t + 1u]) {
            continue;
        }
        var force = tendon_passive_force(t) + tendon_inertial_force(t) + tendon_constraint_force(t);
        for (var k = words[TENDON_PULL + t]; k < words[TENDON_PULL + t + 1u]; k++) {
            force += fetch(ACTUATOR_FORCE + words[PULL_OUTPUT + k]) * parameter(PULL_GEAR + k);
        }
        for (var s = words[TENDON_SECTION + t]; s < words[TENDON_SECTION + t + 1u]; s++) {
            let path = section_path(s);
            for (var k = 0u; k < bound(span_count(path)); k++) {
                let span = span_of(s, path, k);
                let pull = direction(span.last - span.first).xyz * (parameter(SECTION_SHARE + s) * force);
                push(span.bodies.x, -1.0, pull, vec3f(), span.first);
                push(span.bodies.y, 1.0, pull, vec3f(), span.last);
            }
        }
    }
}

fn external_forces() {
    for (var b = 0u; b < bound(NBODY); b++) {
        let offset = XFRC_APPLIED + 6u * b;
        put3(CONTACT_FORCE + 6u * b, vec3f());
        put3(CONTACT_FORCE + 6u * b + 3u, vec3f());
        put_spatial(CFRC_EXT + 6u * b, Spatial(vec3f(), vec3f()));
        push(b, 1.0, fetch_state3(offset), fetch_state3(offset + 3u), fetch3(XIPOS + 3u * b));
    }
    for (var b = 0u; b < reports[NBLOCK * envs + env]; b++) {
        let kind = block(b, BLOCK_KIND);
        let wrench = block_wrench(b);
        if (kind >= CONTACT_NORMAL) {
            push_contact(block(b, BLOCK_SOURCE), wrench.linear, wrench.angular);
        } else if (kind == FRAMES) {
            push_frames(block(b, BLOCK_SOURCE), wrench.linear, wrench.angular);
        }
    }
    push_strings();
}
