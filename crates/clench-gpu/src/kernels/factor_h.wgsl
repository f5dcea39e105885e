// The factor of the Hessian H = LLᵀ, tile by tile of its lower triangle, column by column of tiles. A tile of H minus
// the products of the previous tiles is stored only when complete; H itself is never stored. For tiles on the diagonal
// the inverse of L is stored, so that divisions become products without sequential dependencies (as in MAGMA: Tomov,
// Nath, Ltaief & Dongarra, *Dense linear algebra solvers for multicore with GPU accelerators*, 2010).

// The pivot, relative to the original diagonal, below which it is only rounding error.
const MIN_PIVOT: f32 = EPSILON;

// The diagonal of H in the current tile.
var<workgroup> diagonal: array<f32, TILE>;

// Finds the tiles with a dof that is awake. No block acts on sleeping dofs, and their gradient is zero: the factor omits
// the rows and columns of all other tiles. Dofs that sleep in the remaining ones do not affect those that are awake.
fn find_awake_tiles() {
    for (var tile = lane; tile < NTILE; tile += GROUP) {
        var awake: f32 = 0.0;
        for (var i = TILE * tile; i < min(TILE * (tile + 1u), NV); i++) {
            awake = select(awake, 1.0, is_dof_awake(i));
        }
        put_row(AWAKE_TILES + tile, awake);
    }
    join();
}

fn is_omitted(tile: u32) -> bool {
    return SLEEP && row(AWAKE_TILES + tile) == 0.0;
}

// Returns this thread's part of a tile of M; beyond the end of M, of the identity.
fn mass_tile(i: u32, j: u32) -> vec4f {
    var own = vec4f();
    let r = TILE * i + own_row();
    for (var k = 0u; k < 4u; k++) {
        let column = TILE * j + 4u * own_quad() + k;
        var entry = select(f32(0.0), f32(1.0), r == column);
        if (max(r, column) < NV) {
            entry = mass_entry(r, column);
        }
        own[k] = entry;
    }
    return own;
}

// Stages four stiff rows, from the k-th on, for a product: J at dof `i` and W J at dof `j`.
fn stage_stiff(offset: u32, k: u32, count: u32, i: u32, j: u32) {
    var of_j = vec4f();
    var of_wj = vec4f();
    for (var a = 0u; a < 4u; a++) {
        if (k + a < count) {
            let stiff = u32(row(STIFF + k + a)) * NV;
            of_j[a] = select(0.0, row(JACOBIAN + stiff + i), i < NV);
            of_wj[a] = select(0.0, row(WEIGHED + stiff + j), j < NV);
        }
    }
    scratch[offset] = of_j;
    tiles[RIGHT + offset] = of_wj;
}

// Stages the factors of a term of the tile (i, j) for a product: of Jᵀ W J for sixteen stiff rows, or of a previous
// column of tiles, which is subtracted.
fn stage_term(i: u32, j: u32, term: u32, chunks: u32, count: u32) {
    // Adjacent threads have adjacent rows, which are dofs: adjacent numbers of J.
    let r = lane % TILE;
    let quad = lane / TILE;
    let offset = waiting_row(r) + quad;
    if (term < chunks) {
        stage_stiff(offset, TILE * term + 4u * quad, count, TILE * i + r, TILE * j + r);
    } else {
        scratch[offset] = -tile_quad(tile_at(i, term - chunks), r, quad);
        tiles[RIGHT + offset] = tile_quad(tile_at(j, term - chunks), r, quad);
    }
    workgroupBarrier();
}

// Records the diagonal of H in a diagonal tile.
fn record_diagonal(own: vec4f) {
    let r = own_row();
    if (r / 4u == own_quad()) {
        diagonal[r] = own[r % 4u];
    }
}

// Computes L⁻¹ of a diagonal tile: the row operations that turn the tile into Lᵀ turn the identity into L⁻¹. A pivot
// lost to rounding is replaced by its diagonal, so that the direction remains a descent direction. Row k is staged in
// row k of both factors of a product. Beyond the last dof a tile is the identity and remains so: only `order` rows are
// eliminated.
fn invert_factor(own: vec4f, order: u32) -> vec4f {
    let r = own_row();
    var a = own;
    var inverse = vec4f();
    if (r / 4u == own_quad()) {
        inverse[r % 4u] = 1.0;
    }
    for (var k = 0u; k < bound(order); k++) {
        let offset = waiting_row(k);
        if (r == k) {
            scratch[offset + own_quad()] = a;
            tiles[RIGHT + offset + own_quad()] = inverse;
        }
        workgroupBarrier();
        let rest = scratch[offset + k / 4u][k % 4u];
        let scale = inverseSqrt(select(diagonal[k], rest, rest > MIN_PIVOT * diagonal[k]));
        let of_a = scratch[offset + own_quad()] * scale;
        let of_inverse = tiles[RIGHT + offset + own_quad()] * scale;
        let multiplier = scratch[offset + r / 4u][r % 4u] * scale;
        if (r > k) {
            a -= multiplier * of_a;
            inverse -= multiplier * of_inverse;
        } else if (r == k) {
            inverse = of_inverse;
        }
    }
    // Others may still read the destination of the result.
    workgroupBarrier();
    return inverse;
}

// Returns a tile below the diagonal: its remainder times the inverse of the factor above it.
fn divide_tile(own: vec4f, j: u32) -> vec4f {
    let offset = waiting_row(own_row()) + own_quad();
    scratch[offset] = own;
    tiles[RIGHT + offset] = tile_quad(tile_at(j, j), own_row(), own_quad());
    workgroupBarrier();
    return tile_product();
}

// Factors H, for which `count` rows of J are stiff.
fn factor_hessian(count: u32) {
    let chunks = (count + TILE - 1u) / TILE;
    for (var j = 0u; j < bound(NTILE); j++) {
        for (var i = j; i < NTILE; i++) {
            if (is_omitted(i) || is_omitted(j)) {
                continue;
            }
            var own = mass_tile(i, j);
            for (var term = 0u; term < chunks + j; term++) {
                if (term == chunks) {
                    record_diagonal(own);
                }
                if (term >= chunks && is_omitted(term - chunks)) {
                    continue;
                }
                stage_term(i, j, term, chunks, count);
                own += tile_product();
                workgroupBarrier();
            }
            if (j == 0u) {
                record_diagonal(own);
            }
            if (i == j) {
                own = invert_factor(own, min(TILE, NV - TILE * j));
            } else {
                own = divide_tile(own, j);
            }
            store_tile(tile_at(i, j), own);
            join_vectors();
        }
    }
}

// Replaces the vector at `x` by H⁻¹ x; overwrites that at `half_way`.
fn solve_hessian(x: u32, half_way: u32) {
    for (var j = 0u; j < bound(NTILE); j++) {
        if (is_omitted(j)) {
            continue;
        }
        if (lane < TILE) {
            put_vector(half_way + TILE * j + lane, times_row(tile_at(j, j), lane, x + TILE * j));
        }
        join_vectors();
        for (var i = TILE * (j + 1u) + lane; i < TILE * NTILE; i += GROUP) {
            let tile = tile_at(i / TILE, j);
            if (!is_omitted(i / TILE)) {
                put_vector(x + i, vector(x + i) - times_row(tile, i % TILE, half_way + TILE * j));
            }
        }
        join_vectors();
    }
    for (var down = 0u; down < bound(NTILE); down++) {
        let j = NTILE - 1u - down;
        if (is_omitted(j)) {
            continue;
        }
        if (lane < TILE) {
            put_vector(x + TILE * j + lane, times_column(tile_at(j, j), lane, half_way + TILE * j));
        }
        join_vectors();
        for (var i = lane; i < TILE * j; i += GROUP) {
            let tile = tile_at(j, i / TILE);
            if (!is_omitted(i / TILE)) {
                put_vector(half_way + i, vector(half_way + i) - times_column(tile, i % TILE, x + TILE * j));
            }
        }
        join_vectors();
    }
}
