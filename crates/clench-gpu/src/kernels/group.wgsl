// One workgroup an environment: what its threads share. Every sum is taken in the same order by every thread, so that all
// have the same bits and decide alike, and a run repeats itself.

var<private> lane: u32;
// What threads hand to each other, each its own; between two such exchanges a tile of a matrix, in rows of four vectors and one more.
var<workgroup> scratch: array<vec4f, 80>;
var<workgroup> verdict: u32;

// The environment of a workgroup: the groups lie in rows of GRID.
fn environment_of(workgroup: vec3u) -> u32 {
    return workgroup.x + GRID * workgroup.y;
}

// Lets a branch that contains barriers be taken by all threads or none. All come with the same answer.
fn agreed(answer: u32) -> u32 {
    if (lane == 0u) {
        verdict = answer;
    }
    return workgroupUniformLoad(&verdict);
}

// Takes up the environment of a workgroup; false where there is none, or where it has failed and stands still.
fn begin_together(workgroup: vec3u) -> bool {
    let runs = begin(environment_of(workgroup));
    return agreed(select(0u, 1u, runs)) == 1u;
}

// Waits until all threads of the group see what each has written.
fn join() {
    storageBarrier();
    workgroupBarrier();
}

// The sum of eight neighbours.
fn sum_of_eight(first: u32) -> vec4f {
    let first_half = (scratch[first] + scratch[first + 1u]) + (scratch[first + 2u] + scratch[first + 3u]);
    let second_half = (scratch[first + 4u] + scratch[first + 5u]) + (scratch[first + 6u] + scratch[first + 7u]);
    return first_half + second_half;
}

// The sum over all 64 threads, of which eight add up eight each. No loop: a solve asks for so many that they would be half of its turns.
fn total(x: vec4f) -> vec4f {
    scratch[lane] = x;
    workgroupBarrier();
    let part = sum_of_eight(8u * (lane % 8u));
    workgroupBarrier();
    if (lane < 8u) {
        scratch[lane] = part;
    }
    workgroupBarrier();
    let sum = sum_of_eight(0u);
    workgroupBarrier();
    return sum;
}
