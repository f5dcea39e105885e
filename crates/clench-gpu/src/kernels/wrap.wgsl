// The shortest string between two points around, or through, a sphere or an infinite cylinder. CPU counterpart:
// `dynamics/wrap.rs`, which derives it. In the plane across the cylinder's axis, or through the sphere's centre and
// both ends, points have two coordinates.

// Newton's method for a reflection: the tolerance of the sum of angles, and the maximum number of steps.
const REFLECTION_TOLERANCE: f32 = max(1e-6, 16.0 * EPSILON);
const REFLECTION_STEPS: u32 = 20u;

// True if a string touches its obstacle; the first and last point of contact, and its length between them.
struct Wrapped {
    touches: bool,
    first: vec3f,
    last: vec3f,
    length: f32,
}

// The same in the plane.
struct PlanarWrap {
    touches: bool,
    first: vec2f,
    last: vec2f,
    arc: f32,
}

fn planar_cross(a: vec2f, b: vec2f) -> f32 {
    return a.x * b.y - a.y * b.x;
}

// Returns the angle from one point to another seen from the origin, in [−π, π].
fn planar_angle(a: vec2f, b: vec2f) -> f32 {
    let area = planar_cross(a, b);
    let angle = angle_of(abs(area), dot(a, b));
    return select(angle, -angle, area < 0.0);
}

// Returns `a` times the vector plus `b` times the vector rotated by a quarter turn.
fn turned(v: vec2f, a: f32, b: f32) -> vec2f {
    return v * a + vec2f(-v.y, v.x) * b;
}

fn planar_unit(v: vec2f) -> vec2f {
    let norm = length(v);
    if (norm < TINY) {
        return vec2f(1.0, 0.0);
    }
    return v * (1.0 / norm);
}

// Returns two axes of the plane through the origin and both points, the first towards the first point. If all three are
// collinear, it is the plane that MuJoCo chooses.
fn plane_through(p: vec3f, q: vec3f) -> mat2x3f {
    let axis = direction(p).xyz;
    let normal = direction(cross(p, q));
    let size = abs(axis);
    var other = vec3f(0.0, 1.0, 1.0);
    if (size.y > size.x && size.y > size.z) {
        other = vec3f(1.0, 0.0, 1.0);
    } else if (size.z > size.x && size.z > size.y) {
        other = vec3f(1.0, 1.0, 0.0);
    }
    let across = select(normal.xyz, direction(cross(axis, other)).xyz, normal.w < TINY);
    return mat2x3f(axis, direction(cross(across, axis)).xyz);
}

// Finds the shortest string around a circle that turns by the angle `rotation`.
fn wrap_circle(p: vec2f, q: vec2f, rotation: f32, radius: f32) -> PlanarWrap {
    let square = radius * radius;
    let squares = vec2f(dot(p, p), dot(q, q));
    let tangents = sqrt(max(squares - square, vec2f()));
    let arc = abs(rotation) - angle_of(tangents.x, radius) - angle_of(tangents.y, radius);
    let touches = all(squares >= vec2f(square)) && radius >= TINY && dot(q - p, q - p) >= TINY && arc > 0.0;
    if (!touches) {
        return PlanarWrap(false, p, q, 0.0);
    }
    let across = tangents * (select(radius, -radius, rotation < 0.0) / squares);
    let along = square / squares;
    return PlanarWrap(true, turned(p, along.x, across.x), turned(q, along.y, -across.y), radius * arc);
}

// Returns true if the interior of the segment reaches the circle.
fn intersects_circle(p: vec2f, q: vec2f, radius: f32) -> bool {
    let along = q - p;
    let square = dot(along, along);
    let share = -dot(along, p) / max(square, TINY);
    return square > TINY && share > 0.0 && share < 1.0 && length(p + along * share) <= radius;
}

// Returns the arc sine of a number in [0, 1].
fn arc_sine(x: f32) -> f32 {
    return angle_of(x, sqrt(max(1.0 - x * x, 0.0)));
}

// Returns the angle of incidence of a string that is reflected by the circle, and whether it was found (1).
fn reflect_string(ratios: vec2f, angle: f32) -> vec2f {
    var beta: f32 = HALF_PI;
    if (angle < TINY) {
        return vec2f(beta, 0.0);
    }
    for (var k = 0u; k <= bound(REFLECTION_STEPS); k++) {
        let rotation = sin_cos(beta);
        let a = ratios * rotation.x;
        let value = arc_sine(a.x) + arc_sine(a.y) - 2.0 * beta + angle;
        if (k == 0u && value > 0.0) {
            break;
        }
        if (abs(value) <= REFLECTION_TOLERANCE) {
            return vec2f(beta, 1.0);
        }
        let slopes = ratios * rotation.y / sqrt(max(vec2f(1.0) - a * a, vec2f(TINY)));
        let next = beta - value / (slopes.x + slopes.y - 2.0);
        if (next > beta) {
            break;
        }
        beta = next;
    }
    return vec2f(beta, 0.0);
}

// Finds the string that passes through the circle, straight if that already does.
fn through(p: vec2f, q: vec2f, radius: f32) -> PlanarWrap {
    let distances = vec2f(length(p), length(q));
    if (any(distances <= vec2f(radius)) || radius < TINY || intersects_circle(p, q, radius)) {
        return PlanarWrap(false, p, q, 0.0);
    }
    let ratios = radius / distances;
    let area = planar_cross(p, q);
    let found = reflect_string(ratios, angle_of(abs(area), dot(p, q)));
    var point = planar_unit(p + q);
    if (found.y == 1.0) {
        // From the end that comes first in the sense of rotation.
        let ascending = area > 0.0;
        let ratio = select(ratios.y, ratios.x, ascending);
        let rotation = sin_cos(found.x - arc_sine(ratio * sin_cos(found.x).x));
        point = turned(planar_unit(select(q, p, ascending)), rotation.y, rotation.x);
    }
    return PlanarWrap(true, point * radius, point * radius, 0.0);
}

// Finds the string between the points `p` and `q` with a geom as obstacle; `side` is the site that it passes, or NONE.
fn wrap(p: vec3f, q: vec3f, geom: u32, side: u32) -> Wrapped {
    let center = fetch3(GEOM_XPOS + 3u * geom);
    let axes = fetch_matrix(GEOM_XMAT + 9u * geom);
    let radius = parameter(GEOM_SIZE + 3u * geom);
    let is_cylinder = words[GEOM_KIND + geom] == CYLINDER;
    let start = transpose(axes) * (p - center);
    let end = transpose(axes) * (q - center);
    var plane = mat2x3f(1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    if (!is_cylinder) {
        plane = plane_through(start, end);
    }
    let flat_start = start * plane;
    let flat_end = end * plane;
    var found = PlanarWrap(false, flat_start, flat_end, 0.0);
    var rotation = planar_angle(flat_start, flat_end);
    var inside = false;
    if (side != NONE) {
        let by = transpose(axes) * (fetch3(SITE_XPOS + 3u * side) - center);
        inside = length(by) < radius;
        let toward = planar_unit(by * plane);
        rotation = planar_angle(flat_start, toward) + planar_angle(toward, flat_end);
    }
    if (inside) {
        found = through(flat_start, flat_end, radius);
    } else {
        found = wrap_circle(flat_start, flat_end, rotation, radius);
    }
    var heights = vec2f();
    if (is_cylinder) {
        // Unrolled, the string is straight.
        let before = length(found.first - flat_start);
        let until = before + found.arc;
        let slope = (end.z - start.z) / max(until + length(found.last - flat_end), TINY);
        heights = start.z + slope * vec2f(before, until);
    }
    let first = plane * found.first + vec3f(0.0, 0.0, heights.x);
    let last = plane * found.last + vec3f(0.0, 0.0, heights.y);
    let touches = found.touches && length(start) >= TINY && length(end) >= TINY;
    let on_surface = length(vec2f(found.arc, heights.y - heights.x));
    return Wrapped(touches, center + axes * first, center + axes * last, on_surface);
}

// A straight part of a string between points of two bodies.
struct Span {
    bodies: vec2u,
    first: vec3f,
    last: vec3f,
}

// Returns the path of the string of a section from site to site.
fn section_path(s: u32) -> Wrapped {
    let p = fetch3(SITE_XPOS + 3u * words[SECTION_SITES + 2u * s]);
    let q = fetch3(SITE_XPOS + 3u * words[SECTION_SITES + 2u * s + 1u]);
    let obstacle = words[SECTION_OBSTACLE + 2u * s];
    if (ANY_OBSTACLE && obstacle != NONE) {
        return wrap(p, q, obstacle, words[SECTION_OBSTACLE + 2u * s + 1u]);
    }
    return Wrapped(false, p, q, 0.0);
}

// Returns the number of spans: one for a straight string, two for one that touches a geom.
fn span_count(path: Wrapped) -> u32 {
    return select(1u, 2u, path.touches);
}

fn span_of(s: u32, path: Wrapped, k: u32) -> Span {
    let start = words[SECTION_SITES + 2u * s];
    let to = words[SECTION_SITES + 2u * s + 1u];
    var span = Span(vec2u(words[SITE_BODY + start], words[SITE_BODY + to]), fetch3(SITE_XPOS + 3u * start), fetch3(SITE_XPOS + 3u * to));
    if (path.touches && k == 0u) {
        span.bodies.y = words[GEOM_BODY + words[SECTION_OBSTACLE + 2u * s]];
        span.last = path.first;
    } else if (path.touches) {
        span.bodies.x = words[GEOM_BODY + words[SECTION_OBSTACLE + 2u * s]];
        span.first = path.last;
    }
    return span;
}
