// Pairs of spheres and capsules. CPU counterparts: `clench-collide/src/narrow/ball.rs` and `capsule.rs`.

// Adds the contact of two balls; `across` is the normal if their centres coincide.
fn ball_ball(pair: u32, a: vec3f, radius_a: f32, b: vec3f, radius_b: f32, across: vec3f, range: f32) {
    let offset = b - a;
    let squared = dot(offset, offset);
    let reach = radius_a + radius_b + range;
    if (reach < 0.0 || squared > reach * reach) {
        return;
    }
    let distance = sqrt(squared);
    var normal = across;
    if (distance >= TINY) {
        normal = offset * (1.0 / distance);
    }
    let gap = distance - radius_a - radius_b;
    add_contact(pair, gap, a + normal * (radius_a + gap * 0.5), normal, tangent_from_normal(normal));
}

// Returns a unit vector perpendicular to two axes; if these are parallel, one near the world's x axis.
fn across_axes(a: vec3f, b: vec3f) -> vec3f {
    let across = cross(a, b);
    if (dot(across, across) >= 1e-24) {
        return direction(across).xyz;
    }
    let other = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(b.x) > 0.9);
    return direction(other - b * dot(b, other)).xyz;
}

fn sphere_sphere(pair: u32, a: Placed, b: Placed, range: f32) {
    let across = direction(cross(a.axes[2], b.axes[2])).xyz;
    ball_ball(pair, a.center, a.size.x, b.center, b.size.x, across, range);
}

fn sphere_capsule(pair: u32, a: Placed, b: Placed, range: f32) {
    let axis = b.axes[2];
    let along = clamp(dot(axis, a.center - b.center), -b.size.y, b.size.y);
    ball_ball(pair, a.center, a.size.x, b.center + axis * along, b.size.x, across_axes(a.axes[2], axis), range);
}

// Adds contacts at the nearest points of two segments; for parallel ones, at both ends of their overlap.
fn capsule_capsule(pair: u32, a: Placed, b: Placed, range: f32) {
    let first = a.axes[2];
    let second = b.axes[2];
    let offset = b.center - a.center;
    let across = cross(first, second);
    let cosine = dot(first, second);
    let ahead = dot(first, offset);
    let behind = dot(second, offset);
    let sine_squared = dot(across, across);
    let normal = across_axes(first, second);
    let parallel = sine_squared < 1e-8;
    let end = select(b.size.y, -b.size.y, cosine < 0.0);
    for (var k = 0u; k < select(1u, 2u, parallel); k++) {
        var s: f32 = 0.0;
        var t: f32 = 0.0;
        if (parallel) {
            let side = select(f32(-1.0), f32(1.0), k == 1u);
            let free = ahead + b.size.y * abs(cosine) * side;
            s = clamp(free, -a.size.y, a.size.y);
            t = select(clamp(cosine * s - behind, -b.size.y, b.size.y), end * side, free == s);
        } else {
            s = clamp(dot(cross(offset, second), across) / sine_squared, -a.size.y, a.size.y);
            let free = cosine * s - behind;
            t = clamp(free, -b.size.y, b.size.y);
            if (free != t) {
                s = clamp(ahead + cosine * t, -a.size.y, a.size.y);
            }
        }
        ball_ball(pair, a.center + first * s, a.size.x, b.center + second * t, b.size.x, normal, range);
    }
}
