// Contacts that adhere of themselves, see `constraint/contact.rs` of clench-rigid.

// What a contact holds on with. Its rows give that besides, against the passive force that pulls its bodies together.
fn contact_adhesion(contact: u32) -> f32 {
    if (!ANY_ADHESION) {
        return 0.0;
    }
    let pair = u32(fetch(CONTACTS + CONTACT_SIZE * contact));
    return parameter(PAIR_PRM + PAIR_PRM_SIZE * pair + 16u);
}
