// Box–box: separating axes, then the face of one box clipped to the face of the other, or two crossing edges. CPU
// counterparts: `clench-collide/src/narrow/box_box.rs` and `box_manifold.rs`, which explain the rules and their
// constants.

// The remaining work for a pair: none, contacts along `best`, or the general convex method.
const FOUND: u32 = 0u;
const ALONG_BEST: u32 = 1u;
const AS_CONVEX: u32 = 2u;

// An axis of largest separation: a face normal of box `owner`, or, if `owner` is 2, the cross product of one edge
// direction of each.
struct Separation {
    owner: u32,
    axis: u32,
    other: u32,
    distance: f32,
}

// Finds the best face normal; an owner above 2 means separate boxes. `rotation` holds the axes of the second box in the
// frame of the first.
fn best_face(rotation: mat3x3f, offset: vec3f, a: Placed, b: Placed, reach: f32) -> Separation {
    var largest = Separation(3u, 0u, 0u, -3e38);
    for (var k = 0u; k < bound(6u); k++) {
        let second = k >= 3u;
        let axis = k % 3u;
        var along = transpose(rotation)[axis];
        var extent = dot(abs(along), b.size) + a.size[axis];
        var apart = offset[axis];
        if (second) {
            along = rotation[axis];
            extent = dot(abs(along), a.size) + b.size[axis];
            apart = dot(along, offset);
        }
        let distance = abs(apart) - extent;
        if (distance > reach) {
            return Separation(3u, 0u, 0u, distance);
        }
        if (distance > largest.distance) {
            largest = Separation(select(0u, 1u, second), axis, 0u, distance);
        }
    }
    return largest;
}

// Finds an edge pair that is better than the best face, if any.
fn best_edges(face: Separation, rotation: mat3x3f, offset: vec3f, a: vec3f, b: vec3f, reach: f32) -> Separation {
    var largest = face;
    for (var k = 0u; k < bound(9u); k++) {
        let i = k / 3u;
        let j = k % 3u;
        let i1 = (i + 1u) % 3u;
        let i2 = (i + 2u) % 3u;
        let j1 = (j + 1u) % 3u;
        let j2 = (j + 2u) % 3u;
        let u = rotation[j][i1];
        let v = rotation[j][i2];
        let sine_squared = u * u + v * v;
        // Nearly parallel edges: their cross product is noise, and the faces cover the case.
        if (sine_squared < 0.5 * EPSILON) {
            continue;
        }
        let extent = a[i1] * abs(v) + a[i2] * abs(u) + b[j1] * abs(rotation[j2][i]) + b[j2] * abs(rotation[j1][i]);
        let distance = (abs(u * offset[i2] - v * offset[i1]) - extent) / sqrt(sine_squared);
        if (distance > reach) {
            return Separation(3u, 0u, 0u, distance);
        }
        if (distance - BOX_EDGE_BIAS * abs(distance) > largest.distance && distance > face.distance) {
            largest = Separation(2u, i, j, distance);
        }
    }
    return largest;
}

fn unit_axis(axis: u32) -> vec3f {
    var unit = vec3f();
    unit[axis] = 1.0;
    return unit;
}

// Fills the polygon with the corners of the other box's face most opposed to the owner's face: x and y in that face, z
// above it.
fn opposing_face(axis: u32, side: f32, size: vec3f, rotation: mat3x3f, offset: vec3f, other: vec3f) {
    let slope = transpose(rotation)[axis];
    var largest = 0u;
    for (var k = 1u; k < bound(3u); k++) {
        if (abs(slope[k]) > abs(slope[largest])) {
            largest = k;
        }
    }
    let facing = select(f32(1.0), f32(-1.0), side * slope[largest] > 0.0);
    let center = offset + rotation[largest] * (other[largest] * facing);
    let u = rotation[(largest + 1u) % 3u] * other[(largest + 1u) % 3u];
    let v = rotation[(largest + 2u) % 3u] * other[(largest + 2u) % 3u];
    polygon_count = 0u;
    for (var k = 0u; k < bound(4u); k++) {
        let p = center + u * select(f32(-1.0), f32(1.0), k == 0u || k == 3u) + v * select(f32(-1.0), f32(1.0), k < 2u);
        push_corner(vec3f(p[(axis + 1u) % 3u], p[(axis + 2u) % 3u], side * p[axis] - size[axis]));
    }
}

// Adds the corners of the opposing face clipped to the owner's, each midway between the two faces. Returns the least
// distance. `rotation` and `offset` are those of the other box in the owner's frame.
fn face_contacts(pair: u32, axis: u32, owner: Placed, other: Placed, rotation: mat3x3f, offset: vec3f, out: f32, range: f32) -> f32 {
    let x = (axis + 1u) % 3u;
    let y = (axis + 2u) % 3u;
    let size = owner.size;
    let side = signed(1.0, offset[axis]);
    opposing_face(axis, side, size, rotation, offset, other.size);
    for (var k = 0u; k < bound(4u); k++) {
        let sign = select(f32(1.0), f32(-1.0), (k & 1u) == 1u);
        clip_polygon(select(vec2f(0.0, sign), vec2f(sign, 0.0), k < 2u), select(size[y], size[x], k < 2u));
    }
    let normal = owner.axes[axis] * (side * out);
    let tangent = tangent_from_normal(normal);
    let radius: f32 = max(1e-7, 100.0 * EPSILON);
    let apart = radius * radius * (size[x] * size[x] + size[y] * size[y]);
    var least: f32 = 3e38;
    var accepted = 0u;
    for (var k = 0u; k < polygon_count; k++) {
        let p = polygon_corner(k);
        var twin = p.z > range || accepted == 8u;
        for (var other_corner = 0u; other_corner < accepted; other_corner++) {
            let between_them = polygon_corner(other_corner).xy - p.xy;
            twin = twin || dot(between_them, between_them) < apart;
        }
        if (twin) {
            continue;
        }
        polygon[polygon_begin + accepted] = p;
        accepted++;
        var local = vec3f();
        local[x] = p.x;
        local[y] = p.y;
        local[axis] = side * (size[axis] + 0.5 * p.z);
        add_contact(pair, p.z, owner.center + owner.axes * local, normal, tangent);
        least = min(least, p.z);
    }
    return least;
}

fn box_box(pair: u32, a: Placed, b: Placed, range: f32) -> u32 {
    let rotation = transpose(a.axes) * b.axes;
    let offset = transpose(a.axes) * (b.center - a.center);
    let slack = max(1e-13, 8.0 * EPSILON) * (a.size.x + a.size.y + a.size.z + b.size.x + b.size.y + b.size.z);
    let face = best_face(rotation, offset, a, b, range + slack);
    if (face.owner == 3u) {
        return FOUND;
    }
    var largest = best_edges(face, rotation, offset, a.size, b.size, range + slack);
    if (largest.owner == 3u) {
        return FOUND;
    }
    if (largest.owner == 2u) {
        let n = direction(cross(unit_axis(largest.axis), rotation[largest.other])).xyz;
        var along_face = abs(n[face.axis]);
        if (face.owner == 1u) {
            along_face = abs(dot(rotation[face.axis], n));
        }
        let share = BOX_ALIAS_SHARE * abs(face.distance) + 1e-15;
        if (along_face > BOX_ALIAS_COSINE && largest.distance < face.distance + share) {
            largest = face;
        } else {
            best = Gap(n * signed(1.0, dot(n, offset)), largest.distance, true);
            return select(AS_CONVEX, ALONG_BEST, largest.distance <= 0.0);
        }
    }
    var owner = a;
    var other = b;
    var owner_rotation = rotation;
    var owner_offset = offset;
    if (largest.owner == 1u) {
        owner = b;
        other = a;
        owner_rotation = transpose(rotation);
        owner_offset = transpose(b.axes) * (a.center - b.center);
    }
    let before = found;
    let least = face_contacts(pair, largest.axis, owner, other, owner_rotation, owner_offset, select(f32(1.0), f32(-1.0), largest.owner == 1u), range);
    if (largest.distance <= 0.0 || least <= largest.distance + slack) {
        return FOUND;
    }
    found = before;
    return AS_CONVEX;
}
