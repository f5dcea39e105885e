// M⁻¹ by the LᵀDL of the tree, level by level: the dofs of one level, as many steps from the root, do not wait for each other. Each number
// is gathered by one thread, in the order of `clench-solver/src/tree/factor.rs`.

// The dofs of a level, for each of which a thread does its part.
struct Level {
    first: u32,
    end: u32,
}

fn level_at(k: u32) -> Level {
    return Level(words[LEVEL_START + k], words[LEVEL_START + k + 1u]);
}

// M⁻¹g at PRECONDITIONED_AT, for conjugate gradients; for Newton's method only L⁻ᵀg. Returns the duality gap ½ gᵀM⁻¹g: the cost less
// ½ |a|²_M is convex, so the cost exceeds its minimum by at most this.
fn precondition() -> f32 {
    for (var k = NLEVEL; k > 0u; k--) {
        let level = level_at(k - 1u);
        for (var n = level.first + lane; n < level.end; n += GROUP) {
            let i = words[LEVEL_DOF + n];
            var sum = vector(GRADIENT_AT + i);
            for (var p = words[BELOW_START + i + 1u]; p > words[BELOW_START + i]; p--) {
                let below = words[BELOW_DOF + p - 1u];
                sum -= fetch(QLD + words[TREE_START + below] + depth(i)) * vector(PRECONDITIONED_AT + below);
            }
            put_vector(PRECONDITIONED_AT + i, sum);
        }
        join();
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
            join();
        }
    }
    return 0.5 * total(vec4f(square, 0.0, 0.0, 0.0)).x;
}
