// One workgroup an environment: what its threads share. Every sum is taken in the same order by every thread, so that all
// have the same bits and decide alike, and a run repeats itself.

var<private> lane: u32;
// What threads hand to each other, each its own; between two such exchanges a tile of a matrix.
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

// The sums of every eighth thread. No tile lies there.
var<workgroup> parts: array<vec4f, 8>;

// The sum of what every eighth thread has put into `scratch`: those that add up side by side read side by side, and none waits for another at a bank
// of the memory.
fn sum_of_every_eighth(first: u32) -> vec4f {
    let one_half = (scratch[first] + scratch[first + 8u]) + (scratch[first + 16u] + scratch[first + 24u]);
    let other_half = (scratch[first + 32u] + scratch[first + 40u]) + (scratch[first + 48u] + scratch[first + 56u]);
    return one_half + other_half;
}

// The sum over all 64 threads. No loop: a solve asks for so many that they would be half of its turns.
fn total(x: vec4f) -> vec4f {
    scratch[lane] = x;
    workgroupBarrier();
    if (lane < 8u) {
        parts[lane] = sum_of_every_eighth(lane);
    }
    workgroupBarrier();
    return ((parts[0] + parts[1]) + (parts[2] + parts[3])) + ((parts[4] + parts[5]) + (parts[6] + parts[7]));
}

struct Sums {
    before: vec4f,
    all: vec4f,
}

// The sums of what the threads before this one come with, and of what all do.
fn sums_up_to(x: vec4f) -> Sums {
    scratch[lane] = x;
    workgroupBarrier();
    if (lane < 8u) {
        var sum = vec4f();
        for (var k = 8u * lane; k < bound(8u * lane + 8u); k++) {
            sum += scratch[k];
        }
        parts[lane] = sum;
    }
    workgroupBarrier();
    var sums = Sums(vec4f(), vec4f());
    for (var k = 0u; k < bound(8u); k++) {
        sums.before += select(vec4f(), parts[k], k < lane / 8u);
        sums.all += parts[k];
    }
    for (var k = lane / 8u * 8u; k < lane; k++) {
        sums.before += scratch[k];
    }
    workgroupBarrier();
    return sums;
}
