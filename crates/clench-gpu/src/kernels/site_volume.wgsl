// Volumes of sites: tests of points and rays. CPU counterpart: `sensor/volume.rs`; the rays are those of
// `clench-collide`.

fn is_in_volume(kind: u32, size: vec3f, p: vec3f) -> bool {
    let level = dot(p.xy, p.xy);
    switch kind {
        case SPHERE: {
            return dot(p, p) <= size.x * size.x;
        }
        case CAPSULE: {
            let end = max(abs(p.z) - size.y, 0.0);
            return level + end * end <= size.x * size.x;
        }
        case ELLIPSOID: {
            let scaled = p / size;
            return dot(scaled, scaled) <= 1.0;
        }
        case CYLINDER: {
            return level <= size.x * size.x && abs(p.z) <= size.y;
        }
        case BOX: {
            return all(abs(p) <= size);
        }
        case PLANE, HEIGHT_FIELD, MESH, default: {
            return false;
        }
    }
}

// Returns true if a ray intersects a volume.
fn intersects_volume(kind: u32, size: vec3f, o: vec3f, d: vec3f) -> bool {
    return is_hit(within_shape(kind, size, o, d));
}
