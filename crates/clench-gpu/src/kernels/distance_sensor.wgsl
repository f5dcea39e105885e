// The smallest distance of two sets of geoms: a range of the measured pairs. CPU counterpart: `sensor/distance.rs`.

fn read_distance(kind: u32, s: u32, prm: u32, out: u32) {
    var distance = parameter(prm + SENSOR_PRM_CUTOFF);
    var nearest = NONE;
    for (var k = words[s + SENSOR_OBJECT]; k < words[s + SENSOR_REFERENCE]; k++) {
        let own = fetch(MEASURED + CONTACT_SIZE * k + 1u);
        if (own < distance || (nearest == NONE && own == distance)) {
            distance = own;
            nearest = k;
        }
    }
    if (kind == SENSE_DISTANCE) {
        put(out, distance);
        return;
    }
    var normal = vec3f();
    var middle = vec3f();
    if (nearest != NONE) {
        let offset = MEASURED + CONTACT_SIZE * nearest;
        middle = fetch3(offset + 2u);
        normal = fetch3(offset + 5u) * select(f32(1.0), f32(-1.0), words[MEASURED_TURNED + nearest] == 1u);
    }
    // From the first end to the second: against the normal if the geoms overlap.
    switch kind {
        case SENSE_NORMAL: {
            put3(out, normal * select(f32(1.0), f32(-1.0), distance < 0.0));
        }
        case SENSE_FROMTO, default: {
            put3(out, middle - normal * (0.5 * distance));
            put3(out + 3u, middle + normal * (0.5 * distance));
        }
    }
}
