// Quaternions (w, x, y, z in the components x, y, z, w) and spatial vectors. CPU counterpart: `clench-math`.

// Untyped, as in `elementary.wgsl`.
const PI = 3.141592653589793;
const TWO_PI = 6.283185307179586;
const HALF_PI = 1.5707963267948966;

// Below this length a vector or quaternion has no direction.
const TINY: f32 = 1e-15;

// Returns the direction of a vector, x if it has none; then its length.
fn direction(v: vec3f) -> vec4f {
    let norm = length(v);
    if (norm < TINY) {
        return vec4f(1.0, 0.0, 0.0, norm);
    }
    return vec4f(v * (1.0 / norm), norm);
}

fn quat_from_axis_angle(axis: vec3f, angle: f32) -> vec4f {
    let t = sin_cos(angle * 0.5);
    return vec4f(t.y, axis * t.x);
}

fn quat_normalize(q: vec4f) -> vec4f {
    let norm = length(q);
    if (norm < TINY) {
        return vec4f(1.0, 0.0, 0.0, 0.0);
    }
    return q * (1.0 / norm);
}

fn quat_product(a: vec4f, b: vec4f) -> vec4f {
    return vec4f(
        a.x * b.x - dot(a.yzw, b.yzw),
        a.x * b.yzw + b.x * a.yzw + cross(a.yzw, b.yzw),
    );
}

fn quat_rotate(q: vec4f, v: vec3f) -> vec3f {
    let t = cross(q.yzw, v) * 2.0;
    return v + t * q.x + cross(q.yzw, t);
}

fn quat_matrix(q: vec4f) -> mat3x3f {
    let w = q.x;
    let x = q.y;
    let y = q.z;
    let z = q.w;
    return mat3x3f(
        vec3f(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        vec3f(2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
        vec3f(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)),
    );
}

// Returns axis times angle, with the angle in (−π, π].
fn quat_rotation_vector(q: vec4f) -> vec3f {
    let axis = direction(q.yzw);
    var angle = 2.0 * angle_of(axis.w, q.x);
    if (angle > PI) {
        angle -= TWO_PI;
    }
    return axis.xyz * angle;
}

// Returns the rotation vector in the child's axes that takes `other` to `q`.
fn quat_difference(q: vec4f, other: vec4f) -> vec3f {
    return quat_rotation_vector(quat_product(vec4f(other.x, -other.yzw), q));
}

// Returns the orientation after rotating at the local angular velocity `omega` for `time` seconds.
fn quat_integrate(q: vec4f, omega: vec3f, time: f32) -> vec4f {
    let axis = direction(omega);
    return quat_normalize(quat_product(q, quat_from_axis_angle(axis.xyz, axis.w * time)));
}

// A spatial motion or force: about the centre of mass of the tree, along world axes.
struct Spatial {
    angular: vec3f,
    linear: vec3f,
}

fn fetch_spatial(offset: u32) -> Spatial {
    return Spatial(fetch3(offset), fetch3(offset + 3u));
}

fn put_spatial(offset: u32, s: Spatial) {
    put3(offset, s.angular);
    put3(offset + 3u, s.linear);
}

fn plus(a: Spatial, b: Spatial) -> Spatial {
    return Spatial(a.angular + b.angular, a.linear + b.linear);
}

fn times(a: Spatial, s: f32) -> Spatial {
    return Spatial(a.angular * s, a.linear * s);
}

// Returns the power of a force along a motion.
fn spatial_dot(a: Spatial, b: Spatial) -> f32 {
    return dot(a.angular, b.angular) + dot(a.linear, b.linear);
}

// Returns a × m, both motions.
fn cross_motion(a: Spatial, m: Spatial) -> Spatial {
    return Spatial(
        cross(a.angular, m.angular),
        cross(a.angular, m.linear) + cross(a.linear, m.angular),
    );
}

// Returns a ×* f, a motion and a force.
fn cross_force(a: Spatial, f: Spatial) -> Spatial {
    return Spatial(
        cross(a.angular, f.angular) + cross(a.linear, f.linear),
        cross(a.angular, f.linear),
    );
}

// Returns the momentum of the inertia at `offset` (xx, yy, zz, xy, xz, yz; mass times centre; mass) with the motion
// `m`.
fn momentum(offset: u32, m: Spatial) -> Spatial {
    let diagonal = fetch3(offset);
    let off = fetch3(offset + 3u);
    let moment = fetch3(offset + 6u);
    let mass = fetch(offset + 9u);
    let turned = vec3f(
        diagonal.x * m.angular.x + off.x * m.angular.y + off.y * m.angular.z,
        off.x * m.angular.x + diagonal.y * m.angular.y + off.z * m.angular.z,
        off.y * m.angular.x + off.z * m.angular.y + diagonal.z * m.angular.z,
    );
    return Spatial(
        turned + cross(moment, m.linear),
        m.linear * mass - cross(moment, m.angular),
    );
}
