//! The element types of the fields of a state: numbers, vectors, quaternions, wrenches, truth values.

use clench_math::{Force, Mask, Quat, Real, Scalar, Vec3};
use std::fmt::Debug;
use std::iter::once;
use std::slice::{from_mut, from_ref};

/// A kind of element. An element is a few numbers in each lane, or a truth value.
pub trait Kind {
    /// An element in the number type `T`.
    type Of<T: Real>: Copy + Debug;
    /// A cell of an element in a row of a batch.
    type Cell<S>;
    /// The number of cells of an element.
    const WIDTH: usize;
    /// True for the elements of a list, whose first cell is not zero. Copies and checks stop at its end.
    const LISTED: bool = false;

    /// Returns zero, or false.
    fn zero<T: Real>() -> Self::Of<T>;
    /// Returns the zero cell.
    fn zero_cell<S: Real>() -> Self::Cell<S>;
    /// Returns the cells of an element in lane `lane`.
    fn cells<T: Real>(
        element: &Self::Of<T>,
        lane: usize,
    ) -> impl Iterator<Item = Self::Cell<T::Scalar>>;
    /// Sets the cells of an element in lane `lane`.
    fn set_cells<T: Real>(
        element: &mut Self::Of<T>,
        lane: usize,
        cells: impl Iterator<Item = Self::Cell<T::Scalar>>,
    );
    /// Converts a cell to a number.
    fn number<S: Scalar>(cell: Self::Cell<S>) -> S;
    /// Converts a number to a cell.
    fn from_number<S: Scalar>(number: S) -> Self::Cell<S>;
    /// Passes the numbers of elements to `visit`, with the index of the first: many at once, or an element at a time.
    fn numbers<T: Real>(elements: &[Self::Of<T>], visit: impl FnMut(usize, &[T]));
    /// Copies the element of one environment to every lane.
    fn splat<T: Real>(element: &Self::Of<T::Scalar>) -> Self::Of<T>;
    /// Returns true if two elements are equal, bit by bit.
    fn same<T: Real>(one: &Self::Of<T>, other: &Self::Of<T>) -> bool;
}

/// Returns true if two numbers are equal, bit by bit, in every lane.
fn same_bits<T: Real>(one: T, other: T) -> bool {
    let bits = |lane: usize| {
        let bits = |x: T| x.lane(lane).to_f64().to_bits();
        bits(one) == bits(other)
    };
    (0..T::LANES).all(bits)
}

/// A number per lane.
#[derive(Debug)]
pub enum Number {}

impl Kind for Number {
    type Of<T: Real> = T;
    type Cell<S> = S;
    const WIDTH: usize = 1;

    fn zero<T: Real>() -> T {
        T::ZERO
    }
    fn zero_cell<S: Real>() -> S {
        S::ZERO
    }
    #[inline(always)]
    fn cells<T: Real>(number: &T, lane: usize) -> impl Iterator<Item = T::Scalar> {
        once(T::as_scalars(from_ref(number))[lane])
    }
    #[inline(always)]
    fn set_cells<T: Real>(number: &mut T, lane: usize, cells: impl Iterator<Item = T::Scalar>) {
        for cell in cells {
            T::as_scalars_mut(from_mut(number))[lane] = cell;
        }
    }
    #[inline(always)]
    fn number<S: Scalar>(cell: S) -> S {
        cell
    }
    #[inline(always)]
    fn from_number<S: Scalar>(number: S) -> S {
        number
    }
    #[inline(always)]
    fn numbers<T: Real>(numbers: &[T], mut visit: impl FnMut(usize, &[T])) {
        visit(0, numbers);
    }
    #[inline(always)]
    fn splat<T: Real>(number: &T::Scalar) -> T {
        T::splat(*number)
    }
    fn same<T: Real>(one: &T, other: &T) -> bool {
        same_bits(*one, *other)
    }
}

/// An integer per lane, of a size that every number type holds exactly; 32 bits in rows.
#[derive(Debug)]
pub enum Integer {}

impl Kind for Integer {
    type Of<T: Real> = T;
    type Cell<S> = i32;
    const WIDTH: usize = 1;

    fn zero<T: Real>() -> T {
        T::ZERO
    }
    fn zero_cell<S: Real>() -> i32 {
        0
    }
    #[inline(always)]
    fn cells<T: Real>(number: &T, lane: usize) -> impl Iterator<Item = i32> {
        once(number.lane(lane).to_f64() as i32)
    }
    #[inline(always)]
    fn set_cells<T: Real>(number: &mut T, lane: usize, cells: impl Iterator<Item = i32>) {
        for cell in cells {
            number.set_lane(lane, T::Scalar::new(f64::from(cell)));
        }
    }
    #[inline(always)]
    fn number<S: Scalar>(cell: i32) -> S {
        S::new(f64::from(cell))
    }
    #[inline(always)]
    fn from_number<S: Scalar>(number: S) -> i32 {
        number.to_f64() as i32
    }
    #[inline(always)]
    fn numbers<T: Real>(numbers: &[T], mut visit: impl FnMut(usize, &[T])) {
        visit(0, numbers);
    }
    #[inline(always)]
    fn splat<T: Real>(number: &T::Scalar) -> T {
        T::splat(*number)
    }
    fn same<T: Real>(one: &T, other: &T) -> bool {
        same_bits(*one, *other)
    }
}

/// Implements kinds of several numbers, by the order of their parts.
macro_rules! compound {
    ($($(#[$doc:meta])* $name:ident: $of:ident, $listed:literal, $zero:expr, [$($($part:ident).+),*];)*) => {$(
        $(#[$doc])*
        #[derive(Debug)]
        pub enum $name {}

        impl Kind for $name {
            type Of<T: Real> = $of<T>;
            type Cell<S> = S;
            const WIDTH: usize = [$(stringify!($($part).+)),*].len();
            const LISTED: bool = $listed;

            fn zero<T: Real>() -> $of<T> {
                $zero
            }
            fn zero_cell<S: Real>() -> S {
                S::ZERO
            }
            #[inline(always)]
            fn cells<T: Real>(element: &$of<T>, lane: usize) -> impl Iterator<Item = T::Scalar> {
                [$(T::as_scalars(from_ref(&element.$($part).+))[lane]),*].into_iter()
            }
            #[inline(always)]
            fn set_cells<T: Real>(
                element: &mut $of<T>,
                lane: usize,
                cells: impl Iterator<Item = T::Scalar>,
            ) {
                for (part, cell) in [$(&mut element.$($part).+),*].into_iter().zip(cells) {
                    T::as_scalars_mut(from_mut(part))[lane] = cell;
                }
            }
            #[inline(always)]
            fn number<S: Scalar>(cell: S) -> S {
                cell
            }
            #[inline(always)]
            fn from_number<S: Scalar>(number: S) -> S {
                number
            }
            #[inline(always)]
            fn numbers<T: Real>(elements: &[$of<T>], mut visit: impl FnMut(usize, &[T])) {
                for (i, element) in elements.iter().enumerate() {
                    let numbers = [$(element.$($part).+),*];
                    if Self::LISTED && numbers[0].eq(T::ZERO).all() {
                        break;
                    }
                    visit(i * Self::WIDTH, &numbers);
                }
            }
            #[inline(always)]
            fn splat<T: Real>(element: &$of<T::Scalar>) -> $of<T> {
                let mut lanes: $of<T> = $zero;
                $(lanes.$($part).+ = T::splat(element.$($part).+);)*
                lanes
            }
            fn same<T: Real>(one: &$of<T>, other: &$of<T>) -> bool {
                [$((one.$($part).+, other.$($part).+)),*].iter().all(|&(a, b)| same_bits(a, b))
            }
        }
    )*};
}
compound! {
    /// Three numbers.
    Vector: Vec3, false, Vec3::ZERO, [x, y, z];
    /// Four numbers, w first.
    Quaternion: Quat, false, Quat::new(T::ZERO, T::ZERO, T::ZERO, T::ZERO), [w, x, y, z];
    /// A force and a torque, the force first.
    Wrench: Force, false, Force::ZERO, [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z];
    /// A stick reference.
    Reference: StickReference, true, StickReference::EMPTY,
        [first, second, position.x, position.y, position.z, rotation.w, rotation.x, rotation.y, rotation.z];
}

/// A stick reference as it is stored in [`State::stick_references`](crate::State::stick_references).
#[derive(Clone, Copy, Debug)]
pub struct StickReference<T> {
    /// The first geom, plus one; 0 in empty slots.
    pub first: T,
    /// The second geom, plus one.
    pub second: T,
    /// Position of the second geom's body in the frame of the first one's, m.
    pub position: Vec3<T>,
    /// Its orientation there.
    pub rotation: Quat<T>,
}

impl<T: Real> StickReference<T> {
    /// An empty slot.
    pub const EMPTY: Self = StickReference {
        first: T::ZERO,
        second: T::ZERO,
        position: Vec3::ZERO,
        rotation: Quat::new(T::ZERO, T::ZERO, T::ZERO, T::ZERO),
    };
}

/// A truth value per lane; a byte in rows. Any nonzero byte means true, because programs that write rows by address may
/// write other values than 0 and 1.
#[derive(Debug)]
pub enum Truth {}

impl Kind for Truth {
    type Of<T: Real> = T::Mask;
    type Cell<S> = u8;
    const WIDTH: usize = 1;

    fn zero<T: Real>() -> T::Mask {
        T::Mask::splat(false)
    }
    fn zero_cell<S: Real>() -> u8 {
        0
    }
    #[inline(always)]
    fn cells<T: Real>(truth: &T::Mask, lane: usize) -> impl Iterator<Item = u8> {
        once(u8::from(truth.lane(lane)))
    }
    #[inline(always)]
    fn set_cells<T: Real>(truth: &mut T::Mask, lane: usize, cells: impl Iterator<Item = u8>) {
        for cell in cells {
            truth.set_lane(lane, cell != 0);
        }
    }
    #[inline(always)]
    fn number<S: Scalar>(cell: u8) -> S {
        match cell {
            0 => S::ZERO,
            _ => S::ONE,
        }
    }
    #[inline(always)]
    fn from_number<S: Scalar>(number: S) -> u8 {
        u8::from(number != S::ZERO)
    }
    #[inline(always)]
    fn numbers<T: Real>(_: &[T::Mask], _: impl FnMut(usize, &[T])) {}
    #[inline(always)]
    fn splat<T: Real>(truth: &<T::Scalar as Real>::Mask) -> T::Mask {
        T::Mask::splat(truth.lane(0))
    }
    fn same<T: Real>(one: &T::Mask, other: &T::Mask) -> bool {
        one == other
    }
}
