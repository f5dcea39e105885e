// Accelerations of the lengths of tendons at zero dof acceleration. CPU counterpart: `dynamics/tendon_path.rs`.

// Returns d²length/dt² of a straight part of a string at zero dof acceleration.
fn span_acceleration(span: Span) -> f32 {
    if (span.bodies.x == span.bodies.y) {
        return 0.0;
    }
    let unit = direction(span.last - span.first);
    let apart = velocity_at(span.bodies.y, span.last).linear - velocity_at(span.bodies.x, span.first).linear;
    var both = vec3f();
    for (var side = 0u; side < bound(2u); side++) {
        let is_last = side == 1u;
        let at = select(span.first, span.last, is_last);
        both += bias_acceleration(select(span.bodies.x, span.bodies.y, is_last), at).linear * select(f32(-1.0), f32(1.0), is_last);
    }
    let along = dot(unit.xyz, apart);
    let across = select((dot(apart, apart) - along * along) / max(unit.w, TINY), 0.0, unit.w < TINY);
    return dot(unit.xyz, both) + across;
}

// Returns d²length/dt² of a tendon at zero dof acceleration.
fn tendon_bias_acceleration(t: u32) -> f32 {
    var acceleration: f32 = 0.0;
    for (var s = words[TENDON_SECTION + t]; s < words[TENDON_SECTION + t + 1u]; s++) {
        let path = section_path(s);
        for (var k = 0u; k < bound(span_count(path)); k++) {
            acceleration += parameter(SECTION_SHARE + s) * span_acceleration(span_of(s, path, k));
        }
    }
    return acceleration;
}
