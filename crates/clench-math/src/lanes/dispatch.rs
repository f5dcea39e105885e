//! Detection of the processor's instruction sets, and dispatch of tasks to lanes of them.

#[cfg(any(lanes = "avx2", lanes = "avx512", lanes = "neon", lanes = "portable"))]
use super::Lanes;
#[cfg(lanes = "portable")]
use super::Portable;
#[cfg(lanes = "neon")]
use super::neon::Neon;
#[cfg(any(lanes = "avx2", lanes = "avx512"))]
use super::registers::Registers;
#[cfg(target_arch = "x86_64")]
use super::{avx2::Avx2, avx512::Avx512};
use crate::real::{Real, Scalar};

/// The instruction set that holds the numbers of several environments in parallel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Instructions {
    /// One environment at a time.
    Scalar,
    /// Plain arrays, 2 × `f64` or 4 × `f32`, on architectures without one of the sets below. (On the others they would
    /// be slower than these sets, and as much code to compile; x86-64 without AVX2 processes one environment at a
    /// time.)
    Portable,
    /// 2 × `f64`, 4 × `f32` on ARM.
    Neon,
    /// 4 × `f64`, 8 × `f32`.
    Avx2,
    /// 8 × `f64`, 16 × `f32`.
    Avx512,
}

impl Instructions {
    /// All instruction sets, narrowest first.
    const ALL: [Instructions; 5] = [
        Instructions::Scalar,
        Instructions::Portable,
        Instructions::Neon,
        Instructions::Avx2,
        Instructions::Avx512,
    ];

    /// Returns true if lanes of these instructions were compiled and this processor has them.
    pub fn available(self) -> bool {
        self.compiled() && self.detected()
    }

    /// Returns true if lanes of these instructions were compiled; `build.rs` selects them.
    fn compiled(self) -> bool {
        match self {
            Instructions::Scalar => true,
            Instructions::Portable => cfg!(lanes = "portable"),
            Instructions::Neon => cfg!(lanes = "neon"),
            Instructions::Avx2 => cfg!(lanes = "avx2"),
            Instructions::Avx512 => cfg!(lanes = "avx512"),
        }
    }

    /// Returns true if this processor has them.
    fn detected(self) -> bool {
        match self {
            Instructions::Scalar => true,
            Instructions::Portable => {
                cfg!(not(any(target_arch = "x86_64", target_arch = "aarch64")))
            }
            Instructions::Neon => cfg!(target_arch = "aarch64"),
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2 => Avx2::detected(),
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx512 => Avx512::detected(),
            #[cfg(not(target_arch = "x86_64"))]
            Instructions::Avx2 | Instructions::Avx512 => false,
        }
    }

    /// Returns advice for users if the processor has lanes but the build omitted them, so that batches process one
    /// environment at a time.
    pub fn advice() -> Option<&'static str> {
        let has_lanes = Self::ALL
            .into_iter()
            .any(|i| i.detected() && i != Instructions::Scalar);
        (has_lanes && Self::widest() == Instructions::Scalar).then_some(
            "this build of Clench has no lanes for this processor, so environments are stepped one at a time; \
             build it on this machine, or with CLENCH_INSTRUCTIONS=all in the environment",
        )
    }

    /// Returns the instruction sets that are [available for](Self::available_for) a precision, narrowest first.
    pub fn all_available<S: Scalar>() -> impl DoubleEndedIterator<Item = Instructions> {
        Self::ALL.into_iter().filter(|i| i.available_for::<S>())
    }

    /// Returns true if kernels in the precision `S` were compiled for these instructions and this processor has them.
    /// If one instruction set was compiled, single precision has no scalar kernels.
    pub fn available_for<S: Scalar>(self) -> bool {
        self.available() && (self != Instructions::Scalar || S::SINGLE_ENV == Instructions::Scalar)
    }

    /// Returns the widest instruction set that is [available](Self::available).
    pub fn widest() -> Instructions {
        Self::all_available::<f64>()
            .next_back()
            .unwrap_or(Instructions::Scalar)
    }

    /// Runs a task in the widest lanes for which derivatives were compiled. A build may have them for fewer instruction
    /// sets than steps; `build.rs` selects them.
    ///
    /// # Errors
    /// Returns the widest instruction set of steps if derivatives were not compiled for this processor.
    pub fn with_derivatives<K: LaneTask<f64>>(task: K) -> Result<K::Output, Instructions> {
        let mut available = Self::all_available::<f64>();
        let widest = available.rfind(|set| set.has_derivatives());
        let widest = widest.ok_or(Self::widest())?;
        derivatives(widest, task).ok_or(widest)
    }

    /// Returns true if derivatives were compiled for lanes of these instructions.
    fn has_derivatives(self) -> bool {
        match self {
            Instructions::Scalar => cfg!(derivatives = "scalar"),
            Instructions::Portable => cfg!(derivatives = "portable"),
            Instructions::Neon => cfg!(derivatives = "neon"),
            Instructions::Avx2 => cfg!(derivatives = "avx2"),
            Instructions::Avx512 => cfg!(derivatives = "avx512"),
        }
    }

    /// Returns the number of lanes of type `S`.
    pub fn lanes<S: Scalar>(self) -> usize {
        let bytes = match self {
            Instructions::Scalar => return 1,
            Instructions::Portable | Instructions::Neon => 16,
            Instructions::Avx2 => 32,
            Instructions::Avx512 => 64,
        };
        bytes / size_of::<S>()
    }
}

/// The type in which one environment in single precision is computed: lanes that all hold the same numbers if one set
/// of them was compiled, which saves a scalar version of every kernel.
#[cfg(single = "avx2")]
pub(crate) type Single = Lanes<f32, 8, Avx2>;
#[cfg(single = "avx512")]
pub(crate) type Single = Lanes<f32, 16, Avx512>;
#[cfg(single = "neon")]
pub(crate) type Single = Lanes<f32, 4, Neon>;
#[cfg(single = "portable")]
pub(crate) type Single = Lanes<f32, 4, Portable>;
#[cfg(single = "scalar")]
pub(crate) type Single = f32;

/// The instructions of [`Single`].
pub(crate) const SINGLE: Instructions = match () {
    _ if cfg!(single = "avx2") => Instructions::Avx2,
    _ if cfg!(single = "avx512") => Instructions::Avx512,
    _ if cfg!(single = "neon") => Instructions::Neon,
    _ if cfg!(single = "portable") => Instructions::Portable,
    _ => Instructions::Scalar,
};

/// A task to run in lanes whose type is known only at run time.
pub trait LaneTask<S: Scalar> {
    /// The result.
    type Output;
    /// Runs the task in lanes of type `T`.
    fn run<T: Real<Scalar = S>>(self) -> Self::Output;
}

/// Runs a closure compiled for the widest instruction set that lanes are compiled for and this processor has.
#[inline(always)]
pub(crate) fn in_widest<R>(kernel: impl FnOnce() -> R) -> R {
    #[cfg(lanes = "avx512")]
    if Avx512::detected() {
        return <Avx512 as Registers<f64, 8>>::vectorize(kernel);
    }
    #[cfg(lanes = "avx2")]
    if Avx2::detected() {
        return <Avx2 as Registers<f64, 4>>::vectorize(kernel);
    }
    kernel()
}

macro_rules! in_lanes {
    ($(#[$has_scalar:meta])* $name:ident $scalar:ident $compiled:ident: $narrow:literal $medium:literal $wide:literal) => {
        /// Runs a task in lanes of these instructions; `None` if they are not available.
        #[inline(always)]
        pub(crate) fn $name<K: LaneTask<$scalar>>(
            instructions: Instructions,
            task: K,
        ) -> Option<K::Output> {
            Some(match instructions {
                _ if !instructions.available() => return None,
                $(#[$has_scalar])*
                Instructions::Scalar => task.run::<$scalar>(),
                #[cfg($compiled = "neon")]
                Instructions::Neon => task.run::<Lanes<$scalar, $narrow, Neon>>(),
                #[cfg($compiled = "avx2")]
                Instructions::Avx2 => task.run::<Lanes<$scalar, $medium, Avx2>>(),
                #[cfg($compiled = "avx512")]
                Instructions::Avx512 => task.run::<Lanes<$scalar, $wide, Avx512>>(),
                #[cfg($compiled = "portable")]
                Instructions::Portable => task.run::<Lanes<$scalar, $narrow, Portable>>(),
                _ => return None,
            })
        }
    };
}
in_lanes!(f64 f64 lanes: 2 4 8);
in_lanes!(
    #[cfg(single = "scalar")]
    f32 f32 lanes: 4 8 16
);
in_lanes!(
    #[cfg(derivatives = "scalar")]
    derivatives f64 derivatives: 2 4 8
);
