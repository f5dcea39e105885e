// The largest gap of a cylinder and a polyhedron with few faces, which overlap or are separated by the direction found.
// CPU counterparts: `clench-collide/src/narrow/convex/cylinder_polyhedron.rs`, which derives the candidate directions,
// and `ellipse.rs`.

// A cylinder in the frame of a polyhedron.
struct Cylinder {
    axis: vec3f,
    center: vec3f,
    size: vec3f,
}

// The distance by which a cylinder must move to leave across a face, and its point furthest against the face's normal,
// as the cross product of both.
struct Crossed {
    depth: f32,
    moment: vec3f,
}

// The largest gap so far, from the cylinder to the polyhedron, and the value that the gap along another direction must
// exceed.
var<private> largest_gap: Gap;
var<private> bar: f32;

// An edge between two faces: a point of it, its direction, their cross product, the faces, the cosine and sine of the
// angle between their normals.
struct Crease {
    start: vec3f,
    edge: vec3f,
    moment: vec3f,
    faces: vec2u,
    rotation: vec2f,
}

// True if the polyhedron is a box: its half sizes scale that of half sizes 1. Others are not scaled.
var<private> is_box: bool;
var<private> box_scale: vec3f;

// A polyhedron is a hull, a box, or, if `hull` is NONE, the ground below a terrain triangle, which is the first body.
fn is_ground(hull: u32) -> bool {
    return ANY_TERRAIN && hull == NONE;
}

fn vertices_of(hull: u32) -> u32 {
    if (is_ground(hull)) {
        return 6u;
    }
    return words[hull + HULL_VERTEX_COUNT];
}

fn vertex_of(hull: u32, k: u32) -> vec3f {
    if (is_ground(hull)) {
        return prism[k];
    }
    return vertex_of_hull(hull, k) * box_scale;
}

fn faces_of(hull: u32) -> u32 {
    if (is_ground(hull)) {
        return PRISM_FACES;
    }
    return words[hull + HULL_FACE_COUNT];
}

fn plane_of(hull: u32, face: u32) -> vec4f {
    if (is_ground(hull)) {
        return plane_of_prism(face);
    }
    let plane = plane_of_hull(hull, face);
    // The normals of a box are along its axes.
    return vec4f(plane.xyz, plane.w * select(1.0, dot(abs(plane.xyz), box_scale), is_box));
}

fn creases_of(hull: u32) -> u32 {
    if (is_ground(hull)) {
        return PRISM_EDGES;
    }
    return words[hull + HULL_CREASE_COUNT];
}

fn crease_of(hull: u32, k: u32) -> Crease {
    if (is_ground(hull)) {
        let edge = edge_of_prism(k);
        let start = prism[edge.x];
        let along = direction(prism[edge.y] - start).xyz;
        let cosine = dot(plane_of_prism(edge.z).xyz, plane_of_prism(edge.w).xyz);
        let rotation = vec2f(cosine, sqrt(max(1.0 - cosine * cosine, 0.0)));
        return Crease(start, along, cross(start, along), edge.zw, rotation);
    }
    let offset = words[hull + HULL_CREASES] + 8u * k;
    let start = shape3(offset) * box_scale;
    let along = shape3(offset + 3u);
    let faces = words[hull + HULL_CREASE_FACES] + 2u * k;
    let rotation = vec2f(numbers[offset + 6u], numbers[offset + 7u]);
    return Crease(start, along, cross(start, along), vec2u(words[faces], words[faces + 1u]), rotation);
}

fn has_creases(a: Body, b: Body) -> bool {
    if (ANY_TERRAIN && a.kind == PRISM) {
        return b.kind == CYLINDER;
    }
    return a.kind == CYLINDER && b.hull != NONE && words[b.hull + HULL_CREASE_COUNT] > 0u;
}

fn offer(gap: f32, normal: vec3f) {
    if (gap > bar) {
        largest_gap = Gap(normal, gap, true);
        bar = gap + exactness;
    }
}

fn cross_face(c: Cylinder, plane: vec4f) -> Crossed {
    let along = dot(c.axis, plane.xyz);
    let sideways = cross(c.axis, plane.xyz);
    let level = length(sideways);
    let reach = c.size.x * level + c.size.y * abs(along);
    let arm = c.size.x * along / max(level, SMALLEST) - signed(c.size.y, along);
    return Crossed(reach + plane.w - dot(plane.xyz, c.center), cross(c.center, plane.xyz) + sideways * arm);
}

// Tests the caps, and the side at the corner nearest to the axis.
fn offer_corners(c: Cylinder, hull: u32) {
    let count = vertices_of(hull);
    var low = UNMOVABLE;
    var high = -UNMOVABLE;
    var least = UNMOVABLE;
    var corner = vec3f();
    for (var k = 0u; k < count; k++) {
        let arm = vertex_of(hull, k) - c.center;
        let along = dot(c.axis, arm);
        low = min(low, along);
        high = max(high, along);
        let square = dot(arm, arm) - along * along;
        if (square < least) {
            least = square;
            corner = arm;
        }
    }
    offer(low - c.size.y, c.axis);
    offer(-high - c.size.y, -c.axis);
    let away = direction(cross(cross(c.axis, corner), c.axis));
    var normal = away.xyz;
    if (away.w <= TINY) {
        // A corner on the axis is equally far from all of the side.
        normal = across(c.axis).e;
    }
    if (away.w - c.size.x > largest_gap.gap) {
        var nearest = UNMOVABLE;
        for (var k = 0u; k < count; k++) {
            nearest = min(nearest, dot(normal, vertex_of(hull, k)));
        }
        offer(nearest - dot(normal, c.center) - c.size.x, normal);
    }
}

// Returns the unit normal of an ellipse, in its first quadrant, through a point with x ≥ 0 and with a locally largest
// gap; zero if there is none. The ellipse is a tilted circle of radius 1.
fn ellipse_normal(cosine: f32, sine: f32, p: vec2f) -> vec2f {
    let square = sine * sine;
    let height = cosine * p.y;
    var at = vec2f(p.x, square + height);
    for (var step = 0u; step < bound(ELLIPSE_STEPS); step++) {
        if (at.y <= 0.0) {
            return vec2f();
        }
        at = at / length(at);
        let value = square * at.y * at.x - p.x * at.y + height * at.x;
        let fall = p.x * at.x + height * at.y - square * (at.x * at.x - at.y * at.y);
        if (fall <= 0.0) {
            return vec2f();
        }
        let rotation = at.x * at.x * cosine * cosine + at.y * at.y;
        at = vec2f(at.x * fall - at.y * value, at.y * fall + at.x * value);
        if (value * value <= fall * fall * rotation * EPSILON) {
            break;
        }
    }
    return normalize(vec2f(cosine * at.x, at.y));
}

// Tests an edge against the side and the cap circles, along directions that do not point out of either of its faces,
// whose normals are m and n.
fn offer_edge(c: Cylinder, start: vec3f, edge: vec3f, m: vec3f, n: vec3f) {
    let crossed = cross(edge, c.axis);
    let cosine = abs(dot(edge, c.axis));
    let sine = length(crossed);
    if (sine <= EPSILON) {
        return;
    }
    let sideways = crossed / sine;
    let within_m = cross(m, edge);
    let within_n = cross(edge, n);
    let arm = start - c.center;
    // In the view along the edge, with x across the axis, the edge has positive x.
    let side = signed(1.0, dot(sideways, arm));
    let x = abs(dot(sideways, arm));
    let out = vec2f(dot(sideways, within_m), dot(sideways, within_n)) * side;
    if (min(out.x, out.y) >= 0.0) {
        offer(x - c.size.x, sideways * side);
    } else if (max(out.x, out.y) <= 0.0) {
        offer(-x - c.size.x, sideways * -side);
    }
    if (cosine <= EPSILON || c.size.x <= 0.0) {
        return;
    }
    let along = cross(sideways, edge);
    let up = vec2f(dot(along, within_m), dot(along, within_n));
    for (var k = 0u; k < bound(2u); k++) {
        let sign = select(f32(-1.0), f32(1.0), k == 0u);
        if ((out.x < 0.0 && up.x * sign < 0.0) || (out.y < 0.0 && up.y * sign < 0.0)) {
            continue;
        }
        let found = ellipse_normal(cosine, sine, vec2f(x, dot(along, arm) * sign - c.size.y * sine) / c.size.x);
        let normal = sideways * (found.x * side) + along * (found.y * sign);
        if (any(found != vec2f()) && dot(normal, within_m) >= 0.0 && dot(normal, within_n) >= 0.0) {
            let reach = c.size.y * abs(dot(c.axis, normal)) + c.size.x * length(cross(c.axis, normal));
            offer(dot(normal, arm) - reach, normal);
        }
    }
}

// Returns false if the gap through an edge cannot be the largest between its faces with a depth of at most `depth`: the
// cylinder's contact with an adjacent face is too far within the edge.
fn may_touch_edge(within: f32, crossed: Crossed, rotation: vec2f, depth: f32) -> bool {
    return within * rotation.y <= depth - crossed.depth * rotation.x;
}

// Returns the largest gap of the pair's cylinder and polyhedron if it is not positive, else a positive one; any above
// `limit` suffices.
fn polyhedron_gap(limit: f32) -> Gap {
    var hull = body_b.hull;
    let back = transpose(rotation_b);
    var c = Cylinder(back * vec3f(0.0, 0.0, 1.0), -(back * offset_b), body_a.size);
    let ground = ANY_TERRAIN && body_a.kind == PRISM;
    if (ground) {
        hull = NONE;
        c = Cylinder(rotation_b[2], offset_b, body_b.size);
    }
    is_box = !ground && body_b.kind == BOX;
    box_scale = select(vec3f(1.0), body_b.size, is_box);
    largest_gap = Gap(vec3f(0.0, 0.0, 1.0), -UNMOVABLE, false);
    bar = -UNMOVABLE;
    for (var face = 0u; face < faces_of(hull) && largest_gap.gap <= limit; face++) {
        let plane = plane_of(hull, face);
        offer(-cross_face(c, plane).depth, -plane.xyz);
    }
    if (largest_gap.gap <= limit) {
        offer_corners(c, hull);
        for (var k = 0u; k < creases_of(hull); k++) {
            let crease = crease_of(hull, k);
            let m = plane_of(hull, crease.faces.x);
            let n = plane_of(hull, crease.faces.y);
            let across_m = cross_face(c, m);
            let across_n = cross_face(c, n);
            // The distances within the edge at which the cylinder touches each face.
            let within_m = dot(crease.edge, across_m.moment) + dot(m.xyz, crease.moment);
            let within_n = -dot(crease.edge, across_n.moment) - dot(n.xyz, crease.moment);
            let depth = max(-bar, 0.0);
            if (may_touch_edge(within_m, across_m, crease.rotation, depth) && may_touch_edge(within_n, across_n, crease.rotation, depth)) {
                offer_edge(c, crease.start, crease.edge, m.xyz, n.xyz);
            }
        }
    }
    if (ground) {
        return Gap(-largest_gap.normal, largest_gap.gap, true);
    }
    return Gap(rotation_b * largest_gap.normal, largest_gap.gap, true);
}
