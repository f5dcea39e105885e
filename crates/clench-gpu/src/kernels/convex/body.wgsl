// Convex bodies by their support functions, as a core plus a radius. CPU counterpart:
// `clench-collide/src/shape/core.rs`, which explains them.

struct Body {
    kind: u32,
    size: vec3f,
    // The radius of the ball added to the core.
    radius: f32,
    // The radius of a sphere about the origin that encloses the body.
    reach: f32,
    // The hull of a mesh.
    hull: u32,
}

fn body_of(geom: u32) -> Body {
    let kind = words[GEOM_KIND + geom];
    let size = parameter3(GEOM_SIZE + 3u * geom);
    let hull = words[GEOM_HULL + geom];
    let least = min(size.x, min(size.y, size.z));
    let largest = max(size.x, max(size.y, size.z));
    switch kind {
        case SPHERE: {
            return Body(kind, size, size.x, size.x, hull);
        }
        case CAPSULE: {
            return Body(kind, size, size.x, size.x + size.y, hull);
        }
        case ELLIPSOID: {
            return Body(kind, size, least * (least / max(largest, SMALLEST)), largest, hull);
        }
        case CYLINDER: {
            return Body(kind, size, 0.0, length(size.xy), hull);
        }
        case BOX, MESH, PLANE, HEIGHT_FIELD, PRISM, default: {
            return Body(kind, size, 0.0, length(size), hull);
        }
    }
}

fn is_curved(body: Body) -> bool {
    return body.kind == ELLIPSOID || body.kind == CYLINDER;
}

// Returns x with the sign of y.
fn signed(x: f32, y: f32) -> f32 {
    return select(x, -x, y < 0.0);
}

// Returns the unit direction of `d` projected across z; x if it vanishes.
fn radial_direction(d: vec3f) -> vec2f {
    let level = length(d.xy);
    if (level > SMALLEST) {
        return d.xy / level;
    }
    return vec2f(1.0, 0.0);
}

// Returns the point of the core furthest along `d`; among corners or ends that tie, the one further along `side`.
fn support(body: Body, d: vec3f, side: vec3f) -> vec3f {
    if (ANY_MESH && body.kind == MESH) {
        return vertex_of_hull(body.hull, furthest_of_hull(body.hull, side));
    }
    if (ANY_TERRAIN && body.kind == PRISM) {
        return prism[furthest_of_prism(side)];
    }
    return support_without_hull(body, d, side);
}

// Does the same for all but meshes and terrain.
fn support_without_hull(body: Body, d: vec3f, side: vec3f) -> vec3f {
    let s = body.size;
    switch body.kind {
        case CAPSULE: {
            return vec3f(0.0, 0.0, signed(s.y, side.z));
        }
        case ELLIPSOID: {
            let scaled = d * s;
            let unit = d / max(length(d), SMALLEST);
            return scaled * s / max(length(scaled), SMALLEST) - unit * body.radius;
        }
        case CYLINDER: {
            return vec3f(radial_direction(d) * s.x, signed(s.y, side.z));
        }
        case BOX: {
            return vec3f(signed(s.x, side.x), signed(s.y, side.y), signed(s.z, side.z));
        }
        case SPHERE, PLANE, HEIGHT_FIELD, MESH, PRISM, default: {
            return vec3f();
        }
    }
}

// Returns the point of the core nearest to a point, for the kinds defined by their size; else the origin.
fn nearest_of_body(body: Body, p: vec3f) -> vec3f {
    let s = body.size;
    switch body.kind {
        case CAPSULE: {
            return vec3f(0.0, 0.0, clamp(p.z, -s.y, s.y));
        }
        case CYLINDER: {
            return vec3f(p.xy * min(s.x / max(length(p.xy), SMALLEST), 1.0), clamp(p.z, -s.y, s.y));
        }
        case BOX: {
            return clamp(p, -s, s);
        }
        case SPHERE, ELLIPSOID, PLANE, HEIGHT_FIELD, MESH, PRISM, default: {
            return vec3f();
        }
    }
}

// The derivative of a core's support point with respect to the direction: share (Q − p pᵀ) − radius, with Q diagonal.
struct Curvature {
    share: f32,
    diagonal: vec3f,
    pull: vec3f,
    radius: f32,
}

fn curvature_of(body: Body, d: vec3f) -> Curvature {
    let s = body.size;
    if (ANY_ELLIPSOID && body.kind == ELLIPSOID) {
        let scaled = d * s;
        let inverse = 1.0 / max(length(scaled), SMALLEST);
        return Curvature(inverse, s * s, scaled * s * inverse, body.radius);
    }
    if (ANY_CYLINDER && body.kind == CYLINDER) {
        let radial = radial_direction(d);
        return Curvature(-s.x / max(length(d.xy), EPSILON), vec3f(), vec3f(-radial.y, radial.x, 0.0), 0.0);
    }
    return Curvature(0.0, vec3f(), vec3f(), 0.0);
}

// Returns the bilinear form of two vectors.
fn between(c: Curvature, u: vec3f, v: vec3f) -> f32 {
    return c.share * (dot(u * c.diagonal, v) - dot(c.pull, u) * dot(c.pull, v)) - c.radius * dot(u, v);
}

// Returns the part of a core's point that jumps at a crease of the support function.
fn corner_of(body: Body, point: vec3f) -> vec3f {
    if (body.kind == ELLIPSOID) {
        return vec3f();
    }
    if (body.kind == CYLINDER) {
        return vec3f(0.0, 0.0, point.z);
    }
    return point;
}
