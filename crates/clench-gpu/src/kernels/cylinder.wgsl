// Sphere–cylinder and capsule–cylinder. CPU counterpart: `clench-collide/src/narrow/cylinder.rs`. Vectors are in the
// cylinder's frame, with its axis z; `size` holds its radius and half length.

// The maximum steps to the nearest point of a segment.
const SEGMENT_STEPS: u32 = 40u;

// The middle line of a capsule.
struct Segment {
    center: vec3f,
    axis: vec3f,
    half_length: f32,
}

fn on_segment(s: Segment, t: f32) -> vec3f {
    return s.center + s.axis * t;
}

// Returns the outward direction at a point and the signed distance to the surface. `spare` is the direction for points
// on the axis.
fn cylinder_distance(p: vec3f, size: vec3f, spare: vec3f) -> vec4f {
    let from_axis = length(p.xy);
    let above_cap = abs(p.z) - size.y;
    let off_side = from_axis - size.x;
    let up = max(above_cap, 0.0);
    let out = max(off_side, 0.0);
    let apart = sqrt(up * up + out * out);
    // Inside the cylinder the nearer of cap and side decides; outside both, the circle between them.
    var along = select(f32(0.0), f32(1.0), above_cap > off_side);
    var across = 1.0 - along;
    var signed_distance = max(above_cap, off_side);
    if (apart >= TINY) {
        along = up / apart;
        across = out / apart;
        signed_distance = apart;
    }
    var outward = spare * across;
    if (from_axis >= TINY) {
        outward = vec3f(p.xy * (across / from_axis), 0.0);
    }
    outward.z = select(-along, along, p.z > 0.0);
    return vec4f(outward, signed_distance);
}

// Returns the outward direction for points on the axis of `b`, given the axis of `a`.
fn spare_direction(a: Placed, b: Placed) -> vec3f {
    return -(transpose(b.axes) * across_axes(a.axes[2], b.axes[2]));
}

// Adds the contact of a ball with the cylinder `b`.
fn ball_cylinder(pair: u32, center: vec3f, radius: f32, surface: vec4f, b: Placed, range: f32) {
    let gap = surface.w - radius;
    if (gap > range) {
        return;
    }
    let position = center - surface.xyz * (radius + gap * 0.5);
    let normal = -(b.axes * surface.xyz);
    add_contact(pair, gap, b.center + b.axes * position, normal, tangent_from_normal(normal));
}

fn sphere_cylinder(pair: u32, a: Placed, b: Placed, range: f32) {
    let center = transpose(b.axes) * (a.center - b.center);
    let surface = cylinder_distance(center, b.size, spare_direction(a, b));
    ball_cylinder(pair, center, a.size.x, surface, b, range);
}

// Returns the first and second derivative along a segment of half the squared distance beyond the surface.
fn segment_slope(s: Segment, t: f32, size: vec3f) -> vec2f {
    let p = on_segment(s, t);
    let from_axis = length(p.xy);
    let inverse = 1.0 / max(from_axis, SMALLEST);
    let beyond_side = max(from_axis - size.x, 0.0);
    let beyond_cap = max(abs(p.z) - size.y, 0.0);
    let outward = dot(p.xy, s.axis.xy) * inverse;
    let upward = select(s.axis.z, -s.axis.z, p.z < 0.0);
    let around = (dot(s.axis.xy, s.axis.xy) - outward * outward) * inverse;
    let bend = select(0.0, outward * outward + beyond_side * around, beyond_side > 0.0)
        + select(0.0, upward * upward, beyond_cap > 0.0);
    return vec2f(beyond_side * outward + beyond_cap * upward, bend);
}

// Returns the parameter of a segment's point nearest to the cylinder, by safeguarded Newton steps; any one inside if
// the segment enters.
fn nearest_on_segment(s: Segment, size: vec3f) -> f32 {
    var low = -s.half_length;
    var high = s.half_length;
    if (segment_slope(s, low, size).x >= 0.0) {
        return low;
    }
    if (segment_slope(s, high, size).x <= 0.0) {
        return high;
    }
    var t: f32 = 0.0;
    var last = 2.0 * s.half_length;
    let enough = (s.half_length + size.x + size.y) * EPSILON;
    for (var k = 0u; k < bound(SEGMENT_STEPS); k++) {
        let slope = segment_slope(s, t, size);
        if (slope.x > 0.0) {
            high = t;
        } else {
            low = t;
        }
        let step = -slope.x / max(slope.y, SMALLEST);
        var next = t + step;
        if (!(abs(step) <= 0.5 * last && next >= low && next <= high)) {
            next = 0.5 * (low + high);
        }
        last = abs(next - t);
        t = next;
        if (last <= enough) {
            break;
        }
    }
    return t;
}

// Returns the ends of the interval of a segment along the cap or the side, whichever the point at `nearest` faces more;
// only that point if the segment is tilted against it.
fn segment_overlap(s: Segment, nearest: f32, size: vec3f, spare: vec3f) -> vec2f {
    let c = s.center;
    let u = s.axis;
    let square = max(dot(u.xy, u.xy), TINY);
    var middle = -dot(c.xy, u.xy) / square;
    let miss = c.x * u.y - c.y * u.x;
    var reach = sqrt(max(size.x * size.x * square - miss * miss, 0.0)) / square;
    var tilt = u.z * u.z;
    let outward = cylinder_distance(on_segment(s, nearest), size, spare);
    if (outward.z * outward.z <= 0.5) {
        let slope = select(u.z, TINY, abs(u.z) < TINY);
        middle = -c.z / slope;
        reach = size.y / abs(slope);
        tilt = dot(u.xy, u.xy);
    }
    if (tilt > CAPSULE_LEVEL_SINE * CAPSULE_LEVEL_SINE) {
        return vec2f(nearest);
    }
    let low = min(max(middle - reach, -s.half_length), nearest);
    return vec2f(low, max(min(middle + reach, s.half_length), nearest));
}

// Adds the contacts of a capsule with its middle line outside: the deepest point, and both ends of the interval along
// the cap or the side.
fn capsule_beside_cylinder(pair: u32, s: Segment, radius: f32, nearest: f32, least: f32, b: Placed, spare: vec3f, range: f32) {
    let ends = segment_overlap(s, nearest, b.size, spare);
    // If the two are parallel, an end is as deep as any point between.
    let level = least + max(1e-9, 8.0 * EPSILON) * (radius + b.size.x);
    var first = nearest;
    for (var k = 0u; k < 2u; k++) {
        if (cylinder_distance(on_segment(s, ends[k]), b.size, spare).w <= level) {
            first = ends[k];
        }
    }
    for (var k = 0u; k < bound(3u); k++) {
        var t = first;
        if (k > 0u) {
            t = ends[k - 1u];
        }
        if (k == 0u || t != first) {
            let center = on_segment(s, t);
            ball_cylinder(pair, center, radius, cylinder_distance(center, b.size, spare), b, range);
        }
    }
}

fn capsule_cylinder(pair: u32, a: Placed, b: Placed, range: f32) {
    let back = transpose(b.axes);
    let s = Segment(back * (a.center - b.center), back * a.axes[2], a.size.y);
    let spare = spare_direction(a, b);
    let radius = a.size.x;
    let nearest = nearest_on_segment(s, b.size);
    let least = cylinder_distance(on_segment(s, nearest), b.size, spare).w;
    if (least - radius > range) {
        return;
    }
    // Once its middle line enters the cylinder, distances of its points no longer give the penetration depth.
    if (least <= 8.0 * EPSILON * (radius + b.size.x)) {
        let out = penetration_depth(s, b.size);
        let center = on_segment(s, deepest_of_segment(s, b.size, out.xyz, nearest));
        ball_cylinder(pair, center, radius, vec4f(out.xyz, -out.w), b, range);
        return;
    }
    capsule_beside_cylinder(pair, s, radius, nearest, least, b, spare, range);
}
