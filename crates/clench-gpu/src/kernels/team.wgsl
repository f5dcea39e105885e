// A team: TEAM threads that share an environment's dofs, actuators and bodies of a tree level. Adjacent threads have
// adjacent environments; all of a team are in one workgroup, and synchronize by `join`.

// The index of a thread in its team, and the start of its loops over `k`, with the stride TEAM. If its environment does
// not exist or has stopped, it is beyond the end of every loop, and the thread only takes part in barriers.
var<private> member: u32;
// The index of its environment in the workgroup.
var<private> column: u32;

const BEHIND_ALL: u32 = 0x40000000u;

// Begins the environment of a thread.
fn begin_in_team(id: vec3u) {
    column = id.x % GROUP;
    member = select(BEHIND_ALL, id.y, begin(id.x));
}

// Returns true for the thread that does serial work.
fn is_first() -> bool {
    return member == 0u;
}

// Makes all writes visible to all of the workgroup, except in workgroup memory.
fn join() {
    storageBarrier();
}

var<workgroup> votes: array<u32, GROUP * TEAM>;

// Returns the minimum over a team.
fn least_of_team(x: u32) -> u32 {
    if (member < TEAM) {
        votes[GROUP * member + column] = x;
    }
    workgroupBarrier();
    var least = x;
    for (var k = 0u; k < bound(TEAM); k++) {
        least = min(least, votes[GROUP * k + column]);
    }
    workgroupBarrier();
    return least;
}

// Records a fault if the device terminated a loop early.
fn end_in_team() {
    if (member < TEAM) {
        check_loops();
    }
}
