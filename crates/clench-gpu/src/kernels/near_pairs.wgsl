// The data shared by the three collision kernels: the list of near pairs, in canonical order. The narrow phase replaces
// a pair by the range of its contacts in the memory of its threads.

// The distance of pairs without a contact.
const TOO_FAR: f32 = 3e38;
// Greater than the contacts of any pair.
const PAIR_CONTACTS: u32 = 256u;

// Encodes `count` contacts from `first` on as a word.
fn contacts_of_pair(first: u32, count: u32) -> u32 {
    return first * PAIR_CONTACTS + count;
}
