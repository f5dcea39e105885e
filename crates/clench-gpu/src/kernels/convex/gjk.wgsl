// The distance of two separate cores (Gilbert, Johnson & Keerthi 1988). CPU counterpart:
// `clench-collide/src/narrow/convex/gjk.rs`, except that Newton's method runs after the search, because its text is
// long.

// The distance below which its direction is noise, relative to the smaller body.
const TOUCHING: f32 = 4.0 * ROOT_OF_EPSILON;

// The outcomes of a search: a gap beyond the limit, the origin seems inside, nothing is nearer.
const BEYOND: u32 = 0u;
const INSIDE: u32 = 1u;
const NEAREST: u32 = 2u;

struct End {
    how: u32,
    length: f32,
}

// The gap along the start direction of the first search.
var<private> first_gap: f32;

// Adds vertices until nothing is nearer, starting with the one along the best direction.
fn search_nearest(limit: f32) -> End {
    var v = best.normal;
    var square = UNMOVABLE;
    for (var round = 0u; round <= bound(GJK_ROUNDS); round++) {
        let vertex = vertex_along(v);
        if (round == 0u) {
            begin_simplex(vertex);
            if (best.gap == -UNMOVABLE) {
                best.gap = dot(v, vertex.w);
                first_gap = best.gap;
            }
            v = vertex.w;
        } else {
            let n = v / sqrt(square);
            let gap = dot(n, vertex.w);
            improve(Gap(n, gap, false));
            if (sqrt(square) - gap <= exactness) {
                return End(NEAREST, sqrt(square));
            }
            let nearest = add_vertex(vertex);
            if (nearest.w == 0.0) {
                return End(INSIDE, 0.0);
            }
            if (dot(nearest.xyz, nearest.xyz) >= square) {
                // Rounding prevents further progress.
                return End(NEAREST, sqrt(square));
            }
            v = nearest.xyz;
        }
        square = dot(v, v);
        if (best.gap > limit) {
            return End(BEYOND, 0.0);
        }
        if (sqrt(square) <= smallest * TOUCHING) {
            return End(INSIDE, 0.0);
        }
        if (sqrt(square) - best.gap <= exactness) {
            return End(NEAREST, sqrt(square));
        }
    }
    return End(NEAREST, length(v));
}

// Finds the distance of the cores if it is at most `limit`, in `best`: BEYOND, NEAREST, or INSIDE if they overlap or
// touch. Nearly coincident vertices form slivers, whose nearest point may be wrong: then another search starts with the
// best known direction.
fn gjk(limit: f32) -> u32 {
    var end = End(NEAREST, 0.0);
    for (var attempt = 0u; attempt < bound(2u); attempt++) {
        end = search_nearest(limit);
        let inside = end.how == INSIDE && best.gap > exactness;
        let short = end.how == NEAREST && end.length - best.gap > max(smallest * GJK_MAX_DIFFERENCE, exactness);
        if (!inside && !short) {
            break;
        }
    }
    if (end.how == INSIDE && best.gap > exactness) {
        return NEAREST;
    }
    return end.how;
}
