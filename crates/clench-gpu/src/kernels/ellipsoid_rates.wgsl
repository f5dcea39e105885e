// Velocity derivatives of the medium's forces on ellipsoids. CPU counterparts: `dynamics/ellipsoid.rs` and `fluid.rs`.

// Returns the change of the force on the body for a change `motion` of its velocity; in the metric only that of drag.
fn ellipsoid_derivative(e: Ellipsoid, motion: Spatial) -> Spatial {
    let v = e.velocity.linear;
    let w = e.velocity.angular;
    let change_of_velocity = in_geom_frame(e.geom, motion);
    let dv = change_of_velocity.linear;
    let dw = change_of_velocity.angular;
    let flow = flow_of(e);
    let change = flow_change(e, flow, dv);
    let widest = parameter(e.prm + ELLIPSOID_SLENDER);
    let blunt = parameter(e.prm + ELLIPSOID_BLUNT);
    let ddrag = change.speed * (widest + blunt * flow.area) + flow.speed * blunt * change.area;
    let drag = -(v * ddrag) - dv * linear_drag(e, flow);
    let angular_drag = parameter3(e.prm + ELLIPSOID_ANGULAR);
    let resisted = w * angular_drag;
    let size = length(resisted);
    let slope = dot(resisted, dw * angular_drag) / positive(size);
    let turning = -(w * slope) - dw * (parameter(e.prm + ELLIPSOID_VISCOUS_ANGULAR) + size);
    if (IN_METRIC) {
        return from_geom_frame(e.geom, turning, drag);
    }
    let mass = parameter3(e.prm + ELLIPSOID_MASS);
    let inertia = parameter3(e.prm + ELLIPSOID_INERTIA);
    let turned = cross(flow.normal, v);
    let dturned = cross(change.normal, v) + cross(flow.normal, dv);
    let dlift = cross(turned, v) * change.lift + (cross(dturned, v) + cross(turned, dv)) * flow.lift;
    let force = cross(dv * mass, w) + cross(v * mass, dw) + (cross(dw, v) + cross(w, dv)) * parameter(e.prm + ELLIPSOID_MAGNUS)
        + dlift * parameter(e.prm + ELLIPSOID_KUTTA) + drag;
    let torque = cross(dv * mass, v) + cross(v * mass, dv) + cross(dw * inertia, w) + cross(w * inertia, dw) + turning;
    return from_geom_frame(e.geom, torque, force);
}

// Returns a unit motion: about an axis, or along one.
fn motion_component(c: u32) -> Spatial {
    var axis = vec3f();
    axis[c % 3u] = 1.0;
    let moves_along = c >= 3u;
    return Spatial(select(axis, vec3f(), moves_along), select(vec3f(), axis, moves_along));
}

// Writes, for each component of a body's motion, the change of the force on its ellipsoids, both about the reference
// point of its tree.
fn write_ellipsoid_rates(b: u32) {
    for (var c = 0u; c < bound(6u); c++) {
        var sum = Spatial(vec3f(), vec3f());
        for (var e = words[BODY_ELLIPSOID + b]; e < words[BODY_ELLIPSOID + b + 1u]; e++) {
            sum = plus(sum, ellipsoid_derivative(ellipsoid(e), motion_component(c)));
        }
        put_spatial(FLUID_RATES + 36u * b + 6u * c, sum);
    }
}

fn ellipsoid_rates() {
    for (var b = 1u; b < bound(NBODY); b++) {
        if (has_ellipsoids(b)) {
            write_ellipsoid_rates(b);
        }
    }
}

// Returns column `c` of the rates of a body: its symmetric part, with `sign` 1, or its skew one, with −1.
fn rate_part(b: u32, c: u32, sign: f32) -> Spatial {
    let offset = FLUID_RATES + 36u * b;
    var across = Spatial(vec3f(), vec3f());
    for (var k = 0u; k < bound(3u); k++) {
        across.angular[k] = fetch(offset + 6u * k + c);
        across.linear[k] = fetch(offset + 18u + 6u * k + c);
    }
    return times(plus(fetch_spatial(offset + 6u * c), times(across, sign)), 0.5);
}

// Returns the change by that part for a motion of the body.
fn rate_along(b: u32, motion: Spatial, sign: f32) -> Spatial {
    var change = Spatial(vec3f(), vec3f());
    for (var k = 0u; k < bound(3u); k++) {
        change = plus(change, times(rate_part(b, k, sign), motion.angular[k]));
        change = plus(change, times(rate_part(b, k + 3u, sign), motion.linear[k]));
    }
    return change;
}
