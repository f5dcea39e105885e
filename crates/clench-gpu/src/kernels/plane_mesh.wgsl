// A hull on a plane. CPU counterpart: `clench-collide/src/narrow/plane_mesh.rs`.

var<private> visited: array<u32, PATCH_POINTS>;
var<private> visited_count: u32;

// Returns a point of the hull, in its frame, and in w its height above the plane.
fn above_plane(p: vec3f, up: vec3f, origin: f32) -> vec4f {
    return vec4f(p, origin + dot(up, p));
}

// Adds the contact of a point of the hull.
fn add_candidate(pair: u32, mesh: Placed, at: vec4f, normal: vec3f) {
    let position = mesh.center + mesh.axes * at.xyz - normal * (at.w * 0.5);
    add_contact(pair, at.w, position, normal, tangent_from_normal(normal));
}

// Visits a vertex if it is within range, new, and within the capacity.
fn visit(vertex: u32, height: f32, range: f32) {
    if (height > range || visited_count == PATCH_POINTS) {
        return;
    }
    for (var k = 0u; k < visited_count; k++) {
        if (visited[k] == vertex) {
            return;
        }
    }
    visited[visited_count] = vertex;
    visited_count++;
}

// Visits the deepest vertex, those of the face that lies on the plane, and others around them: all within range, up to
// the capacity.
fn visit_near(hull: u32, deepest: u32, face: u32, up: vec3f, origin: f32, range: f32) {
    visited_count = 0u;
    visit(deepest, above_plane(vertex_of_hull(hull, deepest), up, origin).w, range);
    let neighbors = words[hull + HULL_NEIGHBORS];
    var begin = 0u;
    var end = 0u;
    if (face != NONE) {
        begin = words[words[hull + HULL_FACE_CORNERS] + face];
        end = words[words[hull + HULL_FACE_CORNERS] + face + 1u];
    }
    // The face's corners first, then the neighbours of each vertex that has been visited.
    for (var next = 0u; next <= visited_count && visited_count < PATCH_POINTS; next++) {
        if (next > 0u) {
            begin = words[neighbors + visited[next - 1u]];
            end = words[neighbors + visited[next - 1u] + 1u];
        }
        for (var k = begin; k < end; k++) {
            let vertex = words[k];
            visit(vertex, above_plane(vertex_of_hull(hull, vertex), up, origin).w, range);
        }
    }
}

// Adds points of the outline of a face with many corners, sampled from its first edge, or from the direction of the
// deepest vertex, including that, if these miss it.
fn add_outline(pair: u32, mesh: Placed, hull: u32, face: u32, lowest: vec4f, normal: vec3f, up: vec3f, origin: f32, range: f32) {
    let corners = words[hull + HULL_FACE_CORNERS] + face;
    let begin = words[corners];
    let count = words[corners + 1u] - begin;
    let start = vertex_of_hull(hull, words[begin]);
    let along = direction(vertex_of_hull(hull, words[begin + 1u]) - start).xyz;
    let sideways = cross(plane_of_hull(hull, face).xyz, along);
    polygon_count = 0u;
    for (var k = 0u; k < count; k += (count + MAX_FACE_CORNERS - 1u) / MAX_FACE_CORNERS) {
        let arm = vertex_of_hull(hull, words[begin + k]) - start;
        push_corner(vec3f(dot(along, arm), dot(sideways, arm), 0.0));
    }
    let size = length(mesh.size);
    let same = size * PLANE_SAME_POINT;
    make_convex(same);
    find_moments();
    var toward = vec2f(1.0, 0.0);
    var least = UNMOVABLE;
    var lowest_at = NONE;
    for (var attempt = 0u; attempt < bound(2u); attempt++) {
        sample_outline(toward, same);
        least = UNMOVABLE;
        for (var k = 0u; k < sampled_count; k++) {
            let at = start + along * sampled[k].x + sideways * sampled[k].y;
            let height = above_plane(at, up, origin).w;
            if (height < least) {
                least = height;
                lowest_at = k;
            }
        }
        if (attempt == 0u && least - lowest.w <= size * PLANE_MISS) {
            break;
        }
        let arm = lowest.xyz - start;
        toward = vec2f(dot(along, arm), dot(sideways, arm)) - outline_middle;
        lowest_at = NONE;
    }
    for (var k = 0u; k < sampled_count; k++) {
        var at = above_plane(start + along * sampled[k].x + sideways * sampled[k].y, up, origin);
        if (k == lowest_at) {
            // The remaining difference is too small to move a point, but is still reported.
            at.w = min(least, lowest.w);
        } else if (lowest_at == NONE && k == 0u) {
            at = lowest;
        }
        if (at.w <= range) {
            add_candidate(pair, mesh, at, normal);
        }
    }
}

fn plane_mesh(pair: u32, normal: vec3f, above: f32, mesh: Placed, hull: u32, range: f32) {
    let up = transpose(mesh.axes) * normal;
    let deepest = furthest_of_hull(hull, -up);
    let lowest = above_plane(vertex_of_hull(hull, deepest), up, above);
    if (lowest.w > range) {
        return;
    }
    let face = face_across(hull, deepest, -up);
    if (LARGE_FACES && face != NONE) {
        let corners = words[hull + HULL_FACE_CORNERS] + face;
        if (words[corners + 1u] - words[corners] > PATCH_POINTS) {
            add_outline(pair, mesh, hull, face, lowest, normal, up, above, range);
            return;
        }
    }
    visit_near(hull, deepest, face, up, above, range);
    for (var k = 0u; k < visited_count; k++) {
        add_candidate(pair, mesh, above_plane(vertex_of_hull(hull, visited[k]), up, above), normal);
    }
}
