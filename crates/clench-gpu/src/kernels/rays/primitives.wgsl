// The first hits of rays on primitive shapes, in the frame of the shape. CPU counterpart: `clench-collide/src/shape/`.
// A ray that begins inside hits where it leaves, and normals point out of the shape.

// The distance of a ray that hits nothing.
const NOWHERE: f32 = 1e30;

// The distance along a ray, and the outward unit normal there.
struct Hit {
    distance: f32,
    normal: vec3f,
}

// Returns the normal at a point of a surface, where a ray passes outwards along `outwards`.
fn normal_at(kind: u32, size: vec3f, p: vec3f, outwards: vec3f) -> vec3f {
    switch kind {
        case CAPSULE: {
            return direction(vec3f(p.xy, p.z - clamp(p.z, -size.y, size.y))).xyz;
        }
        case ELLIPSOID: {
            return direction(p / size / size).xyz;
        }
        // On the nearer of cap and side.
        case CYLINDER: {
            if (size.y - abs(p.z) < size.x - length(p.xy)) {
                return vec3f(0.0, 0.0, sign(outwards.z));
            }
            return direction(vec3f(p.xy, 0.0)).xyz;
        }
        // On the nearest face.
        case BOX: {
            let depth = size - abs(p);
            let nearest = min(depth.x, min(depth.y, depth.z));
            if (depth.x == nearest) {
                return vec3f(sign(outwards.x), 0.0, 0.0);
            }
            if (depth.y == nearest) {
                return vec3f(0.0, sign(outwards.y), 0.0);
            }
            return vec3f(0.0, 0.0, sign(outwards.z));
        }
        case SPHERE, PLANE, HEIGHT_FIELD, MESH, default: {
            return direction(p).xyz;
        }
    }
}

// Hits a plane from above, within the rectangle of positive sizes.
fn hit_plane(size: vec3f, line: Line) -> Hit {
    let down = line.along.z < 0.0;
    let distance = -line.origin.z / select(f32(1.0), line.along.z, down);
    let p = abs(line.origin + line.along * distance).xy;
    let within = down && distance >= 0.0 && all((size.xy <= vec2f()) | (p <= size.xy));
    return Hit(select(NOWHERE, distance, within), vec3f(0.0, 0.0, 1.0));
}

fn hit_solid(kind: u32, size: vec3f, line: Line) -> Hit {
    let t = within_shape(kind, size, line.origin, line.along);
    if (!is_hit(t)) {
        return Hit(NOWHERE, vec3f());
    }
    let outside = t.x >= 0.0;
    let distance = select(t.y, t.x, outside);
    let outwards = select(line.along, -line.along, outside);
    return Hit(distance, normal_at(kind, size, line.origin + line.along * distance, outwards));
}
