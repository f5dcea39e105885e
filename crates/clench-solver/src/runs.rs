//! Runs of consecutive dofs, whose data are contiguous.

use std::ops::Range;

/// Returns the longest runs of consecutive numbers in a list, in its order.
pub(crate) fn runs(mut dofs: &[u32]) -> impl Iterator<Item = Range<usize>> {
    std::iter::from_fn(move || {
        let first = *dofs.first()? as usize;
        let follows = |&(k, dof): &(usize, &u32)| *dof as usize == first + k;
        let len = dofs.iter().enumerate().take_while(follows).count();
        dofs = &dofs[len..];
        Some(first..first + len)
    })
}

#[test]
fn a_list_falls_into_its_runs() {
    let found = Vec::from_iter(runs(&[4, 5, 6, 1, 3, 2, 3]));
    assert_eq!(found, [4..7, 1..2, 3..4, 2..4]);
    assert_eq!(runs(&[]).count(), 0);
}
