// Contacts between two sides. CPU counterpart: `sensor/contact.rs`, which explains the signs.
//
// A query is a row of words: QUERY_SIZE words, the fields, and for each geom the flags of its sides.

// Returns 1 or −1 if a contact matches, by the order of its geoms; 0 if it does not.
fn match_sign(s: u32, prm: u32, c: u32) -> f32 {
    let query = QUERIES + words[s + SENSOR_OBJECT];
    let sides = query + QUERY_SIZE + words[query + QUERY_NFIELD];
    let offset = CONTACTS + CONTACT_SIZE * c;
    let pair = u32(fetch(offset));
    let a = words[sides + words[PAIR_GEOM + 2u * pair]];
    let b = words[sides + words[PAIR_GEOM + 2u * pair + 1u]];
    if (words[s + SENSOR_REFERENCE] != NONE && !is_inside(s, prm, fetch3(offset + 2u))) {
        return 0.0;
    }
    if ((a & FIRST_SIDE) != 0u && (b & SECOND_SIDE) != 0u) {
        return 1.0;
    }
    return select(f32(0.0), f32(-1.0), (b & FIRST_SIDE) != 0u && (a & SECOND_SIDE) != 0u);
}

// Returns the force and torque of a contact on its second geom in its frame; zero if it is no constraint. Blocks of
// contacts come last, in their order, before the couplings of a metric.
fn contact_wrench(c: u32) -> Spatial {
    let count = reports[NBLOCK * envs + env];
    for (var b = count - min(count, reports[NCON * envs + env] - c + NCOUPLING); b < count; b++) {
        if (block(b, BLOCK_KIND) >= CONTACT_NORMAL && block(b, BLOCK_SOURCE) == c) {
            return block_wrench(b);
        }
    }
    return Spatial(vec3f(), vec3f());
}

fn contact_frame(c: u32) -> mat3x3f {
    let offset = CONTACTS + CONTACT_SIZE * c;
    return mat3x3f(fetch3(offset + 5u), fetch3(offset + 8u), fetch3(offset + 11u));
}

// Returns the motion of the second body relative to the first at the contact, in its frame.
fn relative_motion(c: u32) -> Spatial {
    let offset = CONTACTS + CONTACT_SIZE * c;
    let pair = u32(fetch(offset));
    let first = velocity_at(words[PAIR_BODY + 2u * pair], fetch3(offset + 2u));
    let second = velocity_at(words[PAIR_BODY + 2u * pair + 1u], fetch3(offset + 2u));
    let axes = contact_frame(c);
    return Spatial((second.angular - first.angular) * axes, (second.linear - first.linear) * axes);
}

// Returns the sort key of contacts, in ascending order.
fn contact_key(reduction: u32, c: u32) -> f32 {
    switch reduction {
        case MIN_DIST: {
            return fetch(CONTACTS + CONTACT_SIZE * c + 1u);
        }
        case MAX_FORCE: {
            let force = contact_wrench(c).linear;
            return -dot(force, force);
        }
        case FIRST_ONES, NET_FORCE, default: {
            return 0.0;
        }
    }
}

// The data of one contact, or of all matches together.
struct ContactData {
    wrench: Spatial,
    motion: Spatial,
    distance: f32,
    position: vec3f,
    normal: vec3f,
    tangent: vec3f,
}

fn contact_data(c: u32, sign: f32) -> ContactData {
    let offset = CONTACTS + CONTACT_SIZE * c;
    let turned = vec3f(1.0, 1.0, sign);
    let wrench = contact_wrench(c);
    let motion = relative_motion(c);
    return ContactData(
        Spatial(wrench.angular * turned, wrench.linear * turned),
        Spatial(motion.angular * turned, motion.linear * turned),
        fetch(offset + 1u),
        fetch3(offset + 2u),
        fetch3(offset + 5u) * sign,
        fetch3(offset + 8u) * sign,
    );
}

// Returns all matches as one contact in world axes, at the force-weighted mean of their positions.
fn net_force(s: u32, prm: u32) -> ContactData {
    var net = ContactData();
    var weight: f32 = 0.0;
    for (var c = 0u; c < reports[NCON * envs + env]; c++) {
        let sign = match_sign(s, prm, c);
        if (sign != 0.0) {
            let force = contact_frame(c) * contact_wrench(c).linear * sign;
            net.wrench.linear += force;
            net.position += fetch3(CONTACTS + CONTACT_SIZE * c + 2u) * length(force);
            weight += length(force);
            net.normal.x = 1.0;
            net.tangent.y = 1.0;
        }
    }
    net.position /= select(f32(1.0), weight, weight > 0.0);
    for (var c = 0u; c < reports[NCON * envs + env]; c++) {
        let sign = match_sign(s, prm, c);
        if (sign != 0.0) {
            let wrench = contact_wrench(c);
            let axes = contact_frame(c);
            let arm = fetch3(CONTACTS + CONTACT_SIZE * c + 2u) - net.position;
            net.wrench.angular += axes * wrench.angular * sign + cross(arm, axes * wrench.linear * sign);
        }
    }
    return net;
}

fn write_contact_data(query: u32, count: f32, data: ContactData, first: u32) {
    var out = first;
    for (var k = 0u; k < words[query + QUERY_NFIELD]; k++) {
        var numbers = vec3f();
        var scalar = false;
        switch words[query + QUERY_SIZE + k] {
            case CONTACT_DATA_FOUND: {
                numbers.x = count;
                scalar = true;
            }
            case CONTACT_DATA_FORCE: {
                numbers = data.wrench.linear;
            }
            case CONTACT_DATA_TORQUE: {
                numbers = data.wrench.angular;
            }
            case CONTACT_DATA_DIST: {
                numbers.x = data.distance;
                scalar = true;
            }
            case CONTACT_DATA_POS: {
                numbers = data.position;
            }
            case CONTACT_DATA_NORMAL: {
                numbers = data.normal;
            }
            case CONTACT_DATA_TANGENT: {
                numbers = data.tangent;
            }
            case CONTACT_DATA_LINVEL: {
                numbers = data.motion.linear;
            }
            case CONTACT_DATA_ANGVEL, default: {
                numbers = data.motion.angular;
            }
        }
        put(out, numbers.x);
        if (!scalar) {
            put(out + 1u, numbers.y);
            put(out + 2u, numbers.z);
        }
        out += select(3u, 1u, scalar);
    }
}

// Returns the matching contact that follows another by its key, then by its index; NONE if there is none.
fn next_match(s: u32, prm: u32, last: u32) -> u32 {
    let reduction = words[QUERIES + words[s + SENSOR_OBJECT] + QUERY_REDUCTION];
    var last_key: f32 = 0.0;
    if (last != NONE) {
        last_key = contact_key(reduction, last);
    }
    var best = NONE;
    var best_key: f32 = 0.0;
    for (var c = 0u; c < reports[NCON * envs + env]; c++) {
        if (match_sign(s, prm, c) == 0.0) {
            continue;
        }
        let key = contact_key(reduction, c);
        let follows = last == NONE || key > last_key || (key == last_key && c > last);
        if (follows && (best == NONE || key < best_key)) {
            best = c;
            best_key = key;
        }
    }
    return best;
}

// Reads a contact sensor; unused slots are zero.
fn read_contacts(s: u32, prm: u32, out: u32) {
    let query = QUERIES + words[s + SENSOR_OBJECT];
    var count: f32 = 0.0;
    for (var c = 0u; c < reports[NCON * envs + env]; c++) {
        count += abs(match_sign(s, prm, c));
    }
    let size = words[query + QUERY_WIDTH];
    let net = words[query + QUERY_REDUCTION] == NET_FORCE;
    var last = NONE;
    for (var first = 0u; first < words[s + SENSOR_DIM]; first += size) {
        var data = ContactData();
        var matches = count;
        if (net) {
            data = net_force(s, prm);
        } else if (f32(first / size) < count) {
            last = next_match(s, prm, last);
            data = contact_data(last, match_sign(s, prm, last));
        } else {
            matches = 0.0;
        }
        write_contact_data(query, matches, data, out + first);
    }
}
