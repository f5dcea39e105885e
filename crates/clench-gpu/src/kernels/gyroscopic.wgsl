// Gyroscopic forces of a free body without jointed children, integrated implicitly. CPU counterpart:
// `dynamics/gyroscopic.rs`, which derives them.

// Six equations, each with its right side as the seventh number.
var<private> equations: array<f32, 42>;

// Reads the joint's part of the matrix at `matrix`, M − h D, and of the forces from RATE.
fn begin_equations(matrix: u32, dof: u32) {
    for (var r = 0u; r < bound(6u); r++) {
        for (var c = 0u; c < bound(6u); c++) {
            equations[7u * r + c] = fetch(matrix + words[TREE_START + dof + max(r, c)] + min(r, c));
        }
        equations[7u * r + 6u] = fetch(RATE + dof + r);
    }
}

// Adds h ∂bias/∂v.
fn add_bias_derivative(j: u32) {
    let b = words[JNT_BODY + j];
    let axes = fetch_matrix(XMAT + 9u * b);
    let mass = fetch(CRB + 10u * b + 9u);
    let s = fetch3(SUBTREE_COM + 3u * b) - fetch3(XPOS + 3u * b);
    let w = axes * fetch_state3(QVEL + words[JNT_DOF + j] + 3u);
    let spin = momentum(CRB + 10u * b, Spatial(w, vec3f())).angular;
    for (var k = 0u; k < bound(3u); k++) {
        let dw = axes[k];
        let df = (cross(dw, cross(w, s)) + cross(w, cross(dw, s))) * mass;
        let dt = cross(dw, spin) + cross(w, momentum(CRB + 10u * b, Spatial(dw, vec3f())).angular);
        let moment = transpose(axes) * (dt + cross(s, df));
        for (var r = 0u; r < bound(3u); r++) {
            equations[7u * r + 3u + k] += TIMESTEP * df[r];
            equations[7u * r + 24u + k] += TIMESTEP * moment[r];
        }
    }
}

// Subtracts h times the skew part of D, due to ellipsoids in a medium.
fn subtract_skew_drag(j: u32) {
    let dof = words[JNT_DOF + j];
    for (var b = words[JNT_BODY + j]; b < bound(NBODY); b++) {
        if (!has_ellipsoids(b) || words[BODY_WELD + b] != words[JNT_BODY + j]) {
            continue;
        }
        for (var c = 0u; c < bound(6u); c++) {
            let change = rate_along(b, fetch_spatial(CDOF + 6u * (dof + c)), -1.0);
            for (var r = 0u; r < bound(6u); r++) {
                equations[7u * r + c] -= TIMESTEP * spatial_dot(fetch_spatial(CDOF + 6u * (dof + r)), change);
            }
        }
    }
}

// Solves by elimination with partial pivoting; the solution replaces the right side.
fn solve_equations() {
    for (var k = 0u; k < bound(6u); k++) {
        for (var r = k + 1u; r < bound(6u); r++) {
            let swap = abs(equations[7u * r + k]) > abs(equations[7u * k + k]);
            for (var c = k; swap && c < 7u; c++) {
                let above = equations[7u * k + c];
                equations[7u * k + c] = equations[7u * r + c];
                equations[7u * r + c] = above;
            }
        }
        for (var r = k + 1u; r < bound(6u); r++) {
            let factor = equations[7u * r + k] / equations[7u * k + k];
            for (var c = k; c < bound(7u); c++) {
                equations[7u * r + c] -= factor * equations[7u * k + c];
            }
        }
    }
    for (var up = 0u; up < bound(6u); up++) {
        let k = 5u - up;
        for (var c = k + 1u; c < bound(6u); c++) {
            equations[7u * k + 6u] -= equations[7u * k + c] * equations[7u * c + 6u];
        }
        equations[7u * k + 6u] /= equations[7u * k + k];
    }
}

// Computes the accelerations of all such bodies, in MEAN_RATE. The metric has no skew part of D.
fn gyroscopic_accelerations(matrix: u32) {
    for (var k = member; k < NFREE_TREE; k += TEAM) {
        let j = words[FREE_TREE_JNT + k];
        let dof = words[JNT_DOF + j];
        begin_equations(matrix, dof);
        add_bias_derivative(j);
        if (HAS_FLUID && ANY_FLUID_ELLIPSOID && !IN_METRIC) {
            subtract_skew_drag(j);
        }
        solve_equations();
        for (var r = 0u; r < bound(6u); r++) {
            put(MEAN_RATE + dof + r, equations[7u * r + 6u]);
        }
    }
}
