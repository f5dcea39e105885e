// Newton's method for the direction of the largest gap, near it. CPU counterpart:
// `clench-collide/src/narrow/convex/refine.rs`, which derives the steps.

// The cosine of the maximum rotation of a step.
const MAX_ROTATION_COSINE: f32 = 0.955336489125606;
// The rotation of a converged step.
const CONVERGED_ROTATION: f32 = max(2e-6, 256.0 * EPSILON);

// Orthonormal directions of the touching edges: none, one, or two that span a face (or cross).
var<private> edges: array<vec3f, 2>;
var<private> edge_count: u32;

fn extend_edges(edge: vec3f) {
    let whole = length(edge);
    if (edge_count == 2u || whole <= SMALLEST) {
        return;
    }
    var rest = edge;
    if (edge_count == 1u) {
        rest -= edges[0] * dot(edges[0], edge);
    }
    let left = length(rest);
    if (left > whole * ROOT_OF_EPSILON * 64.0) {
        edges[edge_count] = rest / left;
        edge_count++;
    }
}

// Finds the span of the edges between the corners of the simplex's vertices.
fn find_edges() {
    edge_count = 0u;
    let a = corner_of(body_a, simplex[0].a);
    let b = corner_of(body_b, simplex[0].b);
    for (var k = 1u; k < simplex_count; k++) {
        extend_edges(corner_of(body_a, simplex[k].a) - a);
        extend_edges(rotation_b * (corner_of(body_b, simplex[k].b) - b));
    }
}

// Returns the direction nearest to `n` across the edges; `n` if there is none.
fn across_edges(n: vec3f) -> vec3f {
    var left = n;
    if (edge_count == 2u) {
        let normal = cross(edges[0], edges[1]);
        left = normal * dot(normal, n);
    } else if (edge_count == 1u) {
        left = n - edges[0] * dot(edges[0], n);
    }
    let size = length(left);
    if (size > 0.5) {
        return left / size;
    }
    return n;
}

// Returns true if rotating off the one edge, to either side, would make the gap smaller.
fn edge_holds(n: vec3f) -> bool {
    if (edge_count != 1u) {
        return true;
    }
    for (var k = 0u; k < bound(2u); k++) {
        let side = select(-edges[0], edges[0], k == 0u);
        if (dot(side, vertex_against(n, n + side * ROOT_OF_EPSILON).w) > exactness) {
            return false;
        }
    }
    return true;
}

// Returns the step, and in w 0 if there is none, 1 if the gap curves up in one direction, 2 if down in both.
fn newton_step(at: Gap, w: vec3f) -> vec4f {
    let back = transpose(rotation_b);
    let of_a = curvature_of(body_a, at.normal);
    let of_b = curvature_of(body_b, back * at.normal);
    if (edge_count == 1u) {
        let e = cross(at.normal, edges[0]);
        let bend = between(of_a, e, e) + between(of_b, back * e, back * e) + at.gap;
        if (bend <= 0.0) {
            return vec4f();
        }
        return vec4f(e * (dot(e, w) / bend), 2.0);
    }
    let frame = across(at.normal);
    let e = frame.e;
    let f = frame.f;
    var ee = between(of_a, e, e) + between(of_b, back * e, back * e);
    let ef = between(of_a, e, f) + between(of_b, back * e, back * f);
    var ff = between(of_a, f, f) + between(of_b, back * f, back * f);
    let mean = (ee + ff) * 0.5 + at.gap;
    let spread = sqrt((ee - ff) * (ee - ff) * 0.25 + ef * ef);
    let largest = mean + spread;
    if (largest <= 0.0) {
        return vec4f();
    }
    // Around an axis that both bodies share the gap is constant; on a saddle, away from it is up.
    let least = largest * 1e-6;
    let shift = max(least - (mean - spread), 0.0);
    ee += at.gap + shift;
    ff += at.gap + shift;
    let inverse = 1.0 / (ee * ff - ef * ef);
    let we = dot(e, w);
    let wf = dot(f, w);
    let rotation = e * ((ff * we - ef * wf) * inverse) + f * ((ee * wf - ef * we) * inverse);
    return vec4f(rotation, select(f32(1.0), f32(2.0), mean - spread > -least));
}

// Returns the best cap of a cylinder that roughly faces `n`, if the gap across it is larger than `gap`. It is exact
// if the cap touches; else, if the gap grows next to it, the normal is a start direction.
fn refine_cap(n: vec3f, gap: f32) -> Gap {
    var found = Gap(n, gap, false);
    for (var side = 0u; side < bound(2u); side++) {
        var body = body_a;
        var axis = vec3f(0.0, 0.0, 1.0);
        if (side == 1u) {
            body = body_b;
            axis = rotation_b[2];
        }
        let cosine = dot(axis, n);
        if (body.kind != CYLINDER || abs(cosine) < MAX_ROTATION_COSINE) {
            continue;
        }
        axis = axis * signed(1.0, cosine);
        let vertex = vertex_along(axis);
        let along = dot(axis, vertex.w);
        if (along <= found.gap) {
            continue;
        }
        // From the centre of the cap to the other body's point: if it is outside the disc, the gap grows towards it.
        var to_middle = rotation_b * (corner_of(body, vertex.b) - vertex.b);
        if (side == 0u) {
            to_middle = vertex.a - corner_of(body, vertex.a);
        }
        var lateral = vertex.w + to_middle;
        lateral -= axis * dot(axis, lateral);
        let toward = direction(lateral);
        if (toward.w <= body.size.x || toward.w <= TINY) {
            found = Gap(axis, along, true);
            continue;
        }
        // Next to the axis, because on the axis itself no point of the circle is distinguished.
        let back = transpose(rotation_b);
        let start = axis + toward.xyz * ROOT_OF_EPSILON;
        let bend = between(curvature_of(body_a, start), toward.xyz, toward.xyz)
            + between(curvature_of(body_b, back * start), back * toward.xyz, back * toward.xyz);
        let rotation = (toward.w - body.size.x) / max(bend + along, exactness);
        found = Gap(direction(axis + toward.xyz * clamp(rotation, ROOT_OF_EPSILON, REFINE_MAX_ROTATION)).xyz, along, false);
    }
    return found;
}

// Returns the largest gap near a direction, across the edges, by Newton's method; a step that loses is halved.
fn refine(n: vec3f) -> Gap {
    var tried = across_edges(n);
    var at = Gap(tried, -UNMOVABLE, false);
    // The current step, the gap that it must exceed, and the number of halvings.
    var step = vec4f();
    var size = UNMOVABLE;
    var before = -UNMOVABLE;
    var halvings = 0u;
    var steps = 0u;
    var may_leave = ANY_CYLINDER && (body_a.kind == CYLINDER || body_b.kind == CYLINDER);
    for (var round = 0u; round < bound(REFINE_STEPS * (REFINE_HALVINGS + 2u)); round++) {
        let w = vertex_along(tried).w;
        let gap = dot(tried, w);
        if (!(gap >= before - exactness * 1e-3)) {
            step = step * vec4f(0.5, 0.5, 0.5, 1.0);
            halvings++;
            if (halvings > REFINE_HALVINGS) {
                return at;
            }
            tried = direction(at.normal + step.xyz).xyz;
            continue;
        }
        at = Gap(tried, gap, false);
        if (edge_count == 2u || steps == REFINE_STEPS) {
            return at;
        }
        if (may_leave) {
            // Only once.
            may_leave = false;
            let from_cap = refine_cap(tried, gap);
            if (from_cap.is_exact) {
                return from_cap;
            }
            if (from_cap.gap > gap) {
                tried = from_cap.normal;
                continue;
            }
        }
        if (size <= CONVERGED_ROTATION && gap - before <= exactness) {
            at.is_exact = step.w == 2.0 && edge_holds(tried);
            return at;
        }
        step = newton_step(at, w);
        if (step.w == 0.0) {
            return at;
        }
        size = length(step.xyz);
        step = vec4f(step.xyz * min(1.0, REFINE_MAX_ROTATION / max(size, SMALLEST)), step.w);
        before = gap;
        halvings = 0u;
        steps++;
        tried = direction(tried + step.xyz).xyz;
    }
    return at;
}
