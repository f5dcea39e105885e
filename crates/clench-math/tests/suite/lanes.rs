//! Every operation on lanes equals the scalar operation to the bit.

use crate::support::{EqualsAlone, Formula, Random, TestScalar, in_arrays, in_instruction_sets};
use clench_math::{
    Instructions, LaneMask, LaneTask, Lanes, Mask, Real, Scalar, broadcast, cast, read_lane,
    write_lane,
};

const ROUNDS: usize = 3000;

#[derive(Clone, Copy)]
struct Arithmetic;
impl Formula for Arithmetic {
    const ARGUMENTS: usize = 3;
    #[inline(always)]
    fn evaluate<T: Real>(self, arguments: &[T]) -> Vec<(&'static str, T)> {
        let [x, y, z] = [arguments[0], arguments[1], arguments[2]];
        let mut assigned = [x; 4];
        assigned[0] += y;
        assigned[1] -= y;
        assigned[2] *= y;
        assigned[3] /= y;
        // For a NaN, `exp2_integer` may return any bits.
        let whole = T::select(x.eq(x), x.floor(), T::ZERO);
        vec![
            ("x + y", x + y),
            ("x − y", x - y),
            ("x y", x * y),
            ("x / y", x / y),
            ("−x", -x),
            ("x += y", assigned[0]),
            ("x −= y", assigned[1]),
            ("x *= y", assigned[2]),
            ("x /= y", assigned[3]),
            // Must not be contracted into one rounding.
            ("x y + z", x * y + z),
            ("x y − z", x * y - z),
            ("z − x y", z - x * y),
            ("abs", x.abs()),
            ("sqrt", x.sqrt()),
            ("min", x.min(y)),
            ("max", x.max(y)),
            ("clamp", x.clamp(y, z)),
            ("copysign", x.copysign(y)),
            ("floor", x.floor()),
            ("squared", x.squared()),
            ("exp2_integer", whole.exp2_integer()),
            ("exponent", x.split_exponent().0),
            ("mantissa", x.split_exponent().1),
        ]
    }
}

#[derive(Clone, Copy)]
struct Comparisons;
impl Formula for Comparisons {
    const ARGUMENTS: usize = 3;
    #[inline(always)]
    fn evaluate<T: Real>(self, arguments: &[T]) -> Vec<(&'static str, T)> {
        let [x, y, z] = [arguments[0], arguments[1], arguments[2]];
        let (a, b) = (x.lt(y), y.le(z));
        let (mut and, mut or) = (a, a);
        and &= b;
        or |= b;
        let masks = [
            ("x < y", x.lt(y)),
            ("x ≤ y", x.le(y)),
            ("x > y", x.gt(y)),
            ("x ≥ y", x.ge(y)),
            ("x = y", x.eq(y)),
            ("x = x", x.eq(x)),
            ("is_finite", x.is_finite()),
            ("and", a & b),
            ("or", a | b),
            ("not", !a),
            ("&=", and),
            ("|=", or),
            ("true", T::Mask::splat(true)),
            ("false", T::Mask::splat(false)),
        ];
        let mut numbers = vec![("select", T::select(a, z, x))];
        for (name, mask) in masks {
            numbers.push((name, T::select(mask, T::ONE, T::ZERO)));
        }
        numbers
    }
}

#[derive(Clone, Copy)]
struct Functions;
impl Formula for Functions {
    const ARGUMENTS: usize = 2;
    #[inline(always)]
    fn evaluate<T: Real>(self, arguments: &[T]) -> Vec<(&'static str, T)> {
        let [x, y] = [arguments[0], arguments[1]];
        let (sine, cosine) = x.sin_cos();
        vec![
            ("sin_cos.0", sine),
            ("sin_cos.1", cosine),
            ("sin", x.sin()),
            ("cos", x.cos()),
            ("atan2", y.atan2(x)),
            ("exp", x.exp()),
            ("ln", x.ln()),
            ("ln |x|", x.abs().ln()),
            ("powf", x.powf(y)),
            ("powf |x|", x.abs().powf(y)),
        ]
    }
}

/// A formula that is not compiled for the instruction set of its lanes: each operation is a call.
#[derive(Clone, Copy)]
struct Called<F>(F);
impl<F: Formula> Formula for Called<F> {
    const ARGUMENTS: usize = F::ARGUMENTS;
    #[inline(never)]
    fn evaluate<T: Real>(self, arguments: &[T]) -> Vec<(&'static str, T)> {
        self.0.evaluate(arguments)
    }
}

fn operations_equal_scalars<S: TestScalar>() {
    fn check<S: TestScalar>(formula: impl Formula, draw: &dyn Fn(&mut Random) -> S) {
        let task = EqualsAlone {
            formula,
            rounds: ROUNDS,
            draw,
        };
        in_instruction_sets(task);
        in_arrays(task);
    }
    check(Arithmetic, &Random::any::<S>);
    check(Comparisons, &Random::any::<S>);
    check(Called(Arithmetic), &Random::any::<S>);
    check(Called(Comparisons), &Random::any::<S>);
    check(Functions, &Random::any::<S>);
    // Usual arguments, and arguments at the ends of the functions' ranges.
    for size in [1e-9, 1.0, 30.0, 800.0, 1e6] {
        check(Functions, &|random| S::new(random.between(-size, size)));
    }
}
#[test]
fn operations_in_lanes_equal_scalars_in_double_precision() {
    operations_equal_scalars::<f64>();
}
#[test]
fn operations_in_lanes_equal_scalars_in_single_precision() {
    operations_equal_scalars::<f32>();
}

/// Checks the guarantees of `Real` for scalars beyond the language's own operations.
#[test]
fn scalars_have_the_operations_of_the_language() {
    fn check<S: TestScalar>() {
        let mut random = Random::new(1);
        for _ in 0..ROUNDS {
            let [x, y] = [random.any::<S>(), random.any()];
            let smaller = if x < y { x } else { y };
            let larger = if x > y { x } else { y };
            assert_eq!(Real::min(x, y).identity(), smaller.identity());
            assert_eq!(Real::max(x, y).identity(), larger.identity());
            let comparisons = [x.lt(y), x.le(y), x.gt(y), x.ge(y), x.eq(y)];
            assert_eq!(comparisons, [x < y, x <= y, x > y, x >= y, x == y]);
            assert_eq!(x.is_finite(), x.to_f64().is_finite());
        }
    }
    check::<f64>();
    check::<f32>();
}

/// A task that compares masks with arrays of Booleans.
#[derive(Clone, Copy)]
struct Masks;
impl<S: TestScalar> LaneTask<S> for Masks {
    type Output = ();
    fn run<T: Real<Scalar = S>>(self) {
        let mut random = Random::new(1000 + T::LANES as u64);
        for round in 0..ROUNDS {
            // Mostly true, mostly false, all true or all false, so that `any` and `all` return both results.
            let mut flags = || {
                let (a, b) = (random.bits(), random.bits());
                let bits = [a & b, a | b, 0, u64::MAX][(random.bits() % 4) as usize];
                let flags: Vec<bool> = (0..T::LANES).map(|i| bits >> i & 1 == 1).collect();
                flags
            };
            let (a, b) = (flags(), flags());
            let mask = |flags: &[bool]| {
                let mut mask = T::Mask::splat(round % 2 == 0);
                for (i, &flag) in flags.iter().enumerate() {
                    mask.set_lane(i, flag);
                }
                mask
            };
            let lanes = |mask: T::Mask| (0..T::LANES).map(|i| mask.lane(i)).collect::<Vec<_>>();
            let (x, y) = (mask(&a), mask(&b));
            assert_eq!(lanes(x), a);
            assert_eq!(x.any(), a.contains(&true));
            assert_eq!(x.all(), !a.contains(&false));
            assert_eq!(x.count(), a.iter().filter(|&&flag| flag).count());
            assert_eq!(x == y, a == b);
            let zip = |f: fn(bool, bool) -> bool| -> Vec<bool> {
                a.iter().zip(&b).map(|(&a, &b)| f(a, b)).collect()
            };
            assert_eq!(lanes(x & y), zip(|a, b| a & b));
            assert_eq!(lanes(x | y), zip(|a, b| a | b));
            assert_eq!(lanes(!x), zip(|a, _| !a));
            assert_eq!((!x).count(), T::LANES - x.count());
        }
        for (mask, value) in [(T::Mask::splat(true), true), (T::Mask::splat(false), false)] {
            assert_eq!((mask.any(), mask.all()), (value, value));
            assert!((0..T::LANES).all(|i| mask.lane(i) == value));
        }
    }
}
#[test]
fn masks_are_arrays_of_truth_values() {
    in_instruction_sets::<f64>(Masks);
    in_instruction_sets::<f32>(Masks);
    in_arrays::<f64>(Masks);
    in_arrays::<f32>(Masks);
}

/// A task that checks that the values written to lane `i` are read from lane `i`.
#[derive(Clone, Copy)]
struct Places;
impl<S: TestScalar> LaneTask<S> for Places {
    type Output = ();
    fn run<T: Real<Scalar = S>>(self) {
        let mut random = Random::new(3);
        let rows: Vec<[S; 7]> = (0..T::LANES)
            .map(|_| std::array::from_fn(|_| random.any()))
            .collect();
        let (mut by_rows, mut by_lanes) = ([T::ONE; 7], [T::ONE; 7]);
        for (i, row) in rows.iter().enumerate() {
            write_lane(row, i, &mut by_rows);
            for (lanes, &value) in by_lanes.iter_mut().zip(row) {
                lanes.set_lane(i, value);
            }
        }
        for (i, row) in rows.iter().enumerate() {
            let expected = row.map(S::identity);
            let mut back = [S::ZERO; 7];
            read_lane(&by_rows, i, &mut back);
            assert_eq!(back.map(S::identity), expected);
            assert_eq!(by_rows.map(|x| x.lane(i).identity()), expected);
            assert_eq!(by_lanes.map(|x| x.lane(i).identity()), expected);
        }
        let scalars = T::as_scalars(&by_rows);
        assert_eq!(scalars.len(), 7 * T::LANES);
        for (place, value) in scalars.iter().enumerate() {
            let (number, lane) = (place / T::LANES, place % T::LANES);
            assert_eq!(value.identity(), rows[lane][number].identity());
        }

        let constants = [0.1, -7.0, f64::INFINITY];
        let mut everywhere = [T::ONE; 3];
        broadcast(&constants, &mut everywhere);
        for (i, value) in constants.into_iter().enumerate() {
            let value = S::new(value);
            for x in [everywhere[i], cast(constants)[i], T::splat(value)] {
                assert!((0..T::LANES).all(|lane| x.lane(lane) == value));
            }
        }
        for (x, value) in [(T::ZERO, 0.0), (T::default(), 0.0), (T::ONE, 1.0)] {
            assert!((0..T::LANES).all(|lane| x.lane(lane).to_f64() == value));
        }
    }
}
#[test]
fn lanes_keep_their_places() {
    in_instruction_sets::<f64>(Places);
    in_instruction_sets::<f32>(Places);
    in_arrays::<f64>(Places);
    in_arrays::<f32>(Places);
}

#[test]
fn arrays_become_lanes_and_back() {
    let values = [1.0, -2.0, 3.5, f64::INFINITY];
    let x: Lanes<f64, 4> = values.into();
    assert_eq!(x.to_array(), values);
    assert_eq!(x, Lanes::from_fn(|i| values[i]));
    assert!(x.iter().eq(values));
    assert_eq!(<[f64; 4]>::from(x), values);
    assert_eq!(format!("{x:?}"), "[1.0, -2.0, 3.5, inf]");
    let flags = [true, false, true];
    let mask = LaneMask::<f32, 3>::from_array(flags);
    assert_eq!(mask.to_array(), flags);
    assert!(mask.iter().eq(flags));
    assert_eq!(format!("{mask:?}"), "[true, false, true]");
}

/// A task that returns its number of lanes.
struct Width;
impl<S: Scalar> LaneTask<S> for Width {
    type Output = usize;
    fn run<T: Real<Scalar = S>>(self) -> usize {
        T::LANES
    }
}

#[test]
fn tasks_run_in_the_requested_lanes() {
    fn check<S: Scalar>(instructions: Instructions) {
        let lanes = (instructions.available_for::<S>()).then(|| instructions.lanes::<S>());
        assert_eq!(S::in_lanes(instructions, Width), lanes, "{instructions:?}");
    }
    for instructions in [
        Instructions::Scalar,
        Instructions::Portable,
        Instructions::Neon,
        Instructions::Avx2,
        Instructions::Avx512,
    ] {
        check::<f64>(instructions);
        check::<f32>(instructions);
    }
    assert_eq!(Instructions::Scalar.lanes::<f64>(), 1);
    assert_eq!(Instructions::Portable.lanes::<f32>(), 4);
    assert_eq!(Instructions::Avx512.lanes::<f64>(), 8);
    let widest = Instructions::widest();
    assert!(
        Instructions::all_available::<f64>().all(|i| i.lanes::<f64>() <= widest.lanes::<f64>())
    );
    // No processor supports both.
    assert!(!(Instructions::Neon.available() && Instructions::Avx2.available()));
}
