// The shared data of one workgroup per environment. Every thread computes every sum in the same order, so that all have
// the same bits and take the same branches, and runs are reproducible.

var<private> lane: u32;
// Data exchanged between threads, one each; between two exchanges, a tile of a matrix.
var<workgroup> scratch: array<vec4f, 80>;
var<workgroup> verdict: u32;

// Returns the environment of a workgroup; the groups lie in rows of GRID.
fn environment_of(workgroup: vec3u) -> u32 {
    return workgroup.x + GRID * workgroup.y;
}

// Makes a branch that contains barriers uniform. All threads pass the same answer.
fn agreed(answer: u32) -> u32 {
    if (lane == 0u) {
        verdict = answer;
    }
    return workgroupUniformLoad(&verdict);
}

// Begins the environment of a workgroup. Returns false if it does not exist or has stopped.
fn begin_together(workgroup: vec3u) -> bool {
    let runs = begin(environment_of(workgroup));
    return agreed(select(0u, 1u, runs)) == 1u;
}

// Makes all writes visible to all threads of the group.
fn join() {
    storageBarrier();
    workgroupBarrier();
}

// The sums of every eighth thread. No tile overlaps it.
var<workgroup> parts: array<vec4f, 8>;

// Returns the sum of every eighth element of `scratch`: adjacent threads read adjacent elements, without bank
// conflicts.
fn sum_of_every_eighth(first: u32) -> vec4f {
    let one_half = (scratch[first] + scratch[first + 8u]) + (scratch[first + 16u] + scratch[first + 24u]);
    let other_half = (scratch[first + 32u] + scratch[first + 40u]) + (scratch[first + 48u] + scratch[first + 56u]);
    return one_half + other_half;
}

// Sums over all 64 threads. It has no loop, which would be half of a solve's iterations.
fn total(x: vec4f) -> vec4f {
    scratch[lane] = x;
    workgroupBarrier();
    if (lane < 8u) {
        parts[lane] = sum_of_every_eighth(lane);
    }
    workgroupBarrier();
    return ((parts[0] + parts[1]) + (parts[2] + parts[3])) + ((parts[4] + parts[5]) + (parts[6] + parts[7]));
}

// As `total`, of one number from each thread.
fn total_of(x: f32) -> f32 {
    scratch[lane].x = x;
    workgroupBarrier();
    if (lane < 8u) {
        let one_half = (scratch[lane].x + scratch[lane + 8u].x) + (scratch[lane + 16u].x + scratch[lane + 24u].x);
        let other_half = (scratch[lane + 32u].x + scratch[lane + 40u].x) + (scratch[lane + 48u].x + scratch[lane + 56u].x);
        parts[lane].x = one_half + other_half;
    }
    workgroupBarrier();
    return ((parts[0].x + parts[1].x) + (parts[2].x + parts[3].x)) + ((parts[4].x + parts[5].x) + (parts[6].x + parts[7].x));
}

// Returns the largest number of all 64 threads.
fn greatest(x: f32) -> f32 {
    scratch[lane].x = x;
    workgroupBarrier();
    var largest = scratch[0].x;
    for (var k = 1u; k < bound(GROUP); k++) {
        largest = max(largest, scratch[k].x);
    }
    workgroupBarrier();
    return largest;
}

struct Sums {
    before: vec4f,
    all: vec4f,
}

// Returns the sums over the threads before this one, and over all.
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
