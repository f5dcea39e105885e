// Two convex bodies in the frame of the first, and the gap between their cores along a direction. CPU counterpart:
// `clench-collide/src/narrow/convex/pair.rs`.

var<private> body_a: Body;
var<private> body_b: Body;
// The axes of the second as columns, and its origin.
var<private> rotation_b: mat3x3f;
var<private> offset_b: vec3f;
// The smaller of the bodies' sizes, a bound on all coordinates, and the tolerance of the gap.
var<private> smallest: f32;
var<private> largest: f32;
var<private> exactness: f32;

// A point of the difference of the cores, from the first to the second, and its two points: on the first in its frame,
// on the second in its own.
struct Vertex {
    w: vec3f,
    a: vec3f,
    b: vec3f,
}

// A direction, the gap along it, and whether it is a local maximum with an exact direction.
struct Gap {
    normal: vec3f,
    gap: f32,
    is_exact: bool,
}

// The largest gap found so far.
var<private> best: Gap;

fn begin_pair(a: Body, b: Body, rotation: mat3x3f, offset: vec3f) {
    body_a = a;
    body_b = b;
    rotation_b = rotation;
    offset_b = offset;
    smallest = min(a.reach, b.reach);
    largest = a.reach + b.reach + abs(offset.x) + abs(offset.y) + abs(offset.z);
    exactness = max(largest * EPSILON * 64.0, smallest * 1e-9);
}

// Returns the direction between nearby points of the cores.
fn start_direction() -> vec3f {
    let p = nearest_of_body(body_a, offset_b);
    let q = offset_b + rotation_b * nearest_of_body(body_b, transpose(rotation_b) * (p - offset_b));
    let apart = direction(q - p);
    if (apart.w > 0.0) {
        return apart.xyz;
    }
    return direction(offset_b).xyz;
}

// Returns the vertex along `n`, a direction of any length; among ties, the one furthest against `side`.
fn vertex_against(n: vec3f, side: vec3f) -> Vertex {
    let back = transpose(rotation_b);
    var points = array<vec3f, 2>();
    // One call site, because the text of a support function is long with hulls.
    for (var k = 0u; k < bound(2u); k++) {
        var body = body_a;
        var along = n;
        var beside = side;
        if (k == 1u) {
            body = body_b;
            along = -(back * n);
            beside = -(back * side);
        }
        points[k] = support(body, along, beside);
    }
    return Vertex(offset_b + rotation_b * points[1] - points[0], points[0], points[1]);
}

fn vertex_along(n: vec3f) -> Vertex {
    return vertex_against(n, n);
}

// Takes the other gap if it is larger; among equals, to the tolerance, an exact one. Returns true if it did.
fn improve(other: Gap) -> bool {
    var handicap: f32 = 0.0;
    if (best.is_exact != other.is_exact) {
        handicap = select(-exactness, exactness, best.is_exact);
    }
    if (other.gap > best.gap + handicap) {
        best = other;
        return true;
    }
    return false;
}

// Two unit vectors perpendicular to a unit vector (Duff et al. 2017).
struct Across {
    e: vec3f,
    f: vec3f,
}

fn across(n: vec3f) -> Across {
    let sign = signed(1.0, n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    return Across(
        vec3f(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        vec3f(b, sign + n.y * n.y * a, -n.y),
    );
}
