// Where rays hit primitive shapes first, in the frame of the shape: sister of `clench-collide/src/shape/`. A ray that begins inside hits
// where it leaves, and normals point out of the shape.

// How far away a ray hits that hits nothing.
const NOWHERE: f32 = 1e30;

// How far along a ray, and the unit vector out of the shape there.
struct Hit {
    distance: f32,
    normal: vec3f,
}

// The normal at a point of a surface, where a ray passes outwards along `outwards`.
fn normal_at(kind: u32, size: vec3f, p: vec3f, outwards: vec3f) -> vec3f {
    switch kind {
        case CAPSULE: {
            return direction(vec3f(p.xy, p.z - clamp(p.z, -size.y, size.y))).xyz;
        }
        case ELLIPSOID: {
            return direction(p / size / size).xyz;
        }
        // On the cap or the side that is nearer.
        case CYLINDER: {
            if (size.y - abs(p.z) < size.x - length(p.xy)) {
                return vec3f(0.0, 0.0, sign(outwards.z));
            }
            return direction(vec3f(p.xy, 0.0)).xyz;
        }
        // On the face that is nearest.
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
        default: {
            return direction(p).xyz;
        }
    }
}

// From above, within the rectangle that positive sizes say.
fn hit_plane(size: vec3f, line: Line) -> Hit {
    let down = line.along.z < 0.0;
    let distance = -line.origin.z / select(f32(1.0), line.along.z, down);
    let p = abs(line.origin + line.along * distance).xy;
    let within = down && distance >= 0.0 && all((size.xy <= vec2f()) | (p <= size.xy));
    return Hit(select(NOWHERE, distance, within), vec3f(0.0, 0.0, 1.0));
}

fn hit_solid(kind: u32, size: vec3f, line: Line) -> Hit {
    let t = within_shape(kind, size, line.origin, line.along);
    if (!is_met(t)) {
        return Hit(NOWHERE, vec3f());
    }
    let outside = t.x >= 0.0;
    let distance = select(t.y, t.x, outside);
    let outwards = select(line.along, -line.along, outside);
    return Hit(distance, normal_at(kind, size, line.origin + line.along * distance, outwards));
}
