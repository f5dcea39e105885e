// The memory layout. The sizes (NV, ...) and the offsets in capitals are constants of the model, written before this
// text. State and work are arrays of fields with interleaved environments (`offset * envs + env`), so that neighbouring
// threads access neighbouring numbers; `rows` holds the problem of one workgroup, a block of ROWS numbers for each
// environment.

@group(0) @binding(0) var<storage, read> words: array<u32>;
@group(0) @binding(1) var<storage, read> numbers: array<f32>;
@group(0) @binding(2) var<storage, read_write> state: array<f32>;
@group(0) @binding(3) var<storage, read_write> work: array<f32>;
@group(0) @binding(4) var<storage, read_write> rows: array<f32>;
@group(0) @binding(5) var<storage, read_write> reports: array<u32>;
// The parameters of each environment, the first PARAMETERS of `numbers`, if some have their own; else `numbers` itself.
@group(0) @binding(6) var<storage, read> parameters: array<f32>;

// The environment of this thread, and the number of environments.
var<private> env: u32;
var<private> envs: u32;
// The start of the parameters of this environment, and their stride.
var<private> parameter_start: u32;
var<private> parameter_stride: u32;

fn select_environment(index: u32) {
    env = index;
    envs = words[ENVS];
    let has_own = words[OWN_PARAMETERS] == 1u;
    parameter_start = select(0u, env, has_own);
    parameter_stride = select(1u, envs, has_own);
}

// Returns a parameter of this environment.
fn parameter(offset: u32) -> f32 {
    return parameters[offset * parameter_stride + parameter_start];
}

fn parameter3(offset: u32) -> vec3f {
    return vec3f(parameter(offset), parameter(offset + 1u), parameter(offset + 2u));
}

fn parameter4(offset: u32) -> vec4f {
    return vec4f(parameter3(offset), parameter(offset + 3u));
}

// Begins an environment. Returns false if it does not exist or has stopped.
fn begin(index: u32) -> bool {
    select_environment(index);
    if (index >= envs) {
        return false;
    }
    return reports[STATUS * envs + env] == RUNNING;
}

// Records that this step failed; the first fault is kept.
fn fail(fault: u32) {
    if (reports[FAILURE * envs + env] == RUNNING) {
        reports[FAILURE * envs + env] = fault;
    }
}

fn fetch(offset: u32) -> f32 {
    return work[offset * envs + env];
}

fn put(offset: u32, x: f32) {
    work[offset * envs + env] = x;
}

fn add(offset: u32, x: f32) {
    work[offset * envs + env] += x;
}

fn fetch3(offset: u32) -> vec3f {
    return vec3f(fetch(offset), fetch(offset + 1u), fetch(offset + 2u));
}

fn put3(offset: u32, v: vec3f) {
    put(offset, v.x);
    put(offset + 1u, v.y);
    put(offset + 2u, v.z);
}

fn fetch4(offset: u32) -> vec4f {
    return vec4f(fetch3(offset), fetch(offset + 3u));
}

fn put4(offset: u32, v: vec4f) {
    put3(offset, v.xyz);
    put(offset + 3u, v.w);
}

// Matrices are row-major, as users read them.
fn fetch_matrix(offset: u32) -> mat3x3f {
    return transpose(mat3x3f(fetch3(offset), fetch3(offset + 3u), fetch3(offset + 6u)));
}

fn put_matrix(offset: u32, m: mat3x3f) {
    let t = transpose(m);
    put3(offset, t[0]);
    put3(offset + 3u, t[1]);
    put3(offset + 6u, t[2]);
}

fn fetch_state(offset: u32) -> f32 {
    return state[offset * envs + env];
}

fn fetch_state3(offset: u32) -> vec3f {
    return vec3f(fetch_state(offset), fetch_state(offset + 1u), fetch_state(offset + 2u));
}

fn fetch_state4(offset: u32) -> vec4f {
    return vec4f(fetch_state3(offset), fetch_state(offset + 3u));
}

fn put_state(offset: u32, x: f32) {
    state[offset * envs + env] = x;
}

// Returns a number of the block of this environment.
fn row(offset: u32) -> f32 {
    return rows[env * ROWS + offset];
}

fn put_row(offset: u32, x: f32) {
    rows[env * ROWS + offset] = x;
}

// Returns a field of a block.
fn block(b: u32, field: u32) -> u32 {
    return u32(row(BLOCKS + BLOCK_SIZE * b + field));
}

// Returns true if the device runs loops to their end. Mesa's software device limits the total iterations of a thread,
// and ends every later loop after its first iteration: this loop detects that.
fn loops_end() -> bool {
    var iterations = 0u;
    for (var k = 0u; k < bound(4u); k++) {
        iterations += 1u;
    }
    return iterations == 4u;
}

// Records a fault if the device terminated a loop early.
fn check_loops() {
    if (!loops_end() && reports[STATUS * envs + env] == RUNNING) {
        fail(UNFINISHED);
    }
}

// Returns a loop's end in a form unknown at compile time: unrolling would make compilation ten times as long.
fn bound(n: u32) -> u32 {
    return n + words[ZERO];
}
