// A team: TEAM threads that share an environment, its dofs, its actuators, the bodies of a level of its tree. Threads side by side are of environments side
// by side; all of a team are in one workgroup, and wait for each other by `join`.

// Which of its team a thread is, and where its loops start: over `k` from `member` on, TEAM at a time. One whose environment is not there or stands still is
// behind the end of every loop, and only waits with the others.
var<private> member: u32;
// Which of the environments of the workgroup it is of.
var<private> column: u32;

const BEHIND_ALL: u32 = 0x40000000u;

// Takes up the environment of a thread.
fn begin_in_team(id: vec3u) {
    column = id.x % GROUP;
    member = select(BEHIND_ALL, id.y, begin(id.x));
}

// Whether this is the thread that does what one alone has to do.
fn is_first() -> bool {
    return member == 0u;
}

// Waits until all of the workgroup see what each has written, but for what lies in the memory of the workgroup.
fn join() {
    storageBarrier();
}

var<workgroup> votes: array<u32, GROUP * TEAM>;

// The least of what each of a team comes with.
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

// Notes it where the device ended a loop before its end.
fn end_in_team() {
    if (member < TEAM) {
        note_end();
    }
}
