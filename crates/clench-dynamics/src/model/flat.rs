//! Numbers, vectors and arrays of them: broadcast to another number type, and viewed as flat rows.

use clench_math::{Quat, Real, Vec3, write_lane};
use std::slice::{from_mut, from_ref};

/// A number, vector or array that can be broadcast to another number type.
pub(super) trait Broadcast<T> {
    type Output;
    fn broadcast(&self) -> Self::Output;
}
impl<T: Real> Broadcast<T> for f64 {
    type Output = T;
    fn broadcast(&self) -> T {
        T::new(*self)
    }
}
impl<T: Real> Broadcast<T> for Vec3<f64> {
    type Output = Vec3<T>;
    fn broadcast(&self) -> Vec3<T> {
        Vec3::from_f64(self.to_array())
    }
}
impl<T: Real> Broadcast<T> for Quat<f64> {
    type Output = Quat<T>;
    fn broadcast(&self) -> Quat<T> {
        Quat::from_f64(self.to_array())
    }
}
impl<T: Real, const N: usize> Broadcast<T> for [f64; N] {
    type Output = [T; N];
    fn broadcast(&self) -> [T; N] {
        self.map(T::new)
    }
}
impl<T, A: Broadcast<T>> Broadcast<T> for Vec<A> {
    type Output = Vec<A::Output>;
    #[inline(never)] // Some ninety fields call it.
    fn broadcast(&self) -> Vec<A::Output> {
        self.iter().map(|a| a.broadcast()).collect()
    }
}

/// A view of consecutive numbers, vectors or quaternions.
pub(super) enum Flat<'a, T> {
    Numbers(&'a [T]),
    Vectors(&'a [Vec3<T>]),
    Quats(&'a [Quat<T>]),
}

/// The mutable view like [`Flat`].
pub(super) enum FlatMut<'a, T> {
    Numbers(&'a mut [T]),
    Vectors(&'a mut [Vec3<T>]),
    Quats(&'a mut [Quat<T>]),
}

impl<T: Real> Flat<'_, T> {
    pub(super) fn len(&self) -> usize {
        match self {
            Flat::Numbers(x) => x.len(),
            Flat::Vectors(v) => 3 * v.len(),
            Flat::Quats(q) => 4 * q.len(),
        }
    }

    /// Returns the number of numbers of a vector or quaternion, else 1.
    pub(super) fn element_width(&self) -> usize {
        match self {
            Flat::Numbers(_) => 1,
            Flat::Vectors(_) => 3,
            Flat::Quats(_) => 4,
        }
    }

    /// Returns a number by its index.
    pub(super) fn number(&self, index: usize) -> T {
        match self {
            Flat::Numbers(x) => x[index],
            Flat::Vectors(v) => v[index / 3].to_array()[index % 3],
            Flat::Quats(q) => q[index / 4].to_array()[index % 4],
        }
    }

    /// Returns the numbers of lane `lane`.
    pub(super) fn read_lane(&self, lane: usize) -> Vec<T::Scalar> {
        let read = |x: T| x.lane(lane);
        match self {
            Flat::Numbers(x) => x.iter().map(|&x| read(x)).collect(),
            Flat::Vectors(v) => v.iter().flat_map(|v| v.to_array().map(read)).collect(),
            Flat::Quats(q) => q.iter().flat_map(|q| q.to_array().map(read)).collect(),
        }
    }
}

impl<T: Real> FlatMut<'_, T> {
    /// Replaces the numbers of lane `lane` from number `start` on, which is the first of a vector or quaternion.
    pub(super) fn write_lane(self, lane: usize, start: usize, row: &[T::Scalar]) {
        match self {
            FlatMut::Numbers(x) => write_lane(row, lane, &mut x[start..][..row.len()]),
            FlatMut::Vectors(v) => write_vectors(row, lane, &mut v[start / 3..]),
            FlatMut::Quats(q) => write_quats(row, lane, &mut q[start / 4..]),
        }
    }
}

/// Writes three numbers of `row` into lane `lane` of each vector.
pub(crate) fn write_vectors<T: Real>(row: &[T::Scalar], lane: usize, to: &mut [Vec3<T>]) {
    for (v, row) in to.iter_mut().zip(row.chunks_exact(3)) {
        set_lane([&mut v.x, &mut v.y, &mut v.z], lane, row);
    }
}

/// Writes four numbers of `row` into lane `lane` of each quaternion.
pub(crate) fn write_quats<T: Real>(row: &[T::Scalar], lane: usize, to: &mut [Quat<T>]) {
    for (q, row) in to.iter_mut().zip(row.chunks_exact(4)) {
        set_lane([&mut q.w, &mut q.x, &mut q.y, &mut q.z], lane, row);
    }
}

/// Writes a number of `row` into lane `lane` of each target.
#[inline(always)]
pub(crate) fn set_lane<T: Real, const N: usize>(to: [&mut T; N], lane: usize, row: &[T::Scalar]) {
    for (to, &value) in to.into_iter().zip(row) {
        T::as_scalars_mut(from_mut(to))[lane] = value;
    }
}

/// A type that consists of numbers of type `T`.
pub(super) trait Numbers<T> {
    /// Returns the shape: elements, numbers per element. Single fields and plain numbers omit that axis.
    fn shape(&self) -> Vec<usize>;
    fn flat(&self) -> Flat<'_, T>;
    fn flat_mut(&mut self) -> FlatMut<'_, T>;
    /// Changes the number of elements. New numbers are zero, and new quaternions the identity; a field without elements
    /// does not change.
    fn resize(&mut self, elements: usize);
}

macro_rules! numbers {
    ($($kind:ident: $element:ty, $zero:expr $(, $size:expr)?;)*) => {$(
        impl<T: Real> Numbers<T> for $element {
            fn shape(&self) -> Vec<usize> {
                vec![$($size)?]
            }
            fn flat(&self) -> Flat<'_, T> {
                Flat::$kind(from_ref(self))
            }
            fn flat_mut(&mut self) -> FlatMut<'_, T> {
                FlatMut::$kind(from_mut(self))
            }
            fn resize(&mut self, _: usize) {}
        }
        impl<T: Real> Numbers<T> for Vec<$element> {
            fn shape(&self) -> Vec<usize> {
                vec![self.len() $(, $size)?]
            }
            fn flat(&self) -> Flat<'_, T> {
                Flat::$kind(self)
            }
            fn flat_mut(&mut self) -> FlatMut<'_, T> {
                FlatMut::$kind(self)
            }
            fn resize(&mut self, elements: usize) {
                Vec::resize(self, elements, $zero);
            }
        }
    )*};
}
numbers! {
    Numbers: T, T::ZERO;
    Vectors: Vec3<T>, Vec3::ZERO, 3;
    Quats: Quat<T>, Quat::IDENTITY, 4;
}

impl<T: Real, const N: usize> Numbers<T> for [T; N] {
    fn shape(&self) -> Vec<usize> {
        vec![N]
    }
    fn flat(&self) -> Flat<'_, T> {
        Flat::Numbers(self)
    }
    fn flat_mut(&mut self) -> FlatMut<'_, T> {
        FlatMut::Numbers(self)
    }
    fn resize(&mut self, _: usize) {}
}
impl<T: Real, const N: usize> Numbers<T> for Vec<[T; N]> {
    fn shape(&self) -> Vec<usize> {
        vec![self.len(), N]
    }
    fn flat(&self) -> Flat<'_, T> {
        Flat::Numbers(self.as_flattened())
    }
    fn flat_mut(&mut self) -> FlatMut<'_, T> {
        FlatMut::Numbers(self.as_flattened_mut())
    }
    fn resize(&mut self, elements: usize) {
        Vec::resize(self, elements, [T::ZERO; N]);
    }
}
