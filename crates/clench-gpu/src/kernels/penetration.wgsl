// The penetration depth of a segment inside a cylinder. CPU counterpart: `clench-collide/src/narrow/penetration.rs`,
// which derives the candidates.

// The number of halvings of a right angle to its rounding error.
const ANGLE_HALVINGS: u32 = 26u;

// Returns n or −n, whichever points to the side of `center`.
fn towards(center: vec3f, n: vec3f) -> vec3f {
    return select(n, -n, dot(n, center) < 0.0);
}

// Returns the direction from the cylinder's axis to the nearest point of the segment, both projected along the axis.
fn radial_penetration_direction(s: Segment, spare: vec3f) -> vec3f {
    let square = max(dot(s.axis.xy, s.axis.xy), TINY);
    let t = clamp(-dot(s.center.xy, s.axis.xy) / square, -s.half_length, s.half_length);
    let nearest = s.center.xy + s.axis.xy * t;
    let apart = length(nearest);
    if (apart < 1e-12) {
        return spare;
    }
    return vec3f(nearest / apart, 0.0);
}

// Returns the best direction across the segment, between `a` and `b`.
fn direction_across_segment(s: Segment, size: vec3f, a: vec3f, b: vec3f) -> vec3f {
    let r2 = size.x * size.x;
    let k2 = r2 * s.axis.z * s.axis.z;
    let level = size.y * abs(b.z) - dot(s.center, b);
    let aside = max(dot(s.center, a), size.x * 1e-9);
    let stationary = power_of(max(r2 - k2, 0.0) * r2 / aside, 2.0 / 3.0);
    let rise = max(stationary - r2, 0.0);
    let whole = sqrt(rise + k2);
    var low = vec2f(1.0, 0.0);
    if (whole >= TINY) {
        low = vec2f(sqrt(k2), sqrt(rise)) / whole;
    }
    var high = vec2f(0.0, 1.0);
    for (var k = 0u; k < bound(ANGLE_HALVINGS); k++) {
        let middle = normalize(low + high);
        let around = sqrt(r2 * middle.x * middle.x + k2 * middle.y * middle.y);
        let slope = level * middle.x + aside * middle.y - (r2 - k2) * middle.x * middle.y / around;
        if (slope > 0.0) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return normalize(a * high.x + b * high.y);
}

// Returns the unit direction that moves a segment out of a cylinder, and the depth.
fn penetration_depth(s: Segment, size: vec3f) -> vec4f {
    let z = vec3f(0.0, 0.0, 1.0);
    let a = towards(s.center, direction(cross(z, s.axis)).xyz);
    let b = towards(s.center, direction(cross(s.axis, a)).xyz);
    var best = vec4f(a, 3e38);
    for (var k = 0u; k < bound(5u); k++) {
        var n = a;
        switch k {
            case 1u: {
                n = towards(s.center, z);
            }
            case 2u: {
                n = b;
            }
            case 3u: {
                n = radial_penetration_direction(s, a);
            }
            case 4u: {
                n = direction_across_segment(s, size, a, b);
            }
            default: {}
        }
        let sides = size.x * length(n.xy) + size.y * abs(n.z) + s.half_length * abs(dot(n, s.axis));
        let depth = sides - dot(n, s.center);
        if (depth < best.w) {
            best = vec4f(n, depth);
        }
    }
    return best;
}

// Returns the parameter of the segment's deepest point along the exit direction. Between two parallel flats any point
// suffices; then it is `otherwise`.
fn deepest_of_segment(s: Segment, size: vec3f, outward: vec3f, otherwise: f32) -> f32 {
    let tiny: f32 = 1e-6;
    let slope = dot(outward, s.axis);
    if (abs(slope) >= tiny) {
        return select(-s.half_length, s.half_length, slope < 0.0);
    }
    let level = length(outward.xy);
    var across = otherwise;
    if (level >= tiny && abs(outward.z) < tiny) {
        let square = dot(s.axis.xy, s.axis.xy);
        across = select(-dot(s.center.xy, s.axis.xy) / max(square, TINY), otherwise, square < tiny * tiny);
    } else if (level >= tiny) {
        let circle_point = vec3f(outward.xy * (size.x / level), select(size.y, -size.y, outward.z < 0.0));
        across = dot(s.axis, circle_point - s.center);
    }
    return clamp(across, -s.half_length, s.half_length);
}
