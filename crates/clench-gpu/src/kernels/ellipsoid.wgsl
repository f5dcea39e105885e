// Forces of the medium on geoms, as ellipsoids of the same semi-axes. CPU counterpart: `dynamics/ellipsoid.rs`, which
// explains the formulas.

// An ellipsoid at one velocity, v and ω in the geom's frame. Its coefficients at `prm` are ρ times virtual mass and
// inertia, ρ C_M V, ρ C_K, 3π D η and π D³ η, ρ C_s A_max and ρ (C_b − C_s), ρ c, a.
struct Ellipsoid {
    geom: u32,
    prm: u32,
    velocity: Spatial,
}

// Speed, n, A, and A cos α / |n|; or their changes.
struct Flow {
    speed: f32,
    normal: vec3f,
    area: f32,
    lift: f32,
}

// Returns a denominator: x if it is positive, else one.
fn positive(x: f32) -> f32 {
    return select(1.0, x, x > 0.0);
}

// Returns a motion of a geom's body, at the geom's origin, along the geom's axes.
fn in_geom_frame(geom: u32, motion: Spatial) -> Spatial {
    let back = transpose(fetch_matrix(GEOM_XMAT + 9u * geom));
    let arm = offset_of(words[GEOM_BODY + geom], fetch3(GEOM_XPOS + 3u * geom));
    return Spatial(back * motion.angular, back * (motion.linear + cross(motion.angular, arm)));
}

// Returns ellipsoid `e` of the model at its current velocity.
fn ellipsoid(e: u32) -> Ellipsoid {
    let geom = words[ELLIPSOID_GEOM + e];
    var velocity = in_geom_frame(geom, fetch_spatial(CVEL + 6u * words[GEOM_BODY + geom]));
    velocity.linear -= transpose(fetch_matrix(GEOM_XMAT + 9u * geom)) * parameter3(WIND);
    return Ellipsoid(geom, ELLIPSOID_PRM + ELLIPSOID_SIZE * e, velocity);
}

fn flow_of(e: Ellipsoid) -> Flow {
    let v = e.velocity.linear;
    let normal = v * parameter3(e.prm + ELLIPSOID_AREA);
    let along = dot(v, normal);
    let squared = dot(normal, normal);
    let speed = length(v);
    let area = PI * sqrt(squared / positive(along));
    return Flow(speed, normal, area, area * along / positive(speed * squared));
}

// Returns the change of the flow for a change `dv` of the velocity.
fn flow_change(e: Ellipsoid, flow: Flow, dv: vec3f) -> Flow {
    let v = e.velocity.linear;
    let normal = dv * parameter3(e.prm + ELLIPSOID_AREA);
    let speed = dot(v, dv) / positive(flow.speed);
    let along = dot(flow.normal, dv) / positive(dot(v, flow.normal));
    let squared = dot(flow.normal, normal) / positive(dot(flow.normal, flow.normal));
    let lift = flow.lift * (along - squared - speed / positive(flow.speed));
    return Flow(speed, normal, flow.area * (squared - along), lift);
}

// Returns the drag force divided by the velocity.
fn linear_drag(e: Ellipsoid, flow: Flow) -> f32 {
    return parameter(e.prm + ELLIPSOID_VISCOUS) + flow.speed * (parameter(e.prm + ELLIPSOID_SLENDER) + parameter(e.prm + ELLIPSOID_BLUNT) * flow.area);
}

// Returns the spatial force, about the reference point of its tree, of a torque and a force at the geom's origin, along
// its axes.
fn from_geom_frame(geom: u32, torque: vec3f, force: vec3f) -> Spatial {
    let axes = fetch_matrix(GEOM_XMAT + 9u * geom);
    let arm = offset_of(words[GEOM_BODY + geom], fetch3(GEOM_XPOS + 3u * geom));
    return Spatial(axes * torque + cross(arm, axes * force), axes * force);
}

// Returns the force on the body.
fn ellipsoid_force(e: Ellipsoid) -> Spatial {
    let v = e.velocity.linear;
    let w = e.velocity.angular;
    let momentum = v * parameter3(e.prm + ELLIPSOID_MASS);
    let spin = w * parameter3(e.prm + ELLIPSOID_INERTIA);
    let flow = flow_of(e);
    let lift = cross(cross(flow.normal, v), v) * (parameter(e.prm + ELLIPSOID_KUTTA) * flow.lift);
    let force = cross(momentum, w) + cross(w, v) * parameter(e.prm + ELLIPSOID_MAGNUS) + lift - v * linear_drag(e, flow);
    let turning = parameter(e.prm + ELLIPSOID_VISCOUS_ANGULAR) + length(w * parameter3(e.prm + ELLIPSOID_ANGULAR));
    return from_geom_frame(e.geom, cross(momentum, v) + cross(spin, w) - w * turning, force);
}

// Sums the forces on the ellipsoids of a body.
fn ellipsoids_force(b: u32) -> Spatial {
    var sum = Spatial(vec3f(), vec3f());
    for (var e = words[BODY_ELLIPSOID + b]; e < words[BODY_ELLIPSOID + b + 1u]; e++) {
        sum = plus(sum, ellipsoid_force(ellipsoid(e)));
    }
    return sum;
}

fn has_ellipsoids(b: u32) -> bool {
    return ANY_FLUID_ELLIPSOID && words[BODY_ELLIPSOID + b] < words[BODY_ELLIPSOID + b + 1u];
}
