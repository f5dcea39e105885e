//! Every operation on lanes equals the scalar operation to the bit.

mod support;

use clench_math::{LaneMask, Lanes, Mask, Real, broadcast, read_lane, write_lane};
use support::{Random, TestScalar};

const ROUNDS: usize = 4000;

struct Case<S, const N: usize> {
    name: &'static str,
    arguments: [[S; N]; 3],
}

impl<S: TestScalar, const N: usize> Case<S, N> {
    fn expect(&self, what: &str, got: Lanes<S, N>, scalar: impl Fn([S; 3]) -> S) {
        for i in 0..N {
            let arguments = self.arguments.map(|a| a[i]);
            let (got, expected) = (got.lane(i), scalar(arguments));
            assert!(
                got.identity() == expected.identity(),
                "{} {what} lane {i} of {arguments:?}: {got:e} instead of {expected:e}",
                self.name,
                got = got.to_f64(),
                expected = expected.to_f64(),
            );
        }
    }
    fn expect_mask(&self, what: &str, got: LaneMask<S, N>, scalar: impl Fn([S; 3]) -> bool) {
        for i in 0..N {
            let arguments = self.arguments.map(|a| a[i]);
            assert_eq!(
                got.lane(i),
                scalar(arguments),
                "{} {what} {arguments:?}",
                self.name
            );
        }
    }
    fn check_all(&self) {
        let [x, y, z] = self.arguments.map(Lanes::from_array);
        self.check_arithmetic(x, y);
        self.check_comparisons(x, y, z);
        self.check_functions(x, y, z);
    }
    fn check_arithmetic(&self, x: Lanes<S, N>, y: Lanes<S, N>) {
        self.expect("+", x + y, |[x, y, _]| x + y);
        self.expect("-", x - y, |[x, y, _]| x - y);
        self.expect("*", x * y, |[x, y, _]| x * y);
        self.expect("/", x / y, |[x, y, _]| x / y);
        self.expect("negation", -x, |[x, ..]| -x);
        let assigned = |operation: fn(&mut Lanes<S, N>, Lanes<S, N>)| {
            let mut result = x;
            operation(&mut result, y);
            result
        };
        self.expect("+=", assigned(|a, b| *a += b), |[x, y, _]| x + y);
        self.expect("-=", assigned(|a, b| *a -= b), |[x, y, _]| x - y);
        self.expect("*=", assigned(|a, b| *a *= b), |[x, y, _]| x * y);
        self.expect("/=", assigned(|a, b| *a /= b), |[x, y, _]| x / y);
    }
    fn check_comparisons(&self, x: Lanes<S, N>, y: Lanes<S, N>, z: Lanes<S, N>) {
        self.expect_mask("lt", x.lt(y), |[x, y, _]| Real::lt(x, y));
        self.expect_mask("le", x.le(y), |[x, y, _]| Real::le(x, y));
        self.expect_mask("gt", x.gt(y), |[x, y, _]| Real::gt(x, y));
        self.expect_mask("ge", x.ge(y), |[x, y, _]| Real::ge(x, y));
        self.expect_mask("eq", Real::eq(x, y), |[x, y, _]| Real::eq(x, y));
        self.expect_mask("is_finite", x.is_finite(), |[x, ..]| Real::is_finite(x));
        self.expect("select", Lanes::select(x.lt(y), z, x), |[x, y, z]| {
            S::select(Real::lt(x, y), z, x)
        });
    }
    fn check_functions(&self, x: Lanes<S, N>, y: Lanes<S, N>, z: Lanes<S, N>) {
        self.expect("abs", x.abs(), |[x, ..]| Real::abs(x));
        self.expect("sqrt", x.sqrt(), |[x, ..]| Real::sqrt(x));
        self.expect("min", x.min(y), |[x, y, _]| Real::min(x, y));
        self.expect("max", x.max(y), |[x, y, _]| Real::max(x, y));
        self.expect("clamp", x.clamp(y, z), |[x, y, z]| Real::clamp(x, y, z));
        self.expect("copysign", x.copysign(y), |[x, y, _]| Real::copysign(x, y));
        self.expect("floor", x.floor(), |[x, ..]| Real::floor(x));
        self.expect("squared", x.squared(), |[x, ..]| x.squared());
        self.expect("exp2_integer", x.exp2_integer(), |[x, ..]| x.exp2_integer());
        self.expect("exponent", x.split_exponent().0, |[x, ..]| {
            x.split_exponent().0
        });
        self.expect("mantissa", x.split_exponent().1, |[x, ..]| {
            x.split_exponent().1
        });
        self.expect("sin_cos.0", x.sin_cos().0, |[x, ..]| Real::sin_cos(x).0);
        self.expect("sin_cos.1", x.sin_cos().1, |[x, ..]| Real::sin_cos(x).1);
        self.expect("sin", x.sin(), |[x, ..]| Real::sin(x));
        self.expect("cos", x.cos(), |[x, ..]| Real::cos(x));
        self.expect("atan2", x.atan2(y), |[x, y, _]| Real::atan2(x, y));
        self.expect("exp", x.exp(), |[x, ..]| Real::exp(x));
        self.expect("ln", x.ln(), |[x, ..]| Real::ln(x));
        self.expect("powf", x.powf(y), |[x, y, _]| Real::powf(x, y));
    }
}

fn check_lanes<S: TestScalar, const N: usize>(name: &'static str) {
    let mut random = Random::new(N as u64);
    for _ in 0..ROUNDS {
        let arguments = std::array::from_fn(|_| std::array::from_fn(|_| random.any::<S>()));
        Case::<S, N> { name, arguments }.check_all();
    }
}

fn check_masks<const N: usize>() {
    let mut random = Random::new(1000 + N as u64);
    for round in 0..ROUNDS {
        // Mostly true, mostly false or mixed, so that `any` and `all` meet both answers at every width.
        let mut flags = || {
            let (a, b) = (random.bits(), random.bits());
            let bits = [a & b, a | b, 0, u64::MAX][(random.bits() % 4) as usize];
            std::array::from_fn::<bool, N, _>(|i| bits >> i & 1 == 1)
        };
        let (a, b) = (flags(), flags());
        let (x, y) = (
            LaneMask::<f64, N>::from_array(a),
            LaneMask::<f64, N>::from_array(b),
        );
        let both = std::array::from_fn(|i| a[i] & b[i]);
        let either = std::array::from_fn(|i| a[i] | b[i]);
        assert_eq!((x & y).to_array(), both);
        assert_eq!((x | y).to_array(), either);
        assert_eq!((!x).to_array(), a.map(|lane| !lane));
        let (mut and, mut or) = (x, x);
        and &= y;
        or |= y;
        assert_eq!((and.to_array(), or.to_array()), (both, either));
        assert_eq!(x.any(), a.contains(&true));
        assert_eq!(x.all(), !a.contains(&false));
        assert_eq!(x == y, a == b);
        assert!(x.iter().eq(a));

        let mut changed = x;
        let i = round % N;
        changed.set_lane(i, !a[i]);
        assert!((0..N).all(|j| changed.lane(j) == (a[j] ^ (i == j))));
    }
    assert!(LaneMask::<f64, N>::splat(true).all());
    assert!(!LaneMask::<f64, N>::splat(false).any());
}

macro_rules! widths {
    ($($test:ident: $scalar:ident $width:literal;)*) => {$(
        #[test]
        fn $test() {
            check_lanes::<$scalar, $width>(stringify!($test));
            check_masks::<$width>();
        }
    )*};
}
widths! {
    f64_by_2: f64 2;
    f64_by_4: f64 4;
    f64_by_8: f64 8;
    f64_by_16: f64 16;
    f32_by_2: f32 2;
    f32_by_4: f32 4;
    f32_by_8: f32 8;
    f32_by_16: f32 16;
    f64_by_5: f64 5;
}

#[test]
fn constructors_and_lanes_keep_their_order() {
    let values = [1.0, -2.0, 3.5, f64::INFINITY];
    let mut x: Lanes<f64, 4> = values.into();
    assert_eq!(x.to_array(), values);
    assert_eq!(x, Lanes::from_fn(|i| values[i]));
    assert!(x.iter().eq(values));
    assert_eq!(<[f64; 4]>::from(x), values);
    x.set_lane(2, -7.0);
    assert_eq!(x.to_array(), [1.0, -2.0, -7.0, f64::INFINITY]);
    assert_eq!(Lanes::<f64, 4>::new(0.1), Lanes::splat(0.1));
    assert_eq!(Lanes::<f32, 4>::new(0.1), Lanes::splat(0.1f32));
    assert_eq!(Lanes::<f32, 4>::default().to_array(), [0.0; 4]);
    assert_eq!(Lanes::<f32, 4>::ONE.to_array(), [1.0; 4]);
}

#[test]
fn rows_survive_the_way_into_lanes_and_back() {
    let mut random = Random::new(3);
    let rows: Vec<[f64; 7]> = (0..4)
        .map(|_| std::array::from_fn(|_| random.any()))
        .collect();
    let mut lanes = [Lanes::<f64, 4>::ZERO; 7];
    for (i, row) in rows.iter().enumerate() {
        write_lane(row, i, &mut lanes);
    }
    for (i, row) in rows.iter().enumerate() {
        let mut back = [0.0; 7];
        read_lane(&lanes, i, &mut back);
        assert_eq!(back.map(f64::identity), row.map(f64::identity));
    }
    broadcast(&rows[1], &mut lanes);
    for (x, value) in lanes.iter().zip(rows[1]) {
        assert!(x.iter().all(|lane| lane.identity() == value.identity()));
    }
}
