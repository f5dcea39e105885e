// The shape data shared by all environments: numbers and height fields.

fn shape3(offset: u32) -> vec3f {
    return vec3f(numbers[offset], numbers[offset + 1u], numbers[offset + 2u]);
}

fn shape4(offset: u32) -> vec4f {
    return vec4f(shape3(offset), numbers[offset + 3u]);
}

// A height field. A grid point is a vector of row and column; those beyond the border do not exist.
struct TerrainGrid {
    rows: i32,
    columns: i32,
    // The offset of the heights.
    heights: u32,
    half: vec2f,
    // Lengths of a cell along x and y, m.
    step: vec2f,
    elevation: f32,
    base: f32,
    // The radius of a ball about the origin that contains it.
    radius: f32,
}

var<private> grid: TerrainGrid;

// Begins the height field at an offset.
fn begin_grid(offset: u32) {
    let sizes = words[offset + FIELD_SIZES];
    grid.rows = i32(words[offset + FIELD_ROWS]);
    grid.columns = i32(words[offset + FIELD_COLUMNS]);
    grid.half = vec2f(numbers[sizes + FIELD_NUMBERS_HALF], numbers[sizes + FIELD_NUMBERS_HALF + 1u]);
    grid.step = vec2f(numbers[sizes + FIELD_NUMBERS_STEP], numbers[sizes + FIELD_NUMBERS_STEP + 1u]);
    grid.elevation = numbers[sizes + FIELD_NUMBERS_ELEVATION];
    grid.base = numbers[sizes + FIELD_NUMBERS_BASE];
    grid.radius = numbers[sizes + FIELD_NUMBERS_RADIUS];
    grid.heights = sizes + FIELD_NUMBERS_SIZE;
}

fn height_at(node: vec2i) -> f32 {
    return numbers[grid.heights + u32(node.x * grid.columns + node.y)];
}

// Returns the cell at a point, or the nearest one.
fn cell_at(x: f32, y: f32) -> vec2i {
    let cell = floor((vec2f(y, x) + grid.half.yx) / grid.step.yx);
    return vec2i(clamp(cell, vec2f(), vec2f(f32(grid.rows - 2), f32(grid.columns - 2))));
}

// Returns the lowest corner of a cell along x and y, m.
fn corner_of_cell(cell: vec2i) -> vec2f {
    return vec2f(f32(cell.y), f32(cell.x)) * grid.step - grid.half;
}
