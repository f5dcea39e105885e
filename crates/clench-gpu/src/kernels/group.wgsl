// One workgroup an environment: what its threads share. Every sum is taken in the same order by every thread, so that all
// have the same bits and decide alike, and a run repeats itself.

var<private> lane: u32;
var<workgroup> partials: array<vec4f, GROUP>;
var<workgroup> verdict: u32;

// The environment of a workgroup: the groups lie in rows of GRID.
fn environment_of(workgroup: vec3u) -> u32 {
    return workgroup.x + GRID * workgroup.y;
}

// Waits until all threads of the group see what each has written.
fn join() {
    storageBarrier();
    workgroupBarrier();
}

// The sum over all threads.
fn total(x: vec4f) -> vec4f {
    partials[lane] = x;
    workgroupBarrier();
    var sum = vec4f();
    for (var k = 0u; k < bound(GROUP); k++) {
        sum += partials[k];
    }
    workgroupBarrier();
    return sum;
}
