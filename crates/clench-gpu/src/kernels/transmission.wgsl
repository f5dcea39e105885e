// The length of each actuator and its moment arms, a row over the dofs that it acts on. CPU counterparts:
// `dynamics/transmission.rs` and `site_transmission.rs`.

// Returns the spatial force, about the reference point of its tree, of a force and a couple at a site, in world axes.
fn pull_at(site: u32, force: vec3f, couple: vec3f) -> Spatial {
    let arm = offset_of(words[SITE_BODY + site], fetch3(SITE_XPOS + 3u * site));
    return Spatial(couple + cross(arm, force), force);
}

// Writes the moment arms of a pull on the first site; for dofs that move only the second, those of a pull on that.
fn write_arms(u: u32, a: u32, first: Spatial, b: u32, second: Spatial) {
    write_arms_of(output_of(u), a, first, b, second);
}

// Does the same for one of several outputs.
fn write_arms_of(output: u32, a: u32, first: Spatial, b: u32, second: Spatial) {
    for (var k = words[ACTUATOR_ROW + output]; k < words[ACTUATOR_ROW + output + 1u]; k++) {
        let dof = words[ACTUATOR_DOF + k];
        let axis = fetch_spatial(CDOF + 6u * dof);
        if (moves(words[SITE_BODY + a], dof)) {
            put(ACTUATOR_MOMENT + k, spatial_dot(axis, first));
        } else {
            put(ACTUATOR_MOMENT + k, spatial_dot(axis, second));
        }
    }
}

// Returns a torque on a joint at the rotation `rotation`, along the axes of the child.
fn to_child(u: u32, rotation: vec4f, torque: vec3f) -> vec3f {
    if (words[ACTUATOR_IN_PARENT + u] == 1u) {
        return quat_rotate(vec4f(rotation.x, -rotation.yzw), torque);
    }
    return torque;
}

fn on_joint(u: u32, j: u32) -> f32 {
    let gear = ACTUATOR_GEAR + 6u * u;
    let arms = ACTUATOR_MOMENT + first_arm(u);
    let q = QPOS + words[JNT_QPOS + j];
    let kind = words[ACTUATOR_ON + u];
    if (!ANY_ON_ROTATION || kind == ON_SCALAR) {
        put(arms, parameter(gear));
        return fetch_state(q) * parameter(gear);
    }
    if (kind == ON_BALL) {
        let rotation = quat_normalize(fetch_state4(q));
        let axis = to_child(u, rotation, parameter3(gear));
        put3(arms, axis);
        return dot(quat_rotation_vector(rotation), axis);
    }
    put3(arms, parameter3(gear));
    put3(arms + 3u, to_child(u, quat_normalize(fetch_state4(q + 3u)), parameter3(gear + 3u)));
    return 0.0;
}

fn on_tendon(u: u32, t: u32) -> f32 {
    let gear = parameter(ACTUATOR_GEAR + 6u * u);
    let start = words[TENDON_ROW + t];
    for (var k = start; k < words[TENDON_ROW + t + 1u]; k++) {
        put(ACTUATOR_MOMENT + first_arm(u) + k - start, fetch(TEN_JACOBIAN + k) * gear);
    }
    return fetch(TEN_LENGTH + t) * gear;
}

// Transmits a wrench along the axes of a site, which has no length.
fn on_site(u: u32, site: u32) -> f32 {
    let axes = fetch_matrix(SITE_XMAT + 9u * site);
    let gear = ACTUATOR_GEAR + 6u * u;
    let pull = pull_at(site, axes * parameter3(gear), axes * parameter3(gear + 3u));
    write_arms(u, site, pull, site, pull);
    return 0.0;
}

fn site_quat(site: u32) -> vec4f {
    return quat_product(fetch4(XQUAT + 4u * words[SITE_BODY + site]), parameter4(SITE_QUAT + 4u * site));
}

// Transmits to the pose of a site in the frame of another: its position along the first three gears, and its rotation
// vector along the others.
fn on_site_in_frame(u: u32, site: u32, frame: u32) -> f32 {
    let along = parameter3(ACTUATOR_GEAR + 6u * u);
    let about = parameter3(ACTUATOR_GEAR + 6u * u + 3u);
    let axes = fetch_matrix(SITE_XMAT + 9u * frame);
    let shift = transpose(axes) * (fetch3(SITE_XPOS + 3u * site) - fetch3(SITE_XPOS + 3u * frame));
    let rotation = quat_difference(site_quat(site), site_quat(frame));
    let pull = pull_at(site, axes * along, axes * about);
    write_arms(u, site, pull, frame, pull_at(frame, axes * -along, axes * -about));
    return dot(shift, along) + dot(rotation, about);
}

fn on_slider_crank(u: u32, crank: u32, slider: u32) -> f32 {
    let gear = parameter(ACTUATOR_GEAR + 6u * u);
    let rod = parameter(ACTUATOR_ROD + u);
    let axis = fetch_matrix(SITE_XMAT + 9u * slider)[2];
    let offset = fetch3(SITE_XPOS + 3u * crank) - fetch3(SITE_XPOS + 3u * slider);
    let along = dot(offset, axis);
    let squared = along * along + rod * rod - dot(offset, offset);
    let root = sqrt(max(squared, 0.0));
    let inverse = select(0.0, 1.0 / max(root, TINY), squared > 0.0);
    let lean = 1.0 - along * inverse;
    let force = (axis * lean + offset * inverse) * gear;
    let couple = cross(axis, offset * (lean * gear));
    write_arms(u, crank, pull_at(crank, force, vec3f()), slider, pull_at(slider, -force, couple));
    return (along - root) * gear;
}

// Transmits to the rotation of a ball joint, or of a site in the frame of another: three lengths, those of its rotation
// vector, and arms about the axes of the rotated body.
fn on_rotation(u: u32, element: u32, frame: u32) {
    let output = output_of(u);
    switch words[ACTUATOR_ON + u] {
        case ON_ROTATION: {
            put3(ACTUATOR_LENGTH + output, quat_rotation_vector(quat_normalize(fetch_state4(QPOS + words[JNT_QPOS + element]))));
            put3(ACTUATOR_MOMENT + first_arm(u), vec3f(1.0));
        }
        case ON_ROTATION_IN_FRAME, default: {
            put3(ACTUATOR_LENGTH + output, quat_difference(site_quat(element), site_quat(frame)));
            let axes = fetch_matrix(SITE_XMAT + 9u * element);
            for (var axis = 0u; axis < bound(3u); axis++) {
                let pull = pull_at(element, vec3f(), axes[axis]);
                write_arms_of(output + axis, element, pull, frame, pull_at(frame, vec3f(), -axes[axis]));
            }
        }
    }
}

// Transmits a wrench at a site, the pose of a site in the frame of another, or a slider-crank.
fn on_sites(u: u32, site: u32, other: u32) -> f32 {
    switch words[ACTUATOR_ON + u] {
        case ON_SITE: {
            return on_site(u, site);
        }
        case ON_SITE_IN_FRAME: {
            return on_site_in_frame(u, site, other);
        }
        case ON_SLIDER_CRANK, default: {
            return on_slider_crank(u, site, other);
        }
    }
}

fn transmissions() {
    for (var u = member; u < NU; u += TEAM) {
        let kind = words[ACTUATOR_ON + u];
        let element = words[ACTUATOR_TARGET + 2u * u];
        var length: f32 = 0.0;
        if (ANY_ORIENTATION && kind >= ON_ROTATION) {
            on_rotation(u, element, words[ACTUATOR_TARGET + 2u * u + 1u]);
            continue;
        }
        if (ANY_ON_TENDON && kind == ON_TENDON) {
            length = on_tendon(u, element);
        } else if (ANY_ON_CONTACTS && kind == ON_CONTACTS) {
            // Its moment arms are computed after the contacts.
            length = 0.0;
        } else if (ANY_ON_SITE && kind > ON_TENDON) {
            length = on_sites(u, element, words[ACTUATOR_TARGET + 2u * u + 1u]);
        } else {
            length = on_joint(u, element);
        }
        put(ACTUATOR_LENGTH + output_of(u), length);
    }
}
