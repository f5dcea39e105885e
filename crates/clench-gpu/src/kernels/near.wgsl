// What the three kernels that look for contacts hand each other: the list of near pairs, in canonical order. In the place of a pair the narrow phase
// puts which contacts it found, of all that there is room for in the memory of its threads.

// The distance of pairs without a contact.
const TOO_FAR: f32 = 3e38;
// More contacts than any pair has.
const PAIR_CONTACTS: u32 = 256u;

// `count` contacts from one on, as a word.
fn contacts_of_pair(first: u32, count: u32) -> u32 {
    return first * PAIR_CONTACTS + count;
}
