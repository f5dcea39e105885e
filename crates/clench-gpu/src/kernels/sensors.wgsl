// Sensors: one thread per environment, on request. CPU counterparts: `sensor/read.rs`, `frame.rs`, `limit.rs` and
// `volume.rs`. A sensor is a row of SENSOR_SIZE words and one of SENSOR_PRM_SIZE numbers.

// Returns the position of an object.
fn object_position(kind: u32, o: u32) -> vec3f {
    switch kind {
        case INERTIAL_FRAME: {
            return fetch3(XIPOS + 3u * o);
        }
        case GEOM_FRAME: {
            return fetch3(GEOM_XPOS + 3u * o);
        }
        case SITE_FRAME: {
            return fetch3(SITE_XPOS + 3u * o);
        }
        case CAMERA_FRAME: {
            return fetch3(CAM_XPOS + 3u * o);
        }
        case BODY_FRAME, NO_FRAME, default: {
            return fetch3(XPOS + 3u * o);
        }
    }
}

// Returns its axes as columns.
fn object_axes(kind: u32, o: u32) -> mat3x3f {
    switch kind {
        case INERTIAL_FRAME: {
            return fetch_matrix(XIMAT + 9u * o);
        }
        case GEOM_FRAME: {
            return fetch_matrix(GEOM_XMAT + 9u * o);
        }
        case SITE_FRAME: {
            return fetch_matrix(SITE_XMAT + 9u * o);
        }
        case CAMERA_FRAME: {
            return fetch_matrix(CAM_XMAT + 9u * o);
        }
        case BODY_FRAME, NO_FRAME, default: {
            return fetch_matrix(XMAT + 9u * o);
        }
    }
}

// Returns its orientation, with the sign of its body's.
fn object_quat(kind: u32, o: u32, body: u32) -> vec4f {
    let q = fetch4(XQUAT + 4u * body);
    switch kind {
        case INERTIAL_FRAME: {
            return quat_product(q, parameter4(BODY_IQUAT + 4u * o));
        }
        case GEOM_FRAME: {
            return quat_product(q, parameter4(GEOM_QUAT + 4u * o));
        }
        case SITE_FRAME: {
            return quat_product(q, parameter4(SITE_QUAT + 4u * o));
        }
        // As in MuJoCo, as if it were fixed to its body in all modes.
        case CAMERA_FRAME: {
            return quat_product(q, parameter4(CAM_QUAT + 4u * o));
        }
        case BODY_FRAME, NO_FRAME, default: {
            return q;
        }
    }
}

// Returns the acceleration of a body's point, with gravity's upward reaction.
fn acceleration_at(b: u32, point: vec3f) -> Spatial {
    let cacc = fetch_spatial(CACC + 6u * b);
    let velocity = velocity_at(b, point);
    let linear = cacc.linear + cross(cacc.angular, offset_of(b, point));
    return Spatial(cacc.angular, linear + cross(velocity.angular, velocity.linear));
}

// Reads a sensor of a frame, relative to a second one if there is one.
fn read_frame(kind: u32, s: u32, out: u32) {
    let object_kind = words[s + SENSOR_OBJECT_KIND];
    let o = words[s + SENSOR_OBJECT];
    let body = words[s + SENSOR_BODY];
    let other_kind = words[s + SENSOR_REFERENCE_KIND];
    let other = words[s + SENSOR_REFERENCE];
    let other_body = words[s + SENSOR_REFERENCE_BODY];
    let p = object_position(object_kind, o);
    var axes = mat3x3f(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    var origin = vec3f();
    var carried = Spatial(vec3f(), vec3f());
    if (other_kind != NO_FRAME) {
        axes = object_axes(other_kind, other);
        origin = object_position(other_kind, other);
        let own = velocity_at(other_body, origin);
        carried = Spatial(own.angular, own.linear + cross(own.angular, p - origin));
    }
    switch kind {
        case SENSE_FRAMEPOS: {
            put3(out, (p - origin) * axes);
        }
        case SENSE_FRAMEQUAT: {
            var q = object_quat(object_kind, o, body);
            if (other_kind != NO_FRAME) {
                let reference = object_quat(other_kind, other, other_body);
                q = quat_product(vec4f(reference.x, -reference.yzw), q);
            }
            put4(out, q);
        }
        case SENSE_FRAMEXAXIS: {
            put3(out, object_axes(object_kind, o)[0] * axes);
        }
        case SENSE_FRAMEYAXIS: {
            put3(out, object_axes(object_kind, o)[1] * axes);
        }
        case SENSE_FRAMEZAXIS: {
            put3(out, object_axes(object_kind, o)[2] * axes);
        }
        case SENSE_FRAMELINVEL: {
            put3(out, (velocity_at(body, p).linear - carried.linear) * axes);
        }
        case SENSE_FRAMEANGVEL: {
            put3(out, (velocity_at(body, p).angular - carried.angular) * axes);
        }
        case SENSE_FRAMELINACC: {
            put3(out, acceleration_at(body, p).linear);
        }
        case SENSE_FRAMEANGACC, default: {
            put3(out, acceleration_at(body, p).angular);
        }
    }
}

// Returns the force that a site's body carries through its joints, about the site.
fn carried_force(site: u32) -> Spatial {
    let body = words[SITE_BODY + site];
    let force = fetch_spatial(CFRC_INT + 6u * body);
    let arm = offset_of(body, fetch3(SITE_XPOS + 3u * site));
    return Spatial(force.angular - cross(arm, force.linear), force.linear);
}

fn read_site(kind: u32, site: u32, out: u32) {
    let axes = fetch_matrix(SITE_XMAT + 9u * site);
    let p = fetch3(SITE_XPOS + 3u * site);
    let body = words[SITE_BODY + site];
    switch kind {
        case SENSE_ACCELEROMETER: {
            put3(out, acceleration_at(body, p).linear * axes);
        }
        case SENSE_VELOCIMETER: {
            put3(out, velocity_at(body, p).linear * axes);
        }
        case SENSE_GYRO: {
            put3(out, velocity_at(body, p).angular * axes);
        }
        case SENSE_FORCE: {
            put3(out, carried_force(site).linear * axes);
        }
        case SENSE_TORQUE: {
            put3(out, carried_force(site).angular * axes);
        }
        case SENSE_MAGNETOMETER, default: {
            put3(out, parameter3(MAGNETIC) * axes);
        }
    }
}

// Returns true if a point is inside a site's volume.
fn is_inside(s: u32, prm: u32, p: vec3f) -> bool {
    let site = words[s + SENSOR_REFERENCE];
    let local = (p - fetch3(SITE_XPOS + 3u * site)) * fetch_matrix(SITE_XMAT + 9u * site);
    return is_in_volume(words[s + SENSOR_SHAPE], parameter3(prm + SENSOR_PRM_VOLUME), local);
}

// Returns the sum of the normal forces of those contacts of the site's body whose line of force, followed out of the
// body, intersects the site's volume.
fn touch(s: u32, prm: u32) -> f32 {
    let site = words[s + SENSOR_OBJECT];
    let own = words[SITE_BODY + site];
    let axes = fetch_matrix(SITE_XMAT + 9u * site);
    let centre = fetch3(SITE_XPOS + 3u * site);
    var sum: f32 = 0.0;
    for (var b = 0u; b < reports[NBLOCK * envs + env]; b++) {
        if (block(b, BLOCK_KIND) < CONTACT_NORMAL) {
            continue;
        }
        let offset = CONTACTS + CONTACT_SIZE * block(b, BLOCK_SOURCE);
        let pair = u32(fetch(offset));
        let second = words[PAIR_BODY + 2u * pair + 1u];
        let normal = row(FORCE + block(b, BLOCK_ROW)) - contact_adhesion(block(b, BLOCK_SOURCE));
        if ((own != second && own != words[PAIR_BODY + 2u * pair]) || normal <= 0.0) {
            continue;
        }
        let o = (fetch3(offset + 2u) - centre) * axes;
        let d = (fetch3(offset + 5u) * select(f32(1.0), f32(-1.0), own == second)) * axes;
        sum += select(0.0, normal, intersects_volume(words[s + SENSOR_SHAPE], parameter3(prm + SENSOR_PRM_VOLUME), o, d));
    }
    return sum;
}

// Returns the distance, rate or force of the first active limit of a coordinate.
fn limit(c: u32, margin: f32, part: u32) -> f32 {
    for (var b = 0u; b < reports[NBLOCK * envs + env]; b++) {
        if (block(b, BLOCK_KIND) != LIMIT || (block(b, BLOCK_SOURCE) >> 1u) != c) {
            continue;
        }
        let a = block(b, BLOCK_ROW);
        switch part {
            case 0u: {
                return row(POSITION + a) - margin;
            }
            case 1u: {
                return row(VELOCITY + a);
            }
            default: {
                return row(FORCE + a);
            }
        }
    }
    return 0.0;
}

// Returns the momentum of a body and its descendants about the world's origin.
fn subtree_momentum(s: u32) -> Spatial {
    var sum = Spatial(vec3f(), vec3f());
    for (var b = words[s + SENSOR_OBJECT]; b < words[s + SENSOR_REFERENCE]; b++) {
        let own = momentum(CINERT + 10u * b, fetch_spatial(CVEL + 6u * b));
        let root = fetch3(SUBTREE_COM + 3u * words[BODY_ROOT + b]);
        sum = plus(sum, Spatial(own.angular + cross(root, own.linear), own.linear));
    }
    return sum;
}

fn read_subtree(kind: u32, s: u32, out: u32) {
    let body = words[s + SENSOR_OBJECT];
    let com = fetch3(SUBTREE_COM + 3u * body);
    switch kind {
        case SENSE_SUBTREECOM: {
            put3(out, com);
        }
        case SENSE_SUBTREEANGMOM: {
            let all = subtree_momentum(s);
            put3(out, all.angular - cross(com, all.linear));
        }
        case SENSE_SUBTREELINVEL, default: {
            let mass = parameter(BODY_SUBTREEMASS + body);
            put3(out, select(subtree_momentum(s).linear / mass, vec3f(), mass <= 0.0));
        }
    }
}

fn read_scalar(kind: u32, s: u32, prm: u32) -> f32 {
    let e = words[s + SENSOR_OBJECT];
    switch kind {
        case SENSE_TOUCH: {
            return touch(s, prm);
        }
        case SENSE_INSIDESITE: {
            let inside = is_inside(s, prm, object_position(words[s + SENSOR_OBJECT_KIND], e));
            return select(f32(0.0), f32(1.0), inside);
        }
        case SENSE_CLOCK: {
            return clock();
        }
        case SENSE_E_POTENTIAL: {
            return fetch(MECHANICAL_ENERGY);
        }
        case SENSE_E_KINETIC: {
            return fetch(MECHANICAL_ENERGY + 1u);
        }
        case SENSE_JOINTPOS: {
            return fetch_state(QPOS + words[JNT_QPOS + e]);
        }
        case SENSE_JOINTVEL: {
            return fetch_state(QVEL + words[JNT_DOF + e]);
        }
        case SENSE_JOINTACTUATORFRC: {
            return fetch(QFRC_ACTUATOR + words[JNT_DOF + e]);
        }
        case SENSE_JOINTLIMITPOS, SENSE_TENDONLIMITPOS: {
            return limit(e, parameter(prm + SENSOR_PRM_MARGIN), 0u);
        }
        case SENSE_JOINTLIMITVEL, SENSE_TENDONLIMITVEL: {
            return limit(e, parameter(prm + SENSOR_PRM_MARGIN), 1u);
        }
        case SENSE_JOINTLIMITFRC, SENSE_TENDONLIMITFRC: {
            return limit(e, parameter(prm + SENSOR_PRM_MARGIN), 2u);
        }
        case SENSE_TENDONPOS: {
            return fetch(TEN_LENGTH + e);
        }
        case SENSE_TENDONVEL: {
            return fetch(TEN_VELOCITY + e);
        }
        case SENSE_TENDONACTUATORFRC: {
            var sum: f32 = 0.0;
            for (var k = words[TENDON_PULL + e]; k < words[TENDON_PULL + e + 1u]; k++) {
                sum += fetch(ACTUATOR_FORCE + words[PULL_OUTPUT + k]);
            }
            return sum;
        }
        default: {
            return 0.0;
        }
    }
}

fn read_sensor(s: u32, prm: u32, out: u32) {
    let kind = words[s + SENSOR_KIND];
    let e = words[s + SENSOR_OBJECT];
    switch words[s + SENSOR_METHOD] {
        case OF_FRAME: {
            read_frame(kind, s, out);
        }
        case OF_SITE: {
            read_site(kind, e, out);
        }
        case OF_SUBTREE: {
            read_subtree(kind, s, out);
        }
        case OF_BALL: {
            switch kind {
                case SENSE_BALLQUAT: {
                    put4(out, quat_normalize(fetch_state4(QPOS + words[JNT_QPOS + e])));
                }
                case SENSE_BALLANGVEL, default: {
                    put3(out, fetch_state3(QVEL + words[JNT_DOF + e]));
                }
            }
        }
        case OF_ACTUATOR: {
            var offset: u32;
            switch kind {
                case SENSE_ACTUATORPOS: {
                    offset = ACTUATOR_LENGTH;
                }
                case SENSE_ACTUATORVEL: {
                    offset = ACTUATOR_VELOCITY;
                }
                case SENSE_ACTUATORFRC, default: {
                    offset = ACTUATOR_FORCE;
                }
            }
            for (var k = 0u; k < words[s + SENSOR_DIM]; k++) {
                put(out + k, fetch(offset + e + k));
            }
        }
        case OF_CONTACTS: {
            read_contacts(s, prm, out);
        }
        case OF_DISTANCE: {
            read_distance(kind, s, prm, out);
        }
        case OF_PROJECTION: {
            let seen = project(e, words[s + SENSOR_REFERENCE]);
            put(out, seen.x);
            put(out + 1u, seen.y);
        }
        case OF_ENCLOSED: {
            if (ANY_ENCLOSED) {
                put(out, protrusion(e, words[s + SENSOR_REFERENCE]));
            }
        }
        // The kernels of rays and skins have already written these.
        case OF_ELSEWHERE: {
        }
        case OF_NOTHING: {
            for (var k = 0u; k < words[s + SENSOR_DIM]; k++) {
                put(out + k, 0.0);
            }
        }
        case OF_SCALAR, default: {
            put(out, read_scalar(kind, s, prm));
        }
    }
}

// Clamps the numbers of a sensor.
fn clip(s: u32, out: u32, least: f32, most: f32) {
    for (var k = 0u; k < words[s + SENSOR_DIM]; k++) {
        put(out + k, max(min(fetch(out + k), most), least));
    }
}

@compute @workgroup_size(GROUP)
fn sensors(@builtin(global_invocation_id) id: vec3u) {
    if (!SENSING || !begin(id.x)) {
        return;
    }
    for (var i = 0u; i < bound(NSENSOR); i++) {
        let s = SENSORS + SENSOR_SIZE * i;
        let prm = SENSOR_PRM + SENSOR_PRM_SIZE * i;
        let out = SENSORDATA + words[s + SENSOR_OFFSET];
        read_sensor(s, prm, out);
        let cutoff = parameter(prm + SENSOR_PRM_CUTOFF);
        switch words[s + SENSOR_CLIP] {
            case CLIPPED: {
                clip(s, out, -cutoff, cutoff);
            }
            case CLIPPED_ABOVE: {
                clip(s, out, -3e38, cutoff);
            }
            case UNCLIPPED, default: {
            }
        }
        if (ANY_SENSOR_HISTORY && words[s + SENSOR_HISTORY] != NONE) {
            delay_sensor(s, prm, out);
        }
    }
}
