//! Kernels that a crate compiles itself, so that dependent crates call them instead of compiling them again.

use crate::lanes::{Instructions, LaneTask};
use crate::real::{Real, Scalar};
use std::any::Any;
use std::marker::PhantomData;

/// A table of functions that are generic over the number type.
pub trait KernelTable {
    /// The functions of one number type, as pointers.
    type Of<T: Real>: Copy + Send + Sync + 'static;
    /// Returns the functions. Naming them compiles them.
    fn of<T: Real>() -> Self::Of<T>;
}

/// The tables of every number type that [`Scalar::in_lanes`] passes to tasks.
///
/// The crate that calls [`new`](Self::new) compiles the kernels. Store the tables in a static of a function that is not
/// generic.
pub struct CompiledKernels(Vec<Box<dyn Any + Send + Sync>>);

impl CompiledKernels {
    /// Compiles the kernels of `K`.
    pub fn new<K: KernelTable>() -> Self {
        let mut tables = Vec::new();
        for instructions in Instructions::all_available::<f64>() {
            tables.extend(f64::in_lanes(instructions, Fill::<K>(PhantomData)));
        }
        for instructions in Instructions::all_available::<f32>() {
            tables.extend(f32::in_lanes(instructions, Fill::<K>(PhantomData)));
        }
        CompiledKernels(tables)
    }

    /// Returns the table of a number type. The caller compiles that of dual numbers.
    ///
    /// # Panics
    /// Panics if [`Scalar::in_lanes`] does not pass `T` to tasks, or if the tables were not made from `K`.
    pub fn table<K: KernelTable, T: Real>(&self) -> K::Of<T> {
        if T::IS_DUAL {
            return K::of::<T>();
        }
        let mut tables = self.0.iter();
        *(tables.find_map(|table| table.downcast_ref()))
            .expect("kernels are compiled for the number types of tasks")
    }
}

/// A task that creates the table of a number type.
struct Fill<K>(PhantomData<K>);

impl<K: KernelTable, S: Scalar> LaneTask<S> for Fill<K> {
    type Output = Box<dyn Any + Send + Sync>;
    fn run<T: Real<Scalar = S>>(self) -> Self::Output {
        Box::new(K::of::<T>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Counting;
    impl KernelTable for Counting {
        type Of<T: Real> = fn(T) -> (usize, T::Scalar);
        fn of<T: Real>() -> Self::Of<T> {
            |x| (T::LANES, x.lane(0))
        }
    }

    struct TableLookup<'a>(&'a CompiledKernels);
    impl<S: Scalar> LaneTask<S> for TableLookup<'_> {
        type Output = (usize, S);
        fn run<T: Real<Scalar = S>>(self) -> (usize, S) {
            self.0.table::<Counting, T>()(T::new(0.5))
        }
    }

    fn check<S: Scalar>(compiled: &CompiledKernels) {
        let all = Vec::from_iter(Instructions::all_available::<S>());
        assert!(!all.is_empty());
        for instructions in all {
            let found = S::in_lanes(instructions, TableLookup(compiled));
            assert_eq!(found, Some((instructions.lanes::<S>(), S::new(0.5))));
        }
    }

    #[test]
    fn every_number_type_of_tasks_has_its_table() {
        let compiled = CompiledKernels::new::<Counting>();
        check::<f64>(&compiled);
        check::<f32>(&compiled);
    }
}
