// Surfaces that move while their geoms do not. CPU counterpart: `contact/surface.rs`.

// Returns the velocity of the second geom's surface relative to the first's at the contact: along both tangents, and
// about the normal.
fn surface_velocity(contact: u32) -> vec3f {
    let offset = CONTACTS + CONTACT_SIZE * contact;
    let pair = u32(fetch(offset));
    let point = fetch3(offset + 2u);
    var linear = vec3f();
    var angular = vec3f();
    for (var side = 0u; side < 2u; side++) {
        let geom = words[PAIR_GEOM + 2u * pair + side];
        let axes = fetch_matrix(GEOM_XMAT + 9u * geom);
        let turning = axes * parameter3(GEOM_SURFACEVEL + 6u * geom + 3u);
        let along = axes * parameter3(GEOM_SURFACEVEL + 6u * geom);
        let sign = select(f32(-1.0), f32(1.0), side == 1u);
        linear += (along + cross(turning, point - fetch3(GEOM_XPOS + 3u * geom))) * sign;
        angular += turning * sign;
    }
    return vec3f(dot(fetch3(offset + 8u), linear), dot(fetch3(offset + 11u), linear), dot(fetch3(offset + 5u), angular));
}
