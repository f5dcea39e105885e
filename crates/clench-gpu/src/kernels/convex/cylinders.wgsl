// The largest gap of two overlapping cylinders, among its few candidate directions. CPU counterpart:
// `clench-collide/src/narrow/convex/cylinders.rs`, which derives them.

// A cylinder, and the position of the other relative to its centre: across both axes, along `side`, and along its own
// axis. `side` is the unit direction across its axis towards the other's axis.
struct Facing {
    size: vec3f,
    side: vec3f,
    offset: vec3f,
}

fn facing(size: vec3f, side: vec3f, offset: vec3f, sideways: vec3f, axis: vec3f) -> Facing {
    return Facing(size, side, vec3f(dot(offset, sideways), dot(offset, side), dot(offset, axis)));
}

// Returns true if a cap circle of another cylinder passes within `depth` of this one's cap and side, inside, at one of
// its ends; `ends` select that end and the circle. The test is conservative.
fn near_circle(own: Facing, other: Facing, ends: vec2f, cosine: f32, sine: f32, depth: f32) -> bool {
    let arm = other.size.y * ends.y;
    let x = own.offset.x;
    let y = own.offset.y + arm * sine;
    let z = (own.offset.z + arm * cosine) * ends.x;
    let inverse = 1.0 / (other.size.x * sine);
    let low = max((own.size.y - depth - z) * inverse, -1.0);
    let high = min((own.size.y - z) * inverse, 1.0);
    if (low > high) {
        return false;
    }
    let at_low = sqrt(max(1.0 - low * low, 0.0)) * other.size.x;
    let at_high = sqrt(max(1.0 - high * high, 0.0)) * other.size.x;
    let largest = select(max(at_low, at_high), other.size.x, low < 0.0 && high > 0.0);
    let least = min(at_low, at_high);
    let slope = -cosine * ends.x * other.size.x;
    let inner = max(own.size.x - depth, 0.0);
    let from_axis = span_distances(min(y + slope * low, y + slope * high), max(y + slope * low, y + slope * high));
    for (var k = 0u; k < bound(2u); k++) {
        let across_axis = span_distances(select(x - largest, x + least, k == 0u), select(x - least, x + largest, k == 0u));
        let nearest = vec2f(across_axis.x, from_axis.x);
        let furthest = vec2f(across_axis.y, from_axis.y);
        if (dot(nearest, nearest) <= own.size.x * own.size.x && dot(furthest, furthest) >= inner * inner) {
            return true;
        }
    }
    return false;
}

// Returns the least and largest distance of an interval's numbers from 0.
fn span_distances(low: f32, high: f32) -> vec2f {
    return vec2f(max(max(low, -high), 0.0), max(high, -low));
}

// Returns true if a direction across two cap circles may have a smaller depth than `depth`.
fn circles_cross(a: Facing, b: Facing, cosine: f32, sine: f32, depth: f32) -> bool {
    for (var k = 0u; k < bound(4u); k++) {
        let ends = vec2f(select(f32(1.0), f32(-1.0), (k & 2u) != 0u), select(f32(1.0), f32(-1.0), (k & 1u) != 0u));
        var both = true;
        for (var side = 0u; side < bound(2u) && both; side++) {
            var own = a;
            var other = b;
            var order = ends;
            if (side == 1u) {
                own = b;
                other = a;
                order = ends.yx;
            }
            both = near_circle(own, other, order, cosine, sine, depth);
        }
        if (both) {
            return true;
        }
    }
    return false;
}

fn holds(size: vec3f, p: vec3f) -> bool {
    return abs(p.z) <= size.y && dot(p.xy, p.xy) <= size.x * size.x;
}

// Returns the largest gap of two overlapping cylinders, or a positive one. It is not exact if either may be across
// two cap circles, or no common point is known; it is −UNMOVABLE if the axes are parallel.
fn cylinders_gap() -> Gap {
    let own_axis = vec3f(0.0, 0.0, 1.0);
    let axis = rotation_b[2];
    let cosine = axis.z;
    let sine = length(axis.xy);
    largest_gap = Gap(own_axis, -UNMOVABLE, false);
    bar = -UNMOVABLE;
    if (sine <= EPSILON) {
        return largest_gap;
    }
    let least = vec3f(largest * EPSILON, 0.0, 0.0);
    let sideways = vec3f(-axis.y, axis.x, 0.0) / sine;
    let a = facing(max(body_a.size, least), cross(sideways, own_axis), offset_b, sideways, own_axis);
    let b = facing(max(body_b.size, least), cross(axis, sideways), -offset_b, sideways, axis);
    var furthest = Vertex(vec3f(), vec3f(), vec3f());
    // The axes, the direction across both, and the normals of each tilted circle through the other's corner.
    for (var k = 0u; k < bound(5u); k++) {
        var n = own_axis;
        if (k == 1u) {
            n = axis;
        } else if (k == 2u) {
            n = sideways;
        } else if (k >= 3u) {
            var own = a;
            var other = b;
            if (k == 4u) {
                own = b;
                other = a;
            }
            let corner = vec2f(abs(own.offset.x), abs(own.offset.y) - other.size.y * sine) / other.size.x;
            let found = ellipse_normal(max(abs(cosine), EPSILON), sine, corner);
            if (all(found == vec2f())) {
                continue;
            }
            n = sideways * (signed(1.0, own.offset.x) * found.x) + own.side * (signed(1.0, own.offset.y) * found.y);
        }
        n *= signed(1.0, dot(n, offset_b));
        let vertex = vertex_along(n);
        if (dot(n, vertex.w) > bar) {
            furthest = vertex;
        }
        offer(dot(n, vertex.w), n);
    }
    let axes_pass = abs(a.offset.y) <= b.size.y * sine && abs(b.offset.y) <= a.size.y * sine;
    let inside = holds(body_a.size, offset_b + rotation_b * furthest.b)
        || holds(body_b.size, transpose(rotation_b) * (furthest.a - offset_b));
    let depth = -largest_gap.gap;
    largest_gap.is_exact = depth < 0.0 || (!circles_cross(a, b, cosine, sine, depth) && (axes_pass || inside));
    return largest_gap;
}
