// Rays of sensors: one thread per ray, on request. CPU counterparts: `sensor/ray.rs` and `first_hit` in `geometry.rs`.
// A sensor is a row of RAY_SIZE words.

// Returns true if a ray may hit a ball within a distance: never false if it does, despite rounding.
fn may_intersect(line: Line, centre: vec3f, radius: f32, within: f32) -> bool {
    let apart = centre - line.origin;
    let ahead = dot(apart, line.along);
    let beside = apart - line.along * ahead;
    // The rounding error of distant geometry.
    let reach = radius + dot(abs(apart), vec3f(1.0)) * (8.0 * EPSILON);
    return dot(beside, beside) <= reach * reach && ahead + reach >= 0.0 && ahead - reach <= within;
}

// Returns the hit of a ray on a geom, in the geom's frame.
fn hit_geom(k: u32, geom: u32, line: Line, within: f32) -> Hit {
    let kind = words[GEOM_KIND + geom];
    let size = parameter3(GEOM_SIZE + 3u * geom);
    if (kind == PLANE) {
        return hit_plane(size, line);
    }
    if (RAYS_MEET_MESHES && kind == MESH) {
        return hit_mesh(words[RAY_SHAPE + k], line, within);
    }
    if (RAYS_MEET_TERRAIN && kind == HEIGHT_FIELD) {
        return hit_terrain(words[RAY_SHAPE + k], line);
    }
    return hit_solid(kind, size, line);
}

// Returns the first hit on a visible geom that is not of a body; the normal in world axes.
fn first_hit(line: Line, body: u32) -> Hit {
    var first = Hit(NOWHERE, vec3f());
    for (var k = 0u; k < bound(NRAY_GEOM); k++) {
        let geom = words[RAY_GEOM + k];
        let centre = fetch3(GEOM_XPOS + 3u * geom);
        let is_plane = words[GEOM_KIND + geom] == PLANE;
        let may_hit = is_plane || may_intersect(line, centre, parameter(RAY_REACH + k), first.distance);
        if (words[GEOM_BODY + geom] == body || !may_hit) {
            continue;
        }
        let axes = fetch_matrix(GEOM_XMAT + 9u * geom);
        let hit = hit_geom(k, geom, Line((line.origin - centre) * axes, line.along * axes), first.distance);
        if (hit.distance < first.distance) {
            first = Hit(hit.distance, axes * hit.normal);
        }
    }
    return first;
}

// Returns a ray of a sensor.
fn line_of(s: u32, ray: u32) -> Line {
    let element = words[s + RAY_ELEMENT];
    switch words[s + RAY_SOURCE] {
        case FROM_SITE: {
            return Line(fetch3(SITE_XPOS + 3u * element), fetch_matrix(SITE_XMAT + 9u * element)[2]);
        }
        case FROM_CAMERA, default: {
            return line_of_sight(element, ray - words[s + RAY_FIRST]);
        }
    }
}

// Returns the axis of the sensor.
fn axis_of(s: u32) -> vec3f {
    let element = words[s + RAY_ELEMENT];
    if (words[s + RAY_SOURCE] == FROM_SITE) {
        return fetch_matrix(SITE_XMAT + 9u * element)[2];
    }
    return -fetch_matrix(CAM_XMAT + 9u * element)[2];
}

// Writes the sensor's fields for a ray.
fn read_ray(s: u32, cutoff: f32, ray: u32) {
    let line = line_of(s, ray);
    let hit = first_hit(line, words[s + RAY_BODY]);
    let found = hit.distance < NOWHERE;
    var out = SENSORDATA + words[s + RAY_OFFSET] + words[s + RAY_WIDTH] * (ray - words[s + RAY_FIRST]);
    for (var k = words[s + RAY_FIELD_START]; k < words[s + RAY_FIELD_END]; k++) {
        let field = words[RAY_FIELD + k];
        var reading = vec3f();
        switch field {
            case RAY_ORIGIN: {
                reading = line.origin;
            }
            case RAY_DIST: {
                reading.x = select(-1.0, hit.distance, found);
            }
            case RAY_DEPTH: {
                reading.x = select(-1.0, hit.distance * dot(line.along, axis_of(s)), found);
            }
            case RAY_DIR: {
                reading = select(vec3f(), line.along, found);
            }
            case RAY_POINT: {
                reading = select(vec3f(), line.origin + line.along * hit.distance, found);
            }
            case RAY_NORMAL, default: {
                reading = select(vec3f(), hit.normal, found);
            }
        }
        reading = clamp(reading, vec3f(-cutoff), vec3f(cutoff));
        put(out, reading.x);
        out += 1u;
        if (field != RAY_DIST && field != RAY_DEPTH) {
            put(out, reading.y);
            put(out + 1u, reading.z);
            out += 2u;
        }
    }
}

// Adjacent threads have neighbouring environments and the same ray.
@compute @workgroup_size(GROUP)
fn rays(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    if (!SENSING || !begin(id.x)) {
        return;
    }
    for (var ray = id.y; ray < NRAY; ray += groups.y) {
        let sensor = words[RAY_SENSOR + ray];
        read_ray(RAY_SENSORS + RAY_SIZE * sensor, parameter(RAY_CUTOFF + sensor), ray);
    }
    check_loops();
}
