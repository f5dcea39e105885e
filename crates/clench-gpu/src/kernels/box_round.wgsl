// Sphere–box, and capsule–box as up to two balls on the capsule's axis. CPU counterpart:
// `clench-collide/src/narrow/box_round.rs`, which explains the cases. Vectors are in the box's frame.

// Returns the normal out of a ball whose centre is inside the box, through the nearest face, and that face's distance.
fn nearest_face(center: vec3f, size: vec3f) -> vec4f {
    var best = vec4f(0.0, 0.0, 0.0, 3e38);
    for (var k = 0u; k < bound(6u); k++) {
        let axis = k >> 1u;
        let inward = select(f32(1.0), f32(-1.0), (k & 1u) == 1u);
        let gap = abs(size[axis] + inward * center[axis]);
        if (gap < best.w) {
            best = vec4f(0.0, 0.0, 0.0, gap);
            best[axis] = inward;
        }
    }
    return best;
}

// Adds the contact of a ball with the box `b`; `center` is in the box's frame.
fn ball_box(pair: u32, center: vec3f, radius: f32, b: Placed, range: f32) {
    let offset = clamp(center, -b.size, b.size) - center;
    let apart = length(offset);
    if (apart > radius + range) {
        return;
    }
    var normal = offset / max(apart, TINY);
    var gap = apart - radius;
    if (apart <= TINY) {
        let face = nearest_face(center, b.size);
        normal = face.xyz;
        gap = -face.w - radius;
    }
    if (gap > range) {
        return;
    }
    let position = center + normal * (radius + gap * 0.5);
    let world = b.axes * normal;
    add_contact(pair, gap, b.center + b.axes * position, world, tangent_from_normal(world));
}

fn sphere_box(pair: u32, a: Placed, b: Placed, range: f32) {
    ball_box(pair, transpose(b.axes) * (a.center - b.center), a.size.x, b, range);
}

// Returns true if a segment, center + x half with x in [−1, 1], intersects the box.
fn segment_enters(center: vec3f, half: vec3f, size: vec3f) -> bool {
    var low: f32 = -1.0;
    var high: f32 = 1.0;
    for (var i = 0u; i < bound(3u); i++) {
        if (abs(half[i]) < TINY) {
            if (abs(center[i]) > size[i]) {
                return false;
            }
            continue;
        }
        let middle = -center[i] / half[i];
        let reach = size[i] / abs(half[i]);
        low = max(low, middle - reach);
        high = min(high, middle + reach);
    }
    return low <= high;
}

// The point of a capsule's middle segment nearest to a box: its parameter, the point of the box, the axes along which
// that is at its limit (a bit each), and the squared distance.
struct NearestOfBox {
    along: f32,
    point: vec3f,
    limit: u32,
    squared: f32,
}

fn axes_mask(x: bool, y: bool, z: bool) -> u32 {
    return select(0u, 1u, x) | select(0u, 2u, y) | select(0u, 4u, z);
}

// Tries the edge along `axis` through one of the four corners across it: nearest points of two segments, by alternate
// clamping.
fn try_edge(best: ptr<function, NearestOfBox>, center: vec3f, half: vec3f, size: vec3f, axis: u32, corner: u32) {
    var middle = vec3f();
    middle[(axis + 1u) % 3u] = select(f32(-1.0), f32(1.0), (corner & 1u) != 0u) * size[(axis + 1u) % 3u];
    middle[(axis + 2u) % 3u] = select(f32(-1.0), f32(1.0), (corner & 2u) != 0u) * size[(axis + 2u) % 3u];
    let offset = middle - center;
    let edge_squared = size[axis] * size[axis];
    let mixed = -size[axis] * half[axis];
    let half_squared = dot(half, half);
    let edge_side = -size[axis] * offset[axis];
    let half_side = dot(half, offset);
    let determinant = edge_squared * half_squared - mixed * mixed;
    // Parallel edges are covered by the segment's ends and the edges across.
    if (abs(determinant) < 1e-15) {
        return;
    }
    let free_y = (half_squared * edge_side - mixed * half_side) / determinant;
    var y = clamp(free_y, -1.0, 1.0);
    var free_x = (half_side - mixed * y) / half_squared;
    if (free_y == y) {
        free_x = (edge_squared * half_side - mixed * edge_side) / determinant;
    }
    let x = clamp(free_x, -1.0, 1.0);
    var at_corner = free_y != y;
    var met = y;
    if (free_x != x) {
        let free_again = (edge_side - mixed * x) / edge_squared;
        y = clamp(free_again, -1.0, 1.0);
        if (free_again != y) {
            at_corner = true;
            met = y;
        }
    }
    var point = middle;
    point[axis] = size[axis] * y;
    let apart = point - center - half * x;
    let squared = dot(apart, apart);
    if (squared < (*best).squared - 1e-15) {
        if (at_corner) {
            point[axis] = size[axis] * met;
        }
        let own = select(0u, 1u << axis, at_corner);
        *best = NearestOfBox(x, point, (7u & ~(1u << axis)) | own, squared);
    }
}

// Finds the nearest points: an end of the segment to a face or the inside of the box, or a point of it to an edge.
fn nearest_of_box(center: vec3f, half: vec3f, size: vec3f) -> NearestOfBox {
    var best = NearestOfBox(0.0, vec3f(), 0u, 3e38);
    for (var k = 0u; k < bound(2u); k++) {
        let along = select(f32(-1.0), f32(1.0), k == 1u);
        let end = center + half * along;
        let point = clamp(end, -size, size);
        let limit = axes_mask(abs(end.x) > size.x, abs(end.y) > size.y, abs(end.z) > size.z);
        let squared = dot(point - end, point - end);
        if (countOneBits(limit) < 2u && squared < best.squared) {
            best = NearestOfBox(along, point, limit, squared);
        }
    }
    for (var k = 0u; k < bound(12u); k++) {
        try_edge(&best, center, half, size, k >> 2u, k & 3u);
    }
    return best;
}

fn in_mask(mask: u32, i: u32) -> bool {
    return ((mask >> i) & 1u) == 1u;
}

fn sign_of(mask: u32, i: u32) -> f32 {
    return select(f32(-1.0), f32(1.0), in_mask(mask, i));
}

// The direction of the second ball along the capsule (0: none), and the sides of the box that limit it, a bit each.
struct SecondContact {
    sense: f32,
    walls: u32,
}

fn choose_second(nearest: NearestOfBox, half: vec3f) -> SecondContact {
    let limit = nearest.limit;
    let inward = axes_mask(
        (half.x > 0.0) != (nearest.point.x > 0.0),
        (half.y > 0.0) != (nearest.point.y > 0.0),
        (half.z > 0.0) != (nearest.point.z > 0.0),
    );
    var second = SecondContact(0.0, 0u);
    for (var i = 0u; i < bound(3u); i++) {
        let j = (i + 1u) % 3u;
        let k = (i + 2u) % 3u;
        let differs_j = in_mask(inward, i) != in_mask(inward, j);
        let differs_k = in_mask(inward, i) != in_mask(inward, k);
        if (limit == 1u << i) {
            // An end above face i: towards the other end, within the face.
            second = SecondContact(-nearest.along, 7u & ~(1u << i));
        } else if (limit == (7u & ~(1u << i)) && in_mask(inward, j) != in_mask(inward, k)) {
            // On an edge along i: over the flatter of its two faces.
            let over_j = abs(half[j]) <= abs(half[k]);
            second = SecondContact(sign_of(inward, select(j, k, over_j)), (1u << i) | (1u << select(j, k, over_j)));
        } else if (limit == 7u && differs_j && differs_k) {
            // At a corner where only axis i leads in the other direction: along the edge i, or else over the face
            // across it.
            if (half[i] * half[i] > 0.5 * dot(half, half)) {
                second = SecondContact(sign_of(inward, i), 1u << i);
            } else {
                second = SecondContact(-sign_of(inward, i), 7u & ~(1u << i));
            }
        }
    }
    return second;
}

// Returns the length until the capsule ends or leaves the box.
fn second_length(second: SecondContact, nearest: NearestOfBox, half: vec3f, size: vec3f) -> f32 {
    // A side parallel to the capsule, up to rounding, is no limit.
    let least = length(half) * (1e4 * EPSILON);
    var far = 1.0 - second.sense * nearest.along;
    for (var i = 0u; i < bound(3u); i++) {
        let step = second.sense * half[i];
        if (in_mask(second.walls, i) && abs(step) > least) {
            let exit = (select(size[i], -size[i], step < 0.0) - nearest.point[i]) / step;
            if (exit > 0.0) {
                far = min(far, exit);
            }
        }
    }
    return far;
}

// Adds the contacts. Returns false if the capsule's middle segment intersects the box: no ball on it then determines
// the penetration depth.
fn capsule_box(pair: u32, a: Placed, b: Placed, range: f32) -> bool {
    let back = transpose(b.axes);
    let center = back * (a.center - b.center);
    let half = (back * a.axes[2]) * a.size.y;
    let beyond = abs(center) - abs(half) - b.size;
    if (max(max(beyond.x, beyond.y), beyond.z) - a.size.x > range) {
        return true;
    }
    if (segment_enters(center, half, b.size)) {
        return false;
    }
    let nearest = nearest_of_box(center, half, b.size);
    let second = choose_second(nearest, half);
    let far = nearest.along + second.sense * second_length(second, nearest, half, b.size);
    for (var k = 0u; k < bound(2u); k++) {
        if (k == 0u || second.sense != 0.0) {
            let along = select(nearest.along, far, k == 1u);
            ball_box(pair, center + half * along, a.size.x, b, range);
        }
    }
    return true;
}
