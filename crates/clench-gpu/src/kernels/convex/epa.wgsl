// The penetration depth of two cores: the expanding polytope algorithm (van den Bergen 2001). CPU counterpart:
// `clench-collide/src/narrow/convex/epa.rs`.

// Returns the distance of `w` from the first vertex, the line of the first two, or the plane of the first three.
fn reach_from(stage: u32, w: vec3f, along: vec3f, normal: vec3f) -> f32 {
    let offset = w - polytope_w(0u);
    if (stage == 1u) {
        return length(offset);
    }
    if (stage == 2u) {
        return length(cross(offset, along));
    }
    return abs(dot(offset, normal));
}

// Returns direction `k` of the search for a vertex further away.
fn direction_of_stage(stage: u32, k: u32, along: vec3f, normal: vec3f) -> vec3f {
    var found = normal;
    if (stage == 1u) {
        found = vec3f();
        found[k >> 1u] = 1.0;
    } else if (stage == 2u) {
        let frame = across(along);
        found = select(frame.e, frame.f, k >> 1u == 1u);
    }
    return select(found, -found, (k & 1u) == 1u);
}

// Finds four vertices with a volume, preferably from the simplex. Returns false if the difference has no volume: `best`
// is then the gap across it.
fn enclose() -> bool {
    vertex_count = 0u;
    push_vertex(simplex[0]);
    var along = vec3f();
    var normal = vec3f();
    for (var stage = 1u; stage < bound(4u); stage++) {
        var furthest = simplex[0];
        var max_reach: f32 = 0.0;
        var across_gap = Gap(vec3f(), -UNMOVABLE, false);
        let directions = 8u - 2u * stage;
        for (var k = 0u; k < simplex_count + directions; k++) {
            var vertex = simplex[min(k, 3u)];
            if (k >= simplex_count) {
                // The simplex has a vertex far enough away.
                if (max_reach > smallest * EPA_FAR) {
                    break;
                }
                let n = direction_of_stage(stage, k - simplex_count, along, normal);
                vertex = vertex_along(n);
                let gap = dot(n, vertex.w);
                if (k < simplex_count + 2u && gap > across_gap.gap) {
                    across_gap = Gap(n, gap, false);
                }
            }
            let reach = reach_from(stage, vertex.w, along, normal);
            if (reach > max_reach) {
                max_reach = reach;
                furthest = vertex;
            }
        }
        if (max_reach <= largest * EPSILON * 16.0) {
            best = across_gap;
            return false;
        }
        push_vertex(furthest);
        if (stage == 1u) {
            along = direction(furthest.w - polytope_w(0u)).xyz;
        } else if (stage == 2u) {
            normal = direction(cross(along, furthest.w - polytope_w(0u))).xyz;
        }
    }
    return true;
}

// Sets the simplex to the corners of a face.
fn touch(corners: vec3u) {
    simplex[0] = polytope_vertex(corners.x);
    simplex[1] = polytope_vertex(corners.y);
    simplex[2] = polytope_vertex(corners.z);
    simplex_count = 3u;
}

fn corners_of(face: u32) -> vec3u {
    return vec3u(fetch3(face_at(face)));
}

// The state of an expansion: the corners of the face of the best direction, whether Newton's method has refined that,
// and whether the depth is known.
var<private> touching: vec3u;
var<private> refined: bool;
var<private> converged: bool;

// Begins with the depth along the start direction of the search.
fn begin_expansion(start: vec3f) {
    begin_polytope();
    best = Gap(start, first_gap, false);
    touching = corners_of(0u);
    refined = false;
    converged = false;
}

// Grows the polytope until the depth is known, in `best`, or, for curved bodies, until a better direction is worth
// refining. Then it returns false, with the touching simplex. At the end the simplex is the face of the gap.
fn expand(curved: bool) -> bool {
    for (var round = 0u; round < bound(2u * POLYTOPE_VERTICES); round++) {
        let face = nearest_face_of_polytope();
        let distance = fetch(face_at(face) + 10u);
        // The amount by which the depth through the nearest face may still be smaller.
        let slack = select(exactness, max(smallest * EPA_SLACK, exactness), best.is_exact);
        let corners = corners_of(face);
        converged = -best.gap - distance <= slack;
        if (converged && !best.is_exact && distance < UNMOVABLE) {
            touching = corners;
        }
        if (converged || vertex_count == POLYTOPE_VERTICES) {
            break;
        }
        let outward = fetch3(face_at(face) + 6u);
        let vertex = vertex_along(-outward);
        let raw = Gap(-outward, -dot(outward, vertex.w), false);
        let movable = -raw.gap - distance;
        let better = improve(raw);
        refined = refined && !better;
        converged = movable <= exactness;
        if (better || (converged && !best.is_exact)) {
            touching = corners;
        }
        if (converged) {
            break;
        }
        if (!add_to_polytope(face, vertex)) {
            // Rounding allows no further movement.
            put(face_at(face) + 10u, UNMOVABLE);
        }
        if (better && curved && movable < max(smallest, distance) * EPA_NEAR) {
            touch(corners);
            return false;
        }
    }
    touch(touching);
    return true;
}

// Tries directions across two creases of the gap: the normals of flat faces, and the directions across an edge of each
// body. If the polytope is full, the smallest of nearly equal depths lies there.
fn try_crossings() {
    let own = mat3x3f(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    for (var k = 0u; k < bound(15u); k++) {
        var n = vec3f();
        if (k < 3u && has_face(body_a, k)) {
            n = own[k];
        } else if (k >= 3u && k < 6u && has_face(body_b, k - 3u)) {
            n = rotation_b[k - 3u];
        } else if (k >= 6u && has_edge(body_a, (k - 6u) / 3u) && has_edge(body_b, (k - 6u) % 3u)) {
            n = cross(own[(k - 6u) / 3u], rotation_b[(k - 6u) % 3u]);
        }
        let size = length(n);
        if (size > ROOT_OF_EPSILON) {
            n = n * (signed(1.0, dot(n, offset_b)) / size);
            improve(Gap(n, dot(n, vertex_along(n).w), false));
        }
    }
}

fn has_face(body: Body, axis: u32) -> bool {
    return body.kind == BOX || (body.kind == CYLINDER && axis == 2u);
}

fn has_edge(body: Body, axis: u32) -> bool {
    return body.kind == BOX || ((body.kind == CYLINDER || body.kind == CAPSULE) && axis == 2u);
}
