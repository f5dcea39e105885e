// Potential and kinetic energy. CPU counterpart: `dynamics/energy.rs`.

// Returns the energy of a spring of this law at an elongation.
fn energy_of_spring(law: vec3f, x: f32) -> f32 {
    return x * x * (law.x / 2.0 + x * (law.y / 3.0 + x * law.z / 4.0));
}

fn energy_of_springs() -> f32 {
    var sum: f32 = 0.0;
    for (var s = 0u; s < NSPRING; s++) {
        let j = words[SPRING_JNT + s];
        let law = parameter3(SPRING_LAW + 3u * s);
        let kind = words[JNT_KIND + j];
        var q = words[JNT_QPOS + j];
        if (kind == SLIDE || kind == HINGE) {
            sum += energy_of_spring(law, joint_displacement(j, q));
            continue;
        }
        if (kind == FREE) {
            sum += energy_of_spring(law, length(joint_shift(j, q)));
            q += 3u;
        }
        sum += energy_of_spring(law, length(joint_rotation(j, q)));
    }
    for (var t = 0u; t < NTENDON; t++) {
        sum += energy_of_spring(parameter3(TENDON_SPRING + 5u * t + 2u), tendon_stretch(t));
    }
    return sum;
}

// Returns the gravitational energy (zero at the world's origin).
fn energy_of_weights() -> f32 {
    var sum: f32 = 0.0;
    for (var b = 1u; b < bound(NBODY); b++) {
        sum -= parameter(BODY_MASS + b) * dot(parameter3(GRAVITY), fetch3(XIPOS + 3u * b));
    }
    return sum;
}

// Returns ½ vᵀ M v, with each pair of the lower triangle once.
fn kinetic_energy() -> f32 {
    var sum: f32 = 0.0;
    let mass = select(QM, PLAIN_MASS, IN_METRIC);
    for (var i = 0u; i < bound(NV); i++) {
        let last = words[TREE_START + i + 1u] - 1u;
        var momentum = 0.5 * fetch(mass + last) * fetch_state(QVEL + i);
        for (var p = words[TREE_START + i]; p < last; p++) {
            momentum += fetch(mass + p) * fetch_state(QVEL + words[TREE_DOF + p]);
        }
        sum += momentum * fetch_state(QVEL + i);
    }
    return sum;
}

fn mechanical_energy() {
    put(MECHANICAL_ENERGY, energy_of_weights() + energy_of_springs());
    put(MECHANICAL_ENERGY + 1u, kinetic_energy());
}
