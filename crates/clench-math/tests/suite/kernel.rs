//! `#[kernel]` preserves a function's arguments, early returns, errors and borrows.

use clench_math::{Lanes, Mask, Real, kernel};

#[derive(Debug, PartialEq)]
struct Negative;

/// Modifies an argument that it owns, returns early and propagates an error.
#[kernel]
fn roots<T: Real, const N: usize>(mut numbers: [T; N]) -> Result<[T; N], Negative> {
    if N == 0 {
        return Ok(numbers);
    }
    for x in &mut numbers {
        *x = root(*x)?;
    }
    Ok(numbers)
}
#[kernel]
fn root<T: Real>(x: T) -> Result<T, Negative> {
    let negative = x.lt(T::ZERO);
    if negative.any() {
        return Err(Negative);
    }
    Ok(x.sqrt())
}

/// Writes to one of several arguments and returns a borrow of it.
#[kernel]
#[inline(never)]
pub(crate) fn add<'a, T>(sum: &'a mut [T], terms: &[T], after: impl Fn(T) -> T) -> &'a mut T
where
    T: Real,
{
    for (sum, &term) in sum.iter_mut().zip(terms) {
        *sum += after(term);
    }
    &mut sum[0]
}

struct Pair<T>(T, T);
impl<T: Real> Pair<T> {
    #[kernel]
    fn swap(&mut self) -> &mut Self {
        std::mem::swap(&mut self.0, &mut self.1);
        self
    }
    #[kernel]
    fn product(self) -> T {
        self.0 * self.1
    }
}

fn kernels_work<T: Real<Scalar = f64>>() {
    let n = T::new;
    let lane = |x: T| x.lane(T::LANES - 1);
    assert_eq!(roots([n(4.0), n(9.0)]).map(|r| r.map(lane)), Ok([2.0, 3.0]));
    assert_eq!(roots([n(4.0), n(-9.0)]).err(), Some(Negative));
    assert!(roots::<T, 0>([]).is_ok());
    let mut sum = [n(1.0), n(2.0)];
    *add(&mut sum, &[n(3.0), n(4.0)], |x| x + x) *= n(10.0);
    assert_eq!(sum.map(lane), [70.0, 10.0]);
    let mut pair = Pair(n(2.0), n(3.0));
    pair.swap().0 += n(1.0);
    assert_eq!(lane(pair.product()), 8.0);
}

#[test]
fn kernels_are_what_they_were_in_scalars() {
    kernels_work::<f64>();
}
#[test]
fn kernels_are_what_they_were_in_lanes() {
    kernels_work::<Lanes<f64, 4>>();
}
