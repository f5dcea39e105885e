// Contacts with adhesion, see `constraint/contact.rs` of clench-dynamics.

// Returns the adhesion of a contact. Its rows add this force against the passive one that pulls its bodies together.
fn contact_adhesion(contact: u32) -> f32 {
    if (!ANY_ADHESION) {
        return 0.0;
    }
    let pair = u32(fetch(CONTACTS + CONTACT_SIZE * contact));
    return parameter(PAIR_PRM + PAIR_SIZE * pair + PAIR_ADHESION);
}
