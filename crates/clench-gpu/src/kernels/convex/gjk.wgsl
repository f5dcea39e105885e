// Distance of two cores that are apart (Gilbert, Johnson & Keerthi 1988). Sister of `clench-collide/src/narrow/convex/gjk.rs`, but that
// Newton's method waits for the end of the search: its text is long.

const GJK_ROUNDS: u32 = 64u;
// Shares of the smaller body: below the first the direction between the cores is noise, the bounds may differ by the second.
const TOUCHING: f32 = 4.0 * 3.4526698e-4;
const DOUBT: f32 = 1e-6;

// How a search ends: a gap beyond the limit, the origin seems inside, nothing is nearer.
const BEYOND: u32 = 0u;
const INSIDE: u32 = 1u;
const NEAREST: u32 = 2u;

struct End {
    how: u32,
    length: f32,
}

// Adds vertices until nothing is nearer.
fn search_nearest(limit: f32) -> End {
    var v = simplex[0].w;
    for (var round = 0u; round < bound(GJK_ROUNDS); round++) {
        if (best.gap > limit) {
            return End(BEYOND, 0.0);
        }
        let square = dot(v, v);
        let size = sqrt(square);
        if (size <= smallest * TOUCHING) {
            return End(INSIDE, 0.0);
        }
        if (size - best.gap <= exactness) {
            return End(NEAREST, size);
        }
        let vertex = vertex_along(v);
        let n = v / size;
        let gap = dot(n, vertex.w);
        improve(Gap(n, gap, false));
        if (size - gap <= exactness) {
            return End(NEAREST, size);
        }
        let nearest = add_vertex(vertex);
        if (nearest.w == 0.0) {
            return End(INSIDE, 0.0);
        }
        if (dot(nearest.xyz, nearest.xyz) >= square) {
            // Rounding has the last word.
            return End(NEAREST, size);
        }
        v = nearest.xyz;
    }
    return End(NEAREST, length(v));
}

// The distance of the cores if it is at most `limit`, in `best`: BEYOND, NEAREST, or INSIDE where they overlap or touch. Vertices that
// nearly coincide make slivers, whose nearest point may be false: then another search begins with the best direction known.
fn gjk(limit: f32) -> u32 {
    var end = End(NEAREST, 0.0);
    for (var attempt = 0u; attempt < bound(2u); attempt++) {
        begin_simplex(vertex_along(best.normal));
        if (attempt == 0u) {
            best.gap = dot(best.normal, simplex[0].w);
        }
        end = search_nearest(limit);
        let inside = end.how == INSIDE && best.gap > exactness;
        let short = end.how == NEAREST && end.length - best.gap > max(smallest * DOUBT, exactness);
        if (!inside && !short) {
            break;
        }
    }
    if (end.how == INSIDE && best.gap > exactness) {
        return NEAREST;
    }
    return end.how;
}
