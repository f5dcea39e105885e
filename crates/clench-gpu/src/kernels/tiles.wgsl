// Square tiles of TILE rows of four vectors, for the factorization of H. The threads of a workgroup share a
// product of two: each has four columns in a row of the result, in registers, and reads the factors from workgroup
// memory.

// Vectors of four numbers in a row of a tile.
const QUADS: u32 = TILE / 4u;
const QUADS_OF_TILE: u32 = TILE * QUADS;

// Tiles of the lower triangle of a matrix, if they fit workgroup memory; else they are stored with the rows of the
// environment. The second factor of a product is staged from RIGHT on, in the memory of the last tile; the first is in
// `scratch`.
var<workgroup> tiles: array<vec4f, RIGHT + TILE * STRIDE>;

// This thread's part of a tile: its row, and its columns divided by four. There are as many threads as parts.
fn own_row() -> u32 {
    return lane / QUADS;
}

fn own_quad() -> u32 {
    return lane % QUADS;
}

// The stride of the rows of a staged tile, plus one vector between its halves. Thus rows that threads read together lie
// in different memory banks.
const STRIDE: u32 = QUADS + 1u;

fn waiting_row(r: u32) -> u32 {
    return STRIDE * r + r / 8u;
}

// Indexes the tile (i, j), i ≥ j, of a lower triangle.
fn tile_at(i: u32, j: u32) -> u32 {
    return i * (i + 1u) / 2u + j;
}

// Returns four numbers of a row of a tile.
fn tile_quad(tile: u32, r: u32, quad: u32) -> vec4f {
    let offset = QUADS_OF_TILE * tile + QUADS * r + quad;
    if (SHARE_TILES) {
        return tiles[offset];
    }
    let first = TILES + 4u * offset;
    return vec4f(row(first), row(first + 1u), row(first + 2u), row(first + 3u));
}

fn tile_entry(tile: u32, r: u32, column: u32) -> f32 {
    if (SHARE_TILES) {
        return tiles[QUADS_OF_TILE * tile + QUADS * r + column / 4u][column % 4u];
    }
    return row(TILES + 4u * (QUADS_OF_TILE * tile + QUADS * r) + column);
}

// Stores each thread's part of a tile. All see it after the next barrier.
fn store_tile(tile: u32, own: vec4f) {
    let offset = QUADS_OF_TILE * tile + lane;
    if (SHARE_TILES) {
        tiles[offset] = own;
    } else {
        for (var k = 0u; k < 4u; k++) {
            put_row(TILES + 4u * offset + k, own[k]);
        }
    }
}

// Returns this thread's part of A Bᵀ of the staged tiles, half by half: unrolled, it needs so many registers that a GPU
// fits only two thirds as many workgroups.
fn tile_product() -> vec4f {
    let top = waiting_row(own_row());
    let columns = RIGHT + waiting_row(4u * own_quad());
    var product = vec4f();
    for (var half = 0u; half < bound(2u); half++) {
        for (var k = 0u; k < 2u; k++) {
            let quad = 2u * half + k;
            let b = columns + quad;
            let columns_of_b = mat4x4f(tiles[b], tiles[b + STRIDE], tiles[b + 2u * STRIDE], tiles[b + 3u * STRIDE]);
            product += scratch[top + quad] * columns_of_b;
        }
    }
    return product;
}

// Returns a row of a tile times the vector at `x`.
fn times_row(tile: u32, r: u32, x: u32) -> f32 {
    var sum: f32 = 0.0;
    for (var k = 0u; k < QUADS; k++) {
        let first = x + 4u * k;
        sum += dot(tile_quad(tile, r, k), vec4f(vector(first), vector(first + 1u), vector(first + 2u), vector(first + 3u)));
    }
    return sum;
}

// Returns a column of a tile times the vector at `x`.
fn times_column(tile: u32, column: u32, x: u32) -> f32 {
    var sum: f32 = 0.0;
    for (var quad = 0u; quad < bound(QUADS); quad++) {
        for (var k = 0u; k < 4u; k++) {
            let r = 4u * quad + k;
            sum += tile_entry(tile, r, column) * vector(x + r);
        }
    }
    return sum;
}
