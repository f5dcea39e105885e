// The mass matrix by composite rigid bodies. CPU counterpart: `dynamics/inertia.rs`.

// The ten numbers of an inertia, read and written together, because separate accesses are slow on a GPU.
struct Inertia {
    first: vec4f,
    second: vec4f,
    third: vec2f,
}

fn fetch_inertia(offset: u32) -> Inertia {
    return Inertia(fetch4(offset), fetch4(offset + 4u), vec2f(fetch(offset + 8u), fetch(offset + 9u)));
}

fn put_inertia(offset: u32, inertia: Inertia) {
    put4(offset, inertia.first);
    put4(offset + 4u, inertia.second);
    put(offset + 8u, inertia.third.x);
    put(offset + 9u, inertia.third.y);
}

fn sum_of_inertias(a: Inertia, b: Inertia) -> Inertia {
    return Inertia(a.first + b.first, a.second + b.second, a.third + b.third);
}

// Sums inertias over each body and its descendants; not for the world.
fn composite_inertias() {
    for (var level = NBODY_LEVEL; level > 0u; level--) {
        for (var n = words[BODY_LEVEL + level - 1u] + member; n < words[BODY_LEVEL + level]; n += TEAM) {
            let b = words[LEVEL_BODY + n];
            var carried = fetch_inertia(CINERT + 10u * b);
            for (var k = words[BODY_CHILD + b]; b > 0u && k < words[BODY_CHILD + b + 1u]; k++) {
                carried = sum_of_inertias(carried, fetch_inertia(CRB + 10u * words[CHILD_BODY + k]));
            }
            put_inertia(CRB + 10u * b, carried);
        }
        join();
    }
}

fn mass_matrix() {
    for (var i = member; i < bound(NV); i += TEAM) {
        let carried = momentum(CRB + 10u * words[DOF_BODY + i], fetch_spatial(CDOF + 6u * i));
        let end = words[TREE_START + i + 1u];
        // Two at a time; the last may repeat.
        for (var p = words[TREE_START + i]; p < end; p += 2u) {
            let next = min(p + 1u, end - 1u);
            let axis = fetch_spatial(CDOF + 6u * words[TREE_DOF + p]);
            let next_axis = fetch_spatial(CDOF + 6u * words[TREE_DOF + next]);
            put(QM + p, spatial_dot(axis, carried));
            put(QM + next, spatial_dot(next_axis, carried));
        }
        add(QM + end - 1u, parameter(DOF_ARMATURE + i));
    }
    join();
}

// Adds the inertia of all tendons. CPU counterpart: `dynamics/tendon_armature.rs`.
fn add_tendon_inertia() {
    for (var t = 0u; is_first() && t < NTENDON; t++) {
        let armature = parameter(TENDON_ARMATURE + t);
        add_outer(QM, TENDON_DOF, TEN_JACOBIAN, words[TENDON_ROW + t], words[TENDON_ROW + t + 1u], armature);
    }
    join();
}

// Computes everything that depends only on positions. One team per environment.
@compute @workgroup_size(GROUP, TEAM)
fn positions(@builtin(global_invocation_id) id: vec3u) {
    begin_in_team(id);
    kinematics();
    join();
    com_positions();
    composite_inertias();
    mass_matrix();
    tendons();
    if (NTENDON > 0u) {
        join();
    }
    transmissions();
    if (HEAVY_TENDONS) {
        add_tendon_inertia();
    }
    if (!factor_mass()) {
        fail(SINGULAR);
    }
    end_in_team();
}
