// Rays against height fields, from cell to cell. CPU counterpart: `clench-collide/src/ray/terrain.rs`. Within one
// triangle of a cell the height of a ray over the surface is linear, and neighbours are consistent on their common
// edge.

// The margin of a ray's bounding box above the field's highest point, relative to its height.
const HEADROOM = 1e-5;

// The current cell of the ray, by row and column, its lowest corner along x and y, and the heights of its corners: the
// lowest along both, one column further, one row further, and both.
var<private> passed_cell: vec2i;
var<private> cell_corner: vec2f;
var<private> cell_heights: vec4f;

fn begin_cell(cell: vec2i) {
    passed_cell = cell;
    cell_corner = corner_of_cell(cell);
    cell_heights = vec4f(height_at(cell), height_at(cell + vec2i(0, 1)), height_at(cell + vec2i(1, 0)), height_at(cell + 1));
}

// Returns the position within the cell, each from 0 to 1.
fn position_in_cell(p: vec3f) -> vec2f {
    return (p.xy - cell_corner) / grid.step;
}

// Returns the rise over the cell, along x and y, of the triangle on the right or left of its diagonal.
fn rise_of_triangle(right: bool) -> vec2f {
    let h = cell_heights;
    return select(vec2f(h.w - h.z, h.z - h.x), vec2f(h.y - h.x, h.w - h.y), right);
}

// Returns the height of a point over that triangle.
fn height_over(p: vec3f, right: bool) -> f32 {
    return p.z - (cell_heights.x + dot(rise_of_triangle(right), position_in_cell(p)));
}

fn point_at(line: Line, distance: f32) -> vec3f {
    return line.origin + line.along * distance;
}

// Returns the hit of the ray on the surface within the cell, between two distances.
fn cross_surface(line: Line, start: f32, end: f32, above: bool) -> Hit {
    let positions = mat2x2f(position_in_cell(point_at(line, start)), position_in_cell(point_at(line, end)));
    let first = positions[0].x - positions[0].y;
    let last = positions[1].x - positions[1].y;
    let changes = (first < 0.0) != (last < 0.0);
    let share = first / select(f32(1.0), first - last, changes);
    var right = select(first > 0.0, last > 0.0, first == 0.0);
    var before = start;
    var after = select(end, start + (end - start) * share, changes);
    for (var part = 0u; part < bound(2u); part++) {
        let height = height_over(point_at(line, before), right);
        let next_height = height_over(point_at(line, after), right);
        let crosses = select(next_height > 0.0, next_height < 0.0, above);
        if (crosses && after >= before) {
            let fall = select(f32(1.0), height - next_height, height != next_height);
            let distance = before + (after - before) * clamp(height / fall, 0.0, 1.0);
            return Hit(distance, direction(vec3f(-rise_of_triangle(right) / grid.step, 1.0)).xyz);
        }
        before = after;
        after = end;
        right = last > 0.0;
    }
    return Hit(NOWHERE, vec3f());
}

// Follows the ray from cell to cell, to its exit.
fn follow_surface(line: Line, start: f32, end: f32, above: bool) -> Hit {
    let forward = line.along.xy > vec2f();
    let is_level = line.along.xy == vec2f();
    let count = vec2i(grid.columns - 1, grid.rows - 1);
    var now = start;
    for (var k = 0; k < grid.rows + grid.columns; k++) {
        let next = passed_cell.yx + select(vec2i(-1), vec2i(1), forward);
        let ahead = cell_corner + select(vec2f(), grid.step, forward) - line.origin.xy;
        let goes_on = (next >= vec2i()) & (next < count) & !is_level;
        let borders = select(vec2f(NOWHERE), ahead / select(line.along.xy, vec2f(1.0), is_level), goes_on);
        let border = min(borders.x, borders.y);
        let hit = cross_surface(line, now, max(min(border, end), now), above);
        if (hit.distance < NOWHERE || border >= end) {
            return hit;
        }
        now = max(now, border);
        let across_y = borders.y < borders.x;
        begin_cell(select(vec2i(passed_cell.x, next.x), vec2i(next.y, passed_cell.y), across_y));
    }
    return Hit(NOWHERE, vec3f());
}

// Hits the terrain and its base as two stacked solids: a ray that starts within one of them also hits the plane between
// the two.
fn hit_terrain(field: u32, line: Line) -> Hit {
    begin_grid(field);
    var low = -grid.base;
    var high = grid.elevation * (1.0 + HEADROOM);
    var half = vec3f(grid.half, 0.5 * (high - low));
    var centre = vec3f(0.0, 0.0, 0.5 * (high + low));
    var t = within_box(line.origin - centre, line.along, half);
    if (!is_hit(t)) {
        return Hit(NOWHERE, vec3f());
    }
    let start = max(t.x, 0.0);
    let p = point_at(line, start);
    begin_cell(cell_at(p.x, p.y));
    let position = position_in_cell(p);
    let above = height_over(p, position.x > position.y) >= 0.0;
    // Through a side or the bottom.
    let enters_ground = !above && t.x >= 0.0;
    let in_terrain = !above && line.origin.z > 0.0;
    if (!enters_ground) {
        if (!above) {
            low = select(low, 0.0, in_terrain);
            high = select(0.0, high, in_terrain);
            half.z = 0.5 * (high - low);
            centre.z = 0.5 * (high + low);
            t = within_box(line.origin - centre, line.along, half);
        }
        let hit = follow_surface(line, start, t.y, above);
        if (above || hit.distance < NOWHERE) {
            return hit;
        }
    }
    let distance = select(t.y, t.x, enters_ground);
    let outwards = select(line.along, -line.along, enters_ground);
    var normal = normal_at(BOX, half, point_at(line, distance) - centre, outwards);
    if (!enters_ground && in_terrain && normal.z < 0.0) {
        normal = -normal;
    }
    return Hit(select(NOWHERE, distance, distance >= 0.0), normal);
}
