// The return mapping of a pair: its stick reference is dragged along by contacts that slide or roll. CPU counterpart:
// `stiction/return_mapping.rs`, which derives the formulas.

// A contact that carries a load: the normal force, the friction that its spring requires (e), the change of that by its
// first slide (κ), and its displacements.
struct LoadedContact {
    force: f32,
    demand: f32,
    stiffness: f32,
    displacement: array<f32, 5>,
}

// A rigid motion: displacement at a centre, and rotation, in world axes.
struct Twist {
    centre: vec3f,
    translation: vec3f,
    rotation: vec3f,
}

// Returns true if a block is a contact with friction.
fn is_rough(b: u32) -> bool {
    let kind = block(b, BLOCK_KIND);
    return kind == CONTACT_PYRAMID || kind == CONTACT_ELLIPTIC;
}

fn is_of_pair(b: u32, pair: u32) -> bool {
    return block(b, BLOCK_KIND) >= CONTACT_NORMAL && pair_of(block(b, BLOCK_SOURCE)) == pair;
}

// Returns true if a block is the first contact with friction of its pair, whose contacts are consecutive.
fn begins_pair(b: u32) -> bool {
    if (!is_rough(b)) {
        return false;
    }
    let pair = pair_of(block(b, BLOCK_SOURCE));
    for (var c = b; c > 0u && is_of_pair(c - 1u, pair); c--) {
        if (is_rough(c - 1u)) {
            return false;
        }
    }
    return true;
}

// Returns the block after the last of a pair whose contacts begin at `b`.
fn end_of_pair(b: u32, pair: u32, nblock: u32) -> u32 {
    var end = b;
    while (end < nblock && is_of_pair(end, pair)) {
        end++;
    }
    return end;
}

// Reads the solution of a contact.
fn loaded(b: u32) -> LoadedContact {
    let first = block(b, BLOCK_ROW);
    let dim = block(b, BLOCK_DIM);
    let pyramid = block(b, BLOCK_KIND) == CONTACT_PYRAMID;
    var one = LoadedContact();
    one.force = max(row(FORCE + first), 0.0);
    for (var j = 1u; j < dim; j++) {
        let a = first + j;
        let mu = row(SHAPE + a);
        let per_row = slope_of_row(a) * row(D + a);
        let stiff = select(per_row / mu, mu * per_row, pyramid);
        let phi = row(POSITION + a);
        let e = stiff * phi;
        one.demand += select(e * e, abs(e), pyramid);
        one.displacement[j - 1u] = phi;
        if (j == 1u) {
            one.stiffness = stiff;
        }
    }
    one.demand = select(sqrt(one.demand), one.demand, pyramid);
    return one;
}

// Returns the factor of the displacements of a pair whose contacts store at most `limit`, m.
fn factor_within(one: LoadedContact, limit: f32) -> f32 {
    let max_demand = limit * one.stiffness;
    if (one.demand > max_demand && one.force > 0.0) {
        return max_demand / one.demand;
    }
    return 1.0;
}

// Returns the motion of the surfaces themselves in a step.
fn drift_of(b: u32) -> vec3f {
    if (!SURFACES_MOVE) {
        return vec3f();
    }
    return surface_velocity(block(b, BLOCK_SOURCE)) * TIMESTEP;
}

// Returns a contact with the changes of its displacements, or with their new values if the reference is replaced.
fn changed(b: u32, limit: f32, replaced: bool) -> LoadedContact {
    var one = loaded(b);
    let factor = factor_within(one, limit) - select(f32(1.0), f32(0.0), replaced);
    let drift = drift_of(b);
    for (var j = 0u; j < 5u; j++) {
        one.displacement[j] *= factor;
    }
    for (var j = 0u; j < 3u; j++) {
        one.displacement[j] += drift[j];
    }
    return one;
}

// Returns the displacement that the contacts of a pair can store, m; negative if none of them carries a load.
fn limit_of(b: u32, end: u32) -> f32 {
    var limit: f32 = 0.0;
    var carries = false;
    for (var c = b; c < end; c++) {
        if (is_rough(c)) {
            let one = loaded(c);
            carries = carries || one.force > 0.0;
            if (one.stiffness > 0.0) {
                limit = max(limit, one.force / one.stiffness);
            }
        }
    }
    return select(f32(-1.0), limit, carries);
}

// Returns true if any contact stores too much, or a surface moves.
fn any_moves(b: u32, end: u32, limit: f32) -> bool {
    for (var c = b; c < end; c++) {
        if (is_rough(c) && (factor_within(loaded(c), limit) < 1.0 || any(drift_of(c) != vec3f()))) {
            return true;
        }
    }
    return false;
}

// Returns the slide of a contact along its tangents, the vectors at `offset`.
fn tangential(offset: u32, first: f32, second: f32) -> vec3f {
    return fetch3(offset + 8u) * first + fetch3(offset + 11u) * second;
}

// Returns the rigid motion that fits the changes of displacements best.
fn fit(b: u32, end: u32, limit: f32, replaced: bool) -> Twist {
    var weight: f32 = 0.0;
    var centre = vec3f();
    var normals = vec3f();
    var translation = vec3f();
    var rolls = vec3f();
    for (var c = b; c < end; c++) {
        if (is_rough(c)) {
            let one = changed(c, limit, replaced);
            let offset = CONTACTS + CONTACT_SIZE * block(c, BLOCK_SOURCE);
            weight += one.force;
            centre += fetch3(offset + 2u) * one.force;
            normals += fetch3(offset + 5u) * one.force;
            translation += tangential(offset, one.displacement[0], one.displacement[1]) * one.force;
            if (block(c, BLOCK_DIM) == 6u) {
                rolls += tangential(offset, one.displacement[3], one.displacement[4]) * one.force;
            }
        }
    }
    let inverse = 1.0 / weight;
    centre *= inverse;
    translation *= inverse;
    rolls *= inverse;
    let normal = direction(normals * inverse).xyz;
    var moment: f32 = 0.0;
    var squared: f32 = 0.0;
    for (var c = b; c < end; c++) {
        if (is_rough(c)) {
            let one = changed(c, limit, replaced);
            let offset = CONTACTS + CONTACT_SIZE * block(c, BLOCK_SOURCE);
            let away = fetch3(offset + 2u) - centre;
            let arm = away - normal * dot(normal, away);
            let slide = tangential(offset, one.displacement[0], one.displacement[1]) - translation;
            moment += one.force * dot(normal, cross(arm, slide));
            squared += one.force * dot(arm, arm);
            if (block(c, BLOCK_DIM) >= 4u) {
                // The squared ratio of spin to slide friction, m².
                let first = block(c, BLOCK_ROW);
                let ratio = row(SHAPE + first + 3u) / row(SHAPE + first + 1u);
                moment += one.force * (ratio * ratio) * one.displacement[2];
                squared += one.force * (ratio * ratio);
            }
        }
    }
    var spin: f32 = 0.0;
    if (squared > weight * MIN_SQUARED_ARM) {
        spin = moment / squared;
    }
    return Twist(centre, translation, normal * spin + rolls);
}

// Returns the reference whose displacements are larger by those of a twist. The quaternion of the rotation, which is
// small, is exact to second order.
fn displaced(reference: RelativePose, first: u32, twist: Twist) -> RelativePose {
    let back_to = transpose(fetch_matrix(XMAT + 9u * first));
    let back = quat_normalize(vec4f(1.0, back_to * twist.rotation * -0.5));
    let centre = back_to * (twist.centre - fetch3(XPOS + 3u * first));
    return RelativePose(
        centre + quat_rotate(back, reference.position - centre) - back_to * twist.translation,
        quat_normalize(quat_product(back, reference.rotation)),
    );
}
