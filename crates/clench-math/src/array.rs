//! Small arrays of numbers.

/// Creates `[f(0), f(1), ...]`, like the standard library's `from_fn`, but always inlined into its caller: between a
/// [`kernel`](crate::kernel) and its numbers there must be no function of another instruction set.
#[inline(always)]
pub fn array<X: Copy + Default, const N: usize>(mut f: impl FnMut(usize) -> X) -> [X; N] {
    let mut array = [X::default(); N];
    // A loop over an iterator takes three times as long to compile.
    let mut i = 0;
    while i < N {
        array[i] = f(i);
        i += 1;
    }
    array
}
