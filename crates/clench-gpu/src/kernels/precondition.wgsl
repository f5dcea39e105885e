// M⁻¹ by the LᵀDL of the tree, in the order of `clench-solver/src/tree/factor.rs`: level by level, of which the dofs, as many steps from the root,
// do not wait for each other, each number gathered by one thread; or, towards the root, dof by dof, whose ancestors do not either. Of many
// small trees the former takes fewer turns, of one large tree the latter.

// The dofs of a level, for each of which a thread does its part.
struct Level {
    first: u32,
    end: u32,
}

fn level_at(k: u32) -> Level {
    return Level(words[LEVEL_START + k], words[LEVEL_START + k + 1u]);
}

// L⁻ᵀg at PRECONDITIONED_AT, level by level.
fn gather_from_below() {
    for (var k = NLEVEL; k > 0u; k--) {
        let level = level_at(k - 1u);
        for (var n = level.first + lane; n < level.end; n += GROUP) {
            let i = words[LEVEL_DOF + n];
            var sum = vector(GRADIENT_AT + i);
            for (var p = words[BELOW_START + i + 1u]; p > words[BELOW_START + i]; p--) {
                sum -= fetch(QLD + words[BELOW_PLACE + p - 1u]) * vector(PRECONDITIONED_AT + words[BELOW_DOF + p - 1u]);
            }
            put_vector(PRECONDITIONED_AT + i, sum);
        }
        join_vectors();
    }
}

// The same, dof by dof.
fn hand_up() {
    for (var i = lane; i < bound(NV); i += GROUP) {
        put_vector(PRECONDITIONED_AT + i, vector(GRADIENT_AT + i));
    }
    join_vectors();
    for (var up = 1u; up < bound(NV); up++) {
        let i = NV - up;
        let value = vector(PRECONDITIONED_AT + i);
        for (var p = words[TREE_START + i] + lane; p + 1u < words[TREE_START + i + 1u]; p += GROUP) {
            let above = PRECONDITIONED_AT + words[TREE_DOF + p];
            put_vector(above, vector(above) - fetch(QLD + p) * value);
        }
        join_vectors();
    }
}

// M⁻¹g at PRECONDITIONED_AT, for conjugate gradients; for Newton's method only L⁻ᵀg. Returns the duality gap ½ gᵀM⁻¹g: the cost less
// ½ |a|²_M is convex, so the cost exceeds its minimum by at most this.
fn precondition() -> f32 {
    if (DOF_BY_DOF) {
        hand_up();
    } else {
        gather_from_below();
    }
    var square: f32 = 0.0;
    for (var i = lane; i < bound(NV); i += GROUP) {
        let x = vector(PRECONDITIONED_AT + i);
        square += x * x * fetch(QLD_INVERSE + i);
    }
    if (!NEWTON) {
        for (var k = 0u; k < bound(NLEVEL); k++) {
            let level = level_at(k);
            for (var n = level.first + lane; n < level.end; n += GROUP) {
                let i = words[LEVEL_DOF + n];
                var sum = vector(PRECONDITIONED_AT + i) * fetch(QLD_INVERSE + i);
                for (var p = words[TREE_START + i]; p + 1u < words[TREE_START + i + 1u]; p++) {
                    sum -= fetch(QLD + p) * vector(PRECONDITIONED_AT + words[TREE_DOF + p]);
                }
                put_vector(PRECONDITIONED_AT + i, sum);
            }
            join_vectors();
        }
    }
    return 0.5 * total(vec4f(square, 0.0, 0.0, 0.0)).x;
}
