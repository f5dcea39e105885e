// The factor of the mass matrix by articulated bodies, for long paths, where M in single precision is too inexact. CPU
// counterpart: `dynamics/articulated.rs`.
//
// ARTICULATED holds the apparent inertia of each body with the joints below it free, about its centre of mass: three
// matrices, `rotational`, `coupling` and `mass`, with moment = rotational ω + coupling v and force = couplingᵀ ω + mass
// v.

struct ArticulatedInertia {
    rotational: mat3x3f,
    coupling: mat3x3f,
    mass: mat3x3f,
}

fn fetch_articulated(b: u32) -> ArticulatedInertia {
    let offset = ARTICULATED + 27u * b;
    return ArticulatedInertia(fetch_matrix(offset), fetch_matrix(offset + 9u), fetch_matrix(offset + 18u));
}

fn put_articulated(b: u32, inertia: ArticulatedInertia) {
    let offset = ARTICULATED + 27u * b;
    put_matrix(offset, inertia.rotational);
    put_matrix(offset + 9u, inertia.coupling);
    put_matrix(offset + 18u, inertia.mass);
}

// Returns the inertia of a single body.
fn rigid_inertia(b: u32) -> ArticulatedInertia {
    let axes = fetch_matrix(XIMAT + 9u * b);
    let diagonal = parameter3(BODY_INERTIA + 3u * b);
    let mass = parameter(BODY_MASS + b);
    let scaled = mat3x3f(axes[0] * diagonal.x, axes[1] * diagonal.y, axes[2] * diagonal.z);
    return ArticulatedInertia(
        scaled * transpose(axes),
        mat3x3f(),
        mat3x3f(mass, 0.0, 0.0, 0.0, mass, 0.0, 0.0, 0.0, mass),
    );
}

// Returns the moment and force for an acceleration.
fn articulated_force(inertia: ArticulatedInertia, m: Spatial) -> Spatial {
    return Spatial(
        inertia.rotational * m.angular + inertia.coupling * m.linear,
        transpose(inertia.coupling) * m.angular + inertia.mass * m.linear,
    );
}

// Returns inertia − u uᵀ / pivot.
fn release(inertia: ArticulatedInertia, u: Spatial, inverse_pivot: f32) -> ArticulatedInertia {
    var freed = inertia;
    for (var i = 0u; i < bound(3u); i++) {
        freed.rotational[i] -= u.angular * (u.angular[i] * inverse_pivot);
        freed.coupling[i] -= u.angular * (u.linear[i] * inverse_pivot);
        freed.mass[i] -= u.linear * (u.linear[i] * inverse_pivot);
    }
    return freed;
}

// Returns the cross products of a vector with the columns of a matrix.
fn crossed(v: vec3f, m: mat3x3f) -> mat3x3f {
    return mat3x3f(cross(v, m[0]), cross(v, m[1]), cross(v, m[2]));
}

// Adds an inertia about the point at `offset` from the other's.
fn add_shifted(own: ArticulatedInertia, other: ArticulatedInertia, offset: vec3f) -> ArticulatedInertia {
    let moved = other.coupling + crossed(offset, other.mass);
    let turned = transpose(crossed(offset, transpose(other.coupling)));
    let carried = crossed(offset, transpose(moved));
    return ArticulatedInertia(
        own.rotational + other.rotational + turned + carried,
        own.coupling + moved,
        own.mass + other.mass,
    );
}

// Returns the motion of the body's point at `point` if dof i moves at unit velocity, from the joint's anchor.
fn motion_from_anchor(i: u32, point: vec3f) -> Spatial {
    let joint = words[DOF_JNT + i];
    let kind = words[JNT_KIND + joint];
    let motion = fetch_spatial(CDOF + 6u * i);
    if (kind == SLIDE || (kind == FREE && i - words[JNT_DOF + joint] < 3u)) {
        return Spatial(vec3f(), motion.linear);
    }
    return Spatial(motion.angular, cross(motion.angular, point - fetch3(XANCHOR + 3u * joint)));
}

// Factors M, plus `added_inertia` on its diagonal, into QLD; returns false if a pivot is not positive.
fn articulated_factor() -> bool {
    var positive = true;
    for (var b = 1u; b < bound(NBODY); b++) {
        put_articulated(b, rigid_inertia(b));
    }
    for (var b = NBODY - 1u; b > 0u; b--) {
        let centre = fetch3(XIPOS + 3u * b);
        var inertia = fetch_articulated(b);
        for (var end = words[BODY_DOF + b + 1u]; end > words[BODY_DOF + b]; end--) {
            let i = end - 1u;
            let own = motion_from_anchor(i, centre);
            let u = articulated_force(inertia, own);
            let pivot = spatial_dot(own, u) + parameter(DOF_ARMATURE + i) + added_inertia(i);
            positive = positive && pivot > 0.0 && !is_wild(pivot);
            let inverse = 1.0 / pivot;
            let last = words[TREE_START + i + 1u] - 1u;
            put(QLD + last, inverse);
            put(QLD_INVERSE + i, inverse);
            for (var p = words[TREE_START + i]; p < last; p++) {
                put(QLD + p, spatial_dot(motion_from_anchor(words[TREE_DOF + p], centre), u) * inverse);
            }
            inertia = release(inertia, u, inverse);
        }
        let parent = words[BODY_PARENT + b];
        if (parent != 0u) {
            let offset = centre - fetch3(XIPOS + 3u * parent);
            put_articulated(parent, add_shifted(fetch_articulated(parent), inertia, offset));
        }
    }
    return positive;
}
