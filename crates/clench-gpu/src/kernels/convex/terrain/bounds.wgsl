// Bounds of a body along the axes and along slopes, with its radius, its margin and the tolerance, to select the
// triangles it may touch. CPU counterpart: `clench-collide/src/narrow/convex/terrain/bounds.rs`.

const BOUND_DIRECTIONS: u32 = 14u;

// The reach of the body along each direction, and its lowest point.
var<private> bounds: array<f32, BOUND_DIRECTIONS>;
var<private> lowest_point: vec3f;
// The first cell of the window, and its numbers of rows and columns.
var<private> window_first: vec2i;
var<private> window_size: vec2i;

// Returns a direction: up and down, along the axes, across both diagonals of cells, and down slopes along the axes.
fn direction_of_bound(k: u32) -> vec3f {
    let sign = select(f32(1.0), f32(-1.0), (k & 1u) == 1u);
    switch k >> 1u {
        case 0u: {
            return vec3f(0.0, 0.0, -sign);
        }
        case 1u: {
            return vec3f(sign, 0.0, 0.0);
        }
        case 2u: {
            return vec3f(0.0, sign, 0.0);
        }
        case 3u: {
            return vec3f(grid.step.y, -grid.step.x, 0.0) * sign;
        }
        case 4u: {
            return vec3f(grid.step.y, grid.step.x, 0.0) * sign;
        }
        case 5u: {
            return vec3f(sign, 0.0, -1.0);
        }
        default: {
            return vec3f(0.0, sign, -1.0);
        }
    }
}

// Finds the bounds of the second body, centred at `offset`, and the window of cells that they reach. Returns false if
// they are off the field.
fn begin_bounds(body: Body, rotation: mat3x3f, offset: vec3f, around: f32) -> bool {
    for (var k = 0u; k < bound(BOUND_DIRECTIONS); k++) {
        let d = direction(direction_of_bound(k));
        let local = d.xyz * rotation;
        let point = rotation * support(body, local, local) + offset;
        bounds[k] = (dot(point, d.xyz) + around) * d.w;
        if (k == 0u) {
            lowest_point = point;
        }
    }
    let top = grid.elevation;
    let low = vec2f(max(-bounds[3], -bounds[11] - top), max(-bounds[5], -bounds[13] - top));
    let high = vec2f(min(bounds[2], top + bounds[10]), min(bounds[4], top + bounds[12]));
    let over = all(low <= grid.half) && all(high >= -grid.half);
    if (!(over && -bounds[0] <= top && bounds[1] >= -grid.base)) {
        return false;
    }
    window_first = cell_at(low.x, low.y);
    window_size = cell_at(high.x, high.y) - window_first + 1;
    return true;
}

// Reduces the bounds by a length.
fn narrow_bounds(by: f32) {
    for (var k = 0u; k < bound(BOUND_DIRECTIONS); k++) {
        bounds[k] -= by * length(direction_of_bound(k));
    }
}

fn is_in_window(cell: vec2i) -> bool {
    return all(cell >= window_first) && all(cell < window_first + window_size);
}

// Returns true if the bounds reach the left (0) or the right triangle of a cell.
fn bounds_reach(cell: vec2i, half: u32) -> bool {
    let at = corner_of_cell(cell);
    let x = at.x;
    let y = at.y;
    let area = grid.step.x * grid.step.y;
    let aside = x * grid.step.y - y * grid.step.x;
    let along = x * grid.step.y + y * grid.step.x;
    let near = along <= bounds[8] && along + 2.0 * area >= -bounds[9];
    let shift = select(0.0, area, half == 0u);
    let beside = aside - shift <= bounds[6] && aside + area - shift >= -bounds[7];
    var least = -bounds[0];
    least = max(least, max(x - bounds[10], -bounds[11] - x - grid.step.x));
    least = max(least, max(y - bounds[12], -bounds[13] - y - grid.step.y));
    let both = max(height_at(cell), height_at(cell + 1));
    let other = height_at(cell + select(vec2i(0, 1), vec2i(1, 0), half == 0u));
    return near && beside && max(both, other) >= least;
}
