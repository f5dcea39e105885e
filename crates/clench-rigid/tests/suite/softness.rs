//! Softness: MuJoCo's numbers, and their effect on a mass.

use clench_math::{Lanes, Real};
use clench_rigid::constraint::{Softness, impedance};

/// The limit of MuJoCo's `refsafe`: twice a time step of 2 ms.
const LEAST: f64 = 0.004;

type Solref = [f64; 2];
type Solimp = [f64; 5];

/// The solref, solimp and position of a slide's limit with A₀ = 0.5, and its impedance, stiffness k, damping b and R,
/// measured in MuJoCo 4.0.0 (`efc_KBIP`, `efc_R`).
#[rustfmt::skip]
const MEASURED: [(Solref, Solimp, f64, [f64; 4]); 14] = [
    ([0.02, 1.0], [0.9, 0.95, 0.001, 0.5, 2.0], -0.0001, [0.901, 2770.083102493075, 105.26315789473685, 0.054938956714761365]),
    ([0.02, 1.0], [0.9, 0.95, 0.001, 0.5, 2.0], -0.5, [0.95, 2770.083102493075, 105.26315789473685, 0.026315789473684237]),
    ([0.02, 1.0], [0.2, 0.99, 0.01, 0.3, 1.0], -0.0055, [0.6345, 2550.7601265177022, 101.010101010101, 0.2880220646178094]),
    ([0.02, 1.0], [0.5, 0.8, 0.02, 0.3, 3.5], -0.0001, [0.5000000537914354, 3906.2499999999995, 125.0, 0.4999998924171407]),
    ([0.02, 1.0], [0.5, 0.8, 0.02, 0.3, 3.5], -0.0055, [0.5663716396054003, 3906.2499999999995, 125.0, 0.3828125651707377]),
    ([0.02, 1.0], [0.0, 1.0, 0.02, 0.7, 2.0], -0.0001, [0.00013570714285714286, 2500.500075010001, 100.0100010001, 3683.9044423390706]),
    ([0.02, 1.0], [0.0, 1.0, 0.02, 0.7, 2.0], -0.5, [0.9999, 2500.500075010001, 100.0100010001, 5.00050005000445e-05]),
    ([0.02, 1.0], [0.9, 0.9, 0.01, 0.5, 2.0], -0.0055, [0.9, 3086.419753086419, 111.1111111111111, 0.05555555555555554]),
    ([0.02, 1.0], [0.8, 0.9, 0.0, 0.5, 2.0], -0.0001, [0.8500000000000001, 3086.419753086419, 111.1111111111111, 0.088235294117647]),
    ([0.001, 0.7], [0.2, 0.99, 0.01, 0.3, 1.0], -0.0055, [0.6345, 130140.82278151544, 505.0505050505051, 0.2880220646178094]),
    ([-1000.0, -30.0], [0.9, 0.95, 0.001, 0.5, 2.0], -0.0001, [0.901, 1108.03324099723, 31.578947368421055, 0.054938956714761365]),
    ([-1000.0, -30.0], [0.0, 1.0, 0.02, 0.7, 2.0], -0.0055, [0.10811410714285713, 1000.2000300040004, 30.003000300030003, 4.124743368035427]),
    ([0.02, -1.0], [0.2, 0.99, 0.01, 0.3, 1.0], -0.0001, [0.2079, 2550.7601265177022, 101.010101010101, 1.905002405002405]),
    ([0.0, 0.0], [0.5, 0.8, 0.02, 0.3, 3.5], -0.0055, [0.5663716396054003, -0.0, -0.0, 0.3828125651707377]),
];

fn close(found: f64, expected: f64, what: &str) {
    let error = (found - expected).abs();
    assert!(
        error <= 4e-15 * expected.abs(),
        "{what}: {found} instead of {expected}"
    );
}

#[test]
fn softness_has_mujocos_numbers() {
    for (solref, solimp, pos, [d, k, b, r]) in MEASURED {
        let soft = Softness::new(solref, solimp, pos, LEAST);
        close(soft.impedance, d, "impedance");
        close(soft.stiffness, k * d, "stiffness");
        close(soft.damping, b, "damping");
        // 1 − d loses the last digits of d.
        let cancelled = (soft.regularization(0.5) / r - 1.0).abs() * (1.0 - d);
        assert!(cancelled < 4e-16, "R of {solimp:?} at {pos}");
    }
}

#[test]
fn a_mass_on_one_constraint_follows_the_impedance() {
    // Minimizes m/2 (a − a_unc)² + D/2 (a − aref)² with A₀ = 1/m.
    let (m, a_unc, v, r) = (3.0, -9.81, -0.2, -0.0004);
    let soft = Softness::new([0.05, 0.8], [0.6, 0.9, 0.001, 0.4, 3.0], r, 0.0);
    let d = 1.0 / soft.regularization(1.0 / m);
    let aref = -soft.damping * v - soft.stiffness * r;
    let a = (m * a_unc + d * aref) / (m + d);
    let mix = soft.impedance * aref + (1.0 - soft.impedance) * a_unc;
    assert!((a - mix).abs() < 1e-12, "{a} against {mix}");
}

#[test]
fn impedance_rises_from_dmin_to_dmax_without_a_jump() {
    for power in [1.0, 1.5, 2.0, 4.0] {
        let solimp = [0.3, 0.8, 0.01, 0.35, power];
        let mut last = impedance(solimp, 0.0);
        assert_eq!(last, 0.3);
        for i in 1..=1000 {
            let next = impedance(solimp, -0.01 * f64::from(i) / 1000.0);
            assert!(next >= last, "it falls at {i}");
            assert!(next - last < 0.01, "it jumps at {i}");
            last = next;
        }
        assert!((last - 0.8).abs() < 1e-15);
        assert_eq!(impedance(solimp, 0.02), 0.8);
    }
}

#[test]
fn time_constants_have_a_floor_and_direct_parameters_none() {
    let solimp = [0.9, 0.95, 0.001, 0.5, 2.0];
    let floored = Softness::new([0.001, 1.0], solimp, -1.0, LEAST);
    assert_eq!(
        floored.damping,
        Softness::new([LEAST, 1.0], solimp, -1.0, 0.0).damping
    );
    let direct = Softness::new([-1e6, -1e4], solimp, -1.0, LEAST);
    assert_eq!(direct.damping, 1e4 / 0.95);
}

#[test]
fn softness_in_lanes_equals_scalars() {
    type L = Lanes<f64, 4>;
    let of = |values: [f64; 4]| L::from_array(values);
    let r = of([-0.0001, -0.0055, 0.003, -0.5]);
    let power = of([2.0, 1.0, 3.5, 2.0]);
    let width = of([0.001, 0.01, 0.02, 0.0]);
    let solref = [of([0.02, -300.0, 0.001, 0.02]), of([1.0, -20.0, 0.5, -1.0])];
    let fill = |x: f64| L::new(x);
    let solimp = [fill(0.8), fill(0.9), width, fill(0.3), power];
    let together = Softness::new(solref, solimp, r, fill(LEAST));
    for lane in 0..4 {
        let alone = Softness::new(
            solref.map(|x| x.lane(lane)),
            solimp.map(|x| x.lane(lane)),
            r.lane(lane),
            LEAST,
        );
        assert_eq!(
            together.impedance.lane(lane).to_bits(),
            alone.impedance.to_bits()
        );
        assert_eq!(
            together.stiffness.lane(lane).to_bits(),
            alone.stiffness.to_bits()
        );
        assert_eq!(
            together.damping.lane(lane).to_bits(),
            alone.damping.to_bits()
        );
    }
}
