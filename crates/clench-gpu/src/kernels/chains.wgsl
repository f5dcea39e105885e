// The dofs that move a body, the motion of its points, and their bias acceleration. CPU counterpart:
// `dynamics/chains.rs`.

fn moves(body: u32, dof: u32) -> bool {
    return ((words[DOF_MASK + MASK_WORDS * body + (dof >> 5u)] >> (dof & 31u)) & 1u) == 1u;
}

// Returns true if each dof moves both bodies or neither.
fn move_together(a: u32, b: u32) -> bool {
    var alike = true;
    for (var i = 0u; i < MASK_WORDS; i++) {
        alike = alike && words[DOF_MASK + MASK_WORDS * a + i] == words[DOF_MASK + MASK_WORDS * b + i];
    }
    return alike;
}

// Returns the offset of a point from the reference point of the tree of body `b`.
fn offset_of(b: u32, point: vec3f) -> vec3f {
    return point - fetch3(SUBTREE_COM + 3u * words[BODY_ROOT + b]);
}

// Returns the motion of the point of body `b` at `point` due to dof `i`, and the body's rotation.
fn motion_at(b: u32, i: u32, point: vec3f) -> Spatial {
    let motion = fetch_spatial(CDOF + 6u * i);
    return Spatial(motion.angular, motion.linear + cross(motion.angular, offset_of(b, point)));
}

// Returns the current velocity of the same point.
fn velocity_at(b: u32, point: vec3f) -> Spatial {
    let motion = fetch_spatial(CVEL + 6u * b);
    return Spatial(motion.angular, motion.linear + cross(motion.angular, offset_of(b, point)));
}

// Returns J̇ v of a body (angular) and of its point at `point` (linear).
fn bias_acceleration(b: u32, point: vec3f) -> Spatial {
    var sum = Spatial(vec3f(), vec3f());
    for (var i = 0u; i < bound(NV); i++) {
        if (moves(b, i)) {
            sum = plus(sum, times(fetch_spatial(CDOF_DOT + 6u * i), fetch_state(QVEL + i)));
        }
    }
    let velocity = velocity_at(b, point);
    let linear = sum.linear + cross(sum.angular, offset_of(b, point));
    return Spatial(sum.angular, linear + cross(velocity.angular, velocity.linear));
}
