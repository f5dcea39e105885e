// Protrusion of objects from the volume of a site. CPU counterparts: `sensor/enclosed.rs`, and
// `clench-collide/src/protrusion.rs`, which explains the search. A solid is a row of SOLID_SIZE words.

// Less than any protrusion, m.
const LOWEST: f32 = -3e38;

// A solid with its pose, in world coordinates rotated to the axes of the outer one.
struct Solid {
    row: u32,
    size: vec3f,
    center: vec3f,
    axes: mat3x3f,
}

// Returns the k-th solid, in world coordinates.
fn solid(k: u32) -> Solid {
    let row = SOLIDS + SOLID_SIZE * k;
    let frame = words[row + SOLID_FRAME];
    let index = words[row + SOLID_INDEX];
    let place = words[row + SOLID_PLACE];
    let axes = object_axes(frame, index);
    let center = object_position(frame, index) + axes * shape3(place);
    return Solid(row, parameter3(SOLID_EXTENTS + 3u * k), center, axes * quat_matrix(shape4(place + 3u)));
}

fn toward(extent: f32, along: f32) -> f32 {
    return select(-extent, extent, along >= 0.0);
}

// Returns the point of a mesh that is furthest along a direction.
fn furthest_point(row: u32, d: vec3f) -> vec3f {
    var furthest = vec3f();
    var reach = LOWEST;
    for (var k = 0u; k < bound(words[row + SOLID_POINT_COUNT]); k++) {
        let point = shape3(words[row + SOLID_POINTS] + 3u * k);
        if (dot(point, d) > reach) {
            reach = dot(point, d);
            furthest = point;
        }
    }
    return furthest;
}

// Returns the point of a solid that is furthest along a unit direction, both in its coordinates.
fn furthest_of_shape(row: u32, size: vec3f, d: vec3f) -> vec3f {
    switch words[row + SOLID_KIND] {
        case SPHERE: {
            return d * size.x;
        }
        case CAPSULE: {
            return d * size.x + vec3f(0.0, 0.0, toward(size.y, d.z));
        }
        case ELLIPSOID: {
            let scaled = d * size;
            if (dot(scaled, scaled) < TINY * TINY) {
                return vec3f(size.x, 0.0, 0.0);
            }
            return scaled * (size / length(scaled));
        }
        case CYLINDER: {
            let across = dot(d.xy, d.xy);
            let share = select(0.0, size.x / sqrt(max(across, TINY * TINY)), across >= TINY * TINY);
            return vec3f(d.xy * share, toward(size.y, d.z));
        }
        case BOX: {
            return vec3f(toward(size.x, d.x), toward(size.y, d.y), toward(size.z, d.z));
        }
        case MESH: {
            return furthest_point(row, d);
        }
        case PLANE, HEIGHT_FIELD, default: {
            return vec3f();
        }
    }
}

fn furthest(s: Solid, u: vec3f) -> vec3f {
    return s.center + s.axes * furthest_of_shape(s.row, s.size, u * s.axes);
}

// Returns the largest value of f that a climb on the unit sphere finds.
fn climb(inner: Solid, outer: Solid, start: vec3f) -> f32 {
    var best = LOWEST;
    var summit = start;
    var along = vec3f();
    var u = start;
    var step: f32 = ASCENT_FIRST_STEP;
    for (var k = 0u; k < bound(ASCENT_STEPS); k++) {
        let gradient = furthest(inner, u) - furthest(outer, u);
        let value = dot(gradient, u);
        let slope = gradient - u * value;
        let steepness = length(slope);
        if (value > best) {
            best = value;
            summit = u;
            if (steepness <= TINY || steepness <= abs(value) * ASCENT_TOLERANCE) {
                break;
            }
            along = slope * (1.0 / steepness);
        } else {
            step *= 0.5;
            if (step < ASCENT_TOLERANCE) {
                break;
            }
            if (steepness > TINY) {
                along += slope * (1.0 / steepness);
            }
            along -= summit * dot(along, summit);
            let size = length(along);
            if (size <= ASCENT_TOLERANCE) {
                break;
            }
            along *= 1.0 / size;
        }
        let next = summit + along * step;
        if (all(next == summit)) {
            break;
        }
        u = next * (1.0 / length(next));
    }
    return best;
}

// Returns the largest protrusion of the solids between two rows from that of the first row.
fn protrusion(first: u32, end: u32) -> f32 {
    var outer = solid(first);
    let back = transpose(outer.axes);
    outer.center = back * outer.center;
    outer.axes = mat3x3f(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    var largest = LOWEST;
    for (var k = first + 1u; k < end; k++) {
        var inner = solid(k);
        inner.center = back * inner.center;
        inner.axes = back * inner.axes;
        for (var start = 0u; start < bound(6u); start++) {
            var u = vec3f();
            u[start / 2u] = select(f32(1.0), f32(-1.0), (start & 1u) == 1u);
            largest = max(largest, climb(inner, outer, u));
        }
    }
    return largest;
}
