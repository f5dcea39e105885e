// Accelerations of bodies and forces between them, constraints included, and the energy: one thread per environment, on
// request. CPU counterpart: `sensor/bodies.rs`.

@compute @workgroup_size(GROUP)
fn body_forces(@builtin(global_invocation_id) id: vec3u) {
    if (!begin(id.x)) {
        return;
    }
    mechanical_energy();
    external_forces();
    put_spatial(CACC_JOINTS, Spatial(vec3f(), vec3f()));
    put_spatial(CACC, fetch_spatial(CACC_BIAS));
    put_spatial(CFRC_INT, Spatial(vec3f(), vec3f()));
    for (var b = 1u; b < bound(NBODY); b++) {
        var joints = fetch_spatial(CACC_JOINTS + 6u * words[BODY_PARENT + b]);
        for (var i = words[BODY_DOF + b]; i < words[BODY_DOF + b + 1u]; i++) {
            joints = plus(joints, times(fetch_spatial(CDOF + 6u * i), fetch(QACC + i)));
        }
        put_spatial(CACC_JOINTS + 6u * b, joints);
        let cacc = plus(fetch_spatial(CACC_BIAS + 6u * b), joints);
        let cvel = fetch_spatial(CVEL + 6u * b);
        let inertial = plus(momentum(CINERT + 10u * b, cacc), cross_force(cvel, momentum(CINERT + 10u * b, cvel)));
        put_spatial(CACC + 6u * b, cacc);
        put_spatial(CFRC_INT + 6u * b, plus(inertial, times(fetch_spatial(CFRC_EXT + 6u * b), -1.0)));
    }
    for (var b = NBODY - 1u; b > 0u; b--) {
        let parent = CFRC_INT + 6u * words[BODY_PARENT + b];
        put_spatial(parent, plus(fetch_spatial(parent), fetch_spatial(CFRC_INT + 6u * b)));
    }
}
