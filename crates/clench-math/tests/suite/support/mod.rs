//! Reproducible random numbers for the tests.
//!
//! This is no external crate: the tests need control of bit patterns (subnormals, signed zeros, NaN), and splitmix64
//! (Steele, Lea and Flood, 2014) takes ten lines.

use clench_math::{Instructions, LaneTask, Lanes, Quat, Real, Scalar, Vec3, kernel, read_lane};

/// A seeded source of numbers.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    /// Returns a uniform number in `[low, high)`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1u64 << 53) as f64)
    }
    pub fn vector(&mut self, size: f64) -> Vec3<f64> {
        Vec3::new(
            self.between(-size, size),
            self.between(-size, size),
            self.between(-size, size),
        )
    }
    pub fn unit_vector(&mut self) -> Vec3<f64> {
        self.vector(1.0).normalize().0
    }
    pub fn rotation(&mut self) -> Quat<f64> {
        let mut part = || self.between(-1.0, 1.0);
        Quat::new(part(), part(), part(), part()).normalize()
    }
    /// Returns a number of any kind: a special value, any bit pattern or an ordinary number.
    pub fn any<S: TestScalar>(&mut self) -> S {
        let choice = self.bits();
        match choice % 4 {
            0 => {
                let special = [
                    0.0,
                    f64::INFINITY,
                    f64::NAN,
                    1.0,
                    2.0,
                    0.5,
                    S::MAX.to_f64(),
                    S::EPSILON.to_f64(),
                    S::MIN_POSITIVE.to_f64(),
                    S::MIN_POSITIVE.to_f64() * (1.0 - S::EPSILON.to_f64()),
                    S::MIN_POSITIVE.to_f64() * S::EPSILON.to_f64(),
                ];
                let value = S::new(special[(choice >> 8) as usize % special.len()]);
                if choice & (1 << 7) == 0 {
                    value
                } else {
                    -value
                }
            }
            1 => S::from_any_bits(self.bits()),
            2 => S::new(self.between(-10.0, 10.0)),
            // Multiples of 0.5, which exercise floor, comparisons and ties.
            _ => S::new(self.between(-8.0, 8.0).floor() * 0.5),
        }
    }
}

/// Access to the representation, which `Scalar` does not provide.
pub trait TestScalar: Scalar {
    fn from_any_bits(bits: u64) -> Self;
    /// Returns the bits; all NaNs are equal.
    fn identity(self) -> u64;
}
impl TestScalar for f64 {
    fn from_any_bits(bits: u64) -> f64 {
        f64::from_bits(bits)
    }
    fn identity(self) -> u64 {
        if self.is_nan() {
            f64::NAN.to_bits()
        } else {
            self.to_bits()
        }
    }
}
impl TestScalar for f32 {
    fn from_any_bits(bits: u64) -> f32 {
        f32::from_bits(bits as u32)
    }
    fn identity(self) -> u64 {
        let bits = if self.is_nan() {
            f32::NAN.to_bits()
        } else {
            self.to_bits()
        };
        u64::from(bits)
    }
}

/// Runs a task in lanes of all instruction sets that the processor has.
pub fn in_instruction_sets<S: TestScalar>(task: impl LaneTask<S, Output = ()> + Copy) {
    for instructions in Instructions::all_available::<S>() {
        assert!(S::in_lanes(instructions, task).is_some());
    }
}
/// Runs a task in arrays of several widths.
pub fn in_arrays<S: TestScalar>(task: impl LaneTask<S, Output = ()> + Copy) {
    task.run::<Lanes<S, 2>>();
    task.run::<Lanes<S, 3>>();
    task.run::<Lanes<S, 4>>();
    task.run::<Lanes<S, 5>>();
    task.run::<Lanes<S, 8>>();
    task.run::<Lanes<S, 16>>();
}

/// A function from numbers to numbers, written once for every `Real`.
pub trait Formula: Copy {
    /// The number of arguments.
    const ARGUMENTS: usize;
    /// Returns the named results. Implementations are to be marked `#[inline(always)]`.
    fn evaluate<T: Real>(self, arguments: &[T]) -> Vec<(&'static str, T)>;
}

/// A task that checks that a formula in lanes gives each environment, to the bit, its result alone.
#[derive(Clone, Copy)]
pub struct EqualsAlone<'a, F, S> {
    pub formula: F,
    pub rounds: usize,
    /// The function that draws an argument.
    pub draw: &'a dyn Fn(&mut Random) -> S,
}
impl<S: TestScalar, F: Formula> LaneTask<S> for EqualsAlone<'_, F, S> {
    type Output = ();
    fn run<T: Real<Scalar = S>>(self) {
        let mut random = Random::new(T::LANES as u64);
        let mut arguments = vec![T::ZERO; F::ARGUMENTS];
        let mut row = vec![S::ZERO; F::ARGUMENTS];
        for _ in 0..self.rounds {
            T::as_scalars_mut(&mut arguments).fill_with(|| (self.draw)(&mut random));
            let together = evaluate(self.formula, &arguments);
            for lane in 0..T::LANES {
                read_lane(&arguments, lane, &mut row);
                let alone = evaluate(self.formula, &row);
                assert_eq!(alone.len(), together.len());
                for (&(name, together), (_, alone)) in together.iter().zip(alone) {
                    let together = together.lane(lane);
                    assert!(
                        together.identity() == alone.identity(),
                        "{name} of {row:?} in lane {lane} of {}: {together:e} instead of {alone:e}",
                        std::any::type_name::<T>(),
                        together = together.to_f64(),
                        alone = alone.to_f64(),
                    );
                }
            }
        }
    }
}
#[kernel]
fn evaluate<T: Real, F: Formula>(formula: F, arguments: &[T]) -> Vec<(&'static str, T)> {
    formula.evaluate(arguments)
}

/// Asserts that |a − b| is at most `tolerance` in every coordinate.
pub fn assert_close<T: Real<Scalar = f64>>(a: &[T], b: &[T], tolerance: f64, what: &str) {
    assert_eq!(a.len(), b.len(), "{what}: lengths differ");
    for (i, (x, y)) in a.iter().zip(b).enumerate() {
        for lane in 0..T::LANES {
            let (x, y) = (x.lane(lane), y.lane(lane));
            assert!(
                (x - y).abs() <= tolerance,
                "{what}: entry {i} is {x}, expected {y}"
            );
        }
    }
}
