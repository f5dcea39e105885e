//! Small arrays of numbers.

/// Creates `[f(0), f(1), ...]`, like the standard library's `from_fn`, but always inlined into its caller: between a
/// [`kernel`](crate::kernel) and its numbers there must be no function of another instruction set.
#[inline(always)]
pub fn array<X: Copy + Default, const N: usize>(mut f: impl FnMut(usize) -> X) -> [X; N] {
    let mut array = [X::default(); N];
    for (i, x) in array.iter_mut().enumerate() {
        *x = f(i);
    }
    array
}
