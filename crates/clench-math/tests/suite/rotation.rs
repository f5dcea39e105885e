//! Vectors, quaternions, matrices and principal axes: identities, and numbers from MuJoCo 4.0's functions.

use crate::support::{Random, assert_close};
use clench_math::{Lanes, Mat3, Quat, Real, Vec3, principal_axes, rough_principal_axes};
use std::f64::consts::PI;

const ROUNDS: usize = 2000;

fn close_vector(a: Vec3<f64>, b: Vec3<f64>, tolerance: f64, what: &str) {
    assert_close(&a.to_array(), &b.to_array(), tolerance, what);
}
fn close_matrix(a: Mat3<f64>, b: Mat3<f64>, tolerance: f64, what: &str) {
    for (a, b) in a.rows.into_iter().zip(b.rows) {
        close_vector(a, b, tolerance, what);
    }
}
/// Asserts that two rotations are equal: q and −q are the same.
fn close_rotation(a: Quat<f64>, b: Quat<f64>, tolerance: f64, what: &str) {
    let dot: f64 = a
        .to_array()
        .iter()
        .zip(b.to_array())
        .map(|(a, b)| a * b)
        .sum();
    let b = b.to_array().map(|part| part * dot.signum());
    assert_close(&a.to_array(), &b, tolerance, what);
}

#[test]
fn rotating_composes_like_multiplying() {
    let mut random = Random::new(1);
    for _ in 0..ROUNDS {
        let (p, q, v) = (random.rotation(), random.rotation(), random.vector(2.0));
        close_vector((p * q).rotate(v), p.rotate(q.rotate(v)), 1e-14, "p q v");
        close_vector(
            q.to_matrix() * v,
            q.rotate(v),
            1e-14,
            "matrix against quaternion",
        );
        close_matrix(
            (p * q).to_matrix(),
            p.to_matrix() * q.to_matrix(),
            1e-14,
            "matrices",
        );
        close_rotation(q * q.conjugate(), Quat::IDENTITY, 1e-15, "q q*");
        close_vector(
            q.conjugate().rotate(q.rotate(v)),
            v,
            1e-14,
            "there and back",
        );
    }
}

#[test]
fn rotation_matrices_are_orthogonal_and_right_handed() {
    let mut random = Random::new(2);
    for _ in 0..ROUNDS {
        let r = random.rotation().to_matrix();
        close_matrix(r * r.transpose(), Mat3::IDENTITY, 1e-14, "R Rᵀ");
        assert!((r.determinant() - 1.0).abs() < 1e-14);
        close_vector(
            r.column(0).cross(r.column(1)),
            r.column(2),
            1e-14,
            "x × y = z",
        );
        let v = random.vector(1.0);
        close_vector(r.transpose_mul(v), r.transpose() * v, 1e-15, "Rᵀ v");
        let columns = Mat3::from_columns(r.column(0), r.column(1), r.column(2));
        assert_eq!(columns, r);
    }
}

#[test]
fn the_determinant_is_multiplicative() {
    let mut random = Random::new(3);
    let mut matrix = || Mat3::from_rows(random.vector(1.0), random.vector(1.0), random.vector(1.0));
    for _ in 0..ROUNDS {
        let (a, b) = (matrix(), matrix());
        assert!(((a * b).determinant() - a.determinant() * b.determinant()).abs() < 1e-14);
    }
    let m = Mat3::<f64>::from_f64([[2.0, 1.0, 0.0], [0.0, 3.0, 4.0], [5.0, 0.0, 6.0]]);
    assert_eq!(m.determinant(), 56.0);
}

#[test]
fn quaternions_come_back_from_their_matrices() {
    let mut random = Random::new(4);
    for round in 0..ROUNDS {
        let mut q = random.rotation();
        // Half and near-half turns about every axis, for which the real part is nearly zero.
        if round % 2 == 0 {
            let axis = random.unit_vector();
            q = Quat::from_axis_angle(axis, PI - random.between(-1e-9, 1e-9));
        }
        close_rotation(
            Quat::from_matrix(&q.to_matrix()),
            q,
            1e-14,
            "quaternion of matrix",
        );
    }
    for axis in 0..3 {
        let mut half_turn = [0.0; 4];
        half_turn[axis + 1] = 1.0;
        let q = Quat::from_f64(half_turn);
        assert_eq!(Quat::<f64>::from_matrix(&q.to_matrix()), q);
    }
}

/// Checks that signs equal those of `mju_mat2Quat` (MuJoCo 4.0.0), which depend on the branch of the matrix.
#[test]
fn quaternion_signs_are_mujocos() {
    let cases: [[f64; 4]; 6] = [
        [0.3, -0.5, 0.7, 0.4],
        [0.55, -0.7, 0.4, 0.2],
        [0.1, -0.3, 0.1, 0.9],
        [0.9, 0.1, -0.3, 0.2],
        [-0.1, 0.2, 0.3, 0.9],
        [-0.1, 0.9, 0.3, 0.2],
    ];
    for q in cases.map(|q| Quat::<f64>::from_f64(q).normalize()) {
        let back = Quat::from_matrix(&q.to_matrix());
        assert_close(&back.to_array(), &q.to_array(), 1e-15, "signs");
    }
}

#[test]
fn the_shortest_rotation_between_two_vectors() {
    let mut random = Random::new(5);
    for round in 0..ROUNDS {
        let from = random.unit_vector();
        let to = match round % 4 {
            0 => -from,
            1 => (from + random.vector(1e-7)).normalize().0,
            2 => (-from + random.vector(1e-7)).normalize().0,
            _ => random.unit_vector(),
        };
        let q = Quat::from_two_vectors(from, to);
        // The axis of nearly opposite vectors depends on the last digits of their cross product.
        let tolerance = if round % 4 == 2 { 1e-8 } else { 1e-14 };
        close_vector(q.rotate(from), to, tolerance, "from turned to to");
        let angle = q.to_rotation_vector().norm();
        let shortest = Real::atan2(from.cross(to).norm(), from.dot(to));
        assert!((angle - shortest).abs() < 1e-8, "{angle} is not {shortest}");
    }
    let z = Vec3::new(0.0, 0.0, 1.0);
    assert_eq!(Quat::from_two_vectors(z, z), Quat::IDENTITY);
    assert_eq!(Quat::from_two_vectors(z, -z), Quat::new(0.0, 1.0, 0.0, 0.0));
    // MuJoCo 4.0.0's orientation of a capsule along this direction.
    let v = Vec3::new(-0.3, 0.2, -0.5).normalize().0;
    let expected = [
        0.30732140695547666,
        -0.5278559106501309,
        -0.7917838659751962,
        0.0,
    ];
    assert_close(
        &Quat::from_two_vectors(z, v).to_array(),
        &expected,
        1e-15,
        "MuJoCo",
    );
}

#[test]
fn perpendiculars_are_perpendicular() {
    let mut random = Random::new(6);
    for _ in 0..ROUNDS {
        let v = random.unit_vector();
        let p = v.any_perpendicular();
        assert!(v.dot(p).abs() < 1e-15 && (p.norm() - 1.0).abs() < 1e-15);
    }
}

#[test]
fn rotation_vectors_round_trip() {
    let mut random = Random::new(7);
    for round in 0..ROUNDS {
        let size = [PI - 1e-9, 1.0, 1e-6, 1e-12][round % 4];
        let v = random.unit_vector() * random.between(0.0, size);
        let back = Quat::from_rotation_vector(v).to_rotation_vector();
        close_vector(back, v, 4e-15 * size.max(1e-3), "rotation vector");
        // The quaternion −q, of the same rotation, has the same rotation vector.
        let q = Quat::from_rotation_vector(v);
        let opposite = Quat::new(-q.w, -q.x, -q.y, -q.z);
        close_vector(opposite.to_rotation_vector(), v, 1e-14, "−q");
    }
    assert_eq!(Quat::<f64>::IDENTITY.to_rotation_vector(), Vec3::ZERO);
    assert_eq!(
        Quat::from_rotation_vector(Vec3::ZERO),
        Quat::<f64>::IDENTITY
    );
}

#[test]
fn the_difference_leads_from_one_rotation_to_the_other() {
    let mut random = Random::new(8);
    for _ in 0..ROUNDS {
        let (a, b) = (random.rotation(), random.rotation());
        close_rotation(
            b * Quat::from_rotation_vector(a.difference(b)),
            a,
            1e-14,
            "b exp(a − b)",
        );
        close_rotation(
            b.integrate(a.difference(b), 1.0),
            a,
            1e-14,
            "b integrated by a − b",
        );
    }
    // `mju_subQuat` of MuJoCo 4.0.0.
    let a = Quat::<f64>::from_f64([0.3, -0.5, 0.7, 0.4]).normalize();
    let b = Quat::<f64>::from_f64([-0.2, 0.6, 0.1, 0.75]).normalize();
    let expected = [1.2883624901049333, 1.4156081681399888, -2.465385011929194];
    assert_close(&a.difference(b).to_array(), &expected, 1e-14, "mju_subQuat");
}

#[test]
fn integration_rotates_at_the_given_velocity() {
    let mut random = Random::new(9);
    for _ in 0..ROUNDS {
        let (q, w) = (random.rotation(), random.vector(3.0));
        let (s, t) = (random.between(0.0, 0.5), random.between(0.0, 0.5));
        let once = q.integrate(w, s + t);
        close_rotation(
            q.integrate(w, s).integrate(w, t),
            once,
            1e-14,
            "constant velocity",
        );
        // The local rate: (q(t) − q)/t → ½ q w.
        let small = 1e-6;
        let rate = q.integrate(w, small).difference(q) * (1.0 / small);
        close_vector(rate, w, 1e-8, "rate");
        assert_eq!(
            q.integrate(Vec3::ZERO, 1.0).normalize(),
            q.integrate(w, 0.0).normalize()
        );
    }
    // `mju_quatIntegrate` of MuJoCo 4.0.0.
    let q = Quat::<f64>::from_f64([0.5, 0.1, -0.3, 0.8]).normalize();
    let expected = [
        0.31054423382078017,
        0.3828460234199156,
        -0.3208292272771415,
        0.8087396417370514,
    ];
    let got = q.integrate(Vec3::new(1.0, -2.0, 0.5), 0.3);
    assert_close(&got.to_array(), &expected, 1e-14, "mju_quatIntegrate");
}

#[test]
fn vectors_too_short_to_have_a_direction_get_a_default() {
    let x = Vec3::new(1.0, 0.0, 0.0);
    assert_eq!(Vec3::<f64>::ZERO.normalize(), (x, 0.0));
    assert_eq!(Vec3::new(0.0, 1e-16, 0.0).normalize().0, x);
    assert_eq!(
        Quat::new(0.0, 0.0, 0.0, 0.0).normalize(),
        Quat::<f64>::IDENTITY
    );
    // In lanes, only the affected lane gets the default.
    let mixed = Vec3::new(Lanes::ZERO, Lanes::<f64, 2>::from([0.0, 2.0]), Lanes::ZERO);
    let (unit, norm) = mixed.normalize();
    assert_eq!(norm.to_array(), [0.0, 2.0]);
    assert_eq!(
        (unit.x.to_array(), unit.y.to_array()),
        ([1.0, 0.0], [0.0, 1.0])
    );
}

#[test]
fn principal_axes_diagonalise() {
    let mut random = Random::new(10);
    for round in 0..ROUNDS {
        let scale = f64::powf(10.0, random.between(-12.0, 6.0));
        let mut diagonal = random.vector(0.5) + Vec3::new(0.6, 0.6, 0.6);
        if round % 3 == 0 {
            diagonal.y = diagonal.x;
        }
        let r = random.rotation().to_matrix();
        let inertia = r * Mat3::diagonal(diagonal * scale) * r.transpose();
        let (moments, frame) = principal_axes(&inertia);
        assert!(moments.x >= moments.y * (1.0 - 1e-11) && moments.y >= moments.z * (1.0 - 1e-11));
        let axes = frame.to_matrix();
        let back = axes * Mat3::diagonal(moments) * axes.transpose();
        close_matrix(back, inertia, 1e-14 * scale, "R diag Rᵀ");
        let mut sorted = diagonal.to_array();
        sorted.sort_by(|a, b| b.total_cmp(a));
        assert_close(
            &(moments * (1.0 / scale)).to_array(),
            &sorted,
            1e-14,
            "moments",
        );
    }
}

#[test]
fn rough_principal_axes_ignore_rounding() {
    for scale in [1e-9, 1.0, 1e9] {
        let axes = |entry: f64, third: f64| {
            let rows = [[3.0, 3.0 * entry, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, third]];
            let matrix = Mat3::from_f64(rows.map(|row| row.map(|x| x * scale)));
            rough_principal_axes(&matrix, 1e-7).1
        };
        assert_eq!(axes(0.99e-7, 1.0), Quat::IDENTITY, "an entry too small");
        assert_ne!(axes(1.01e-7, 1.0), Quat::IDENTITY, "an entry that counts");
        let above = |part: f64| 2.0 + 3.0 * part;
        assert_eq!(axes(0.0, above(0.99e-7)), Quat::IDENTITY, "equal moments");
        assert_ne!(axes(0.0, above(1.01e-7)), Quat::IDENTITY, "other moments");
    }
}

#[test]
fn principal_axes_of_simple_matrices() {
    assert_eq!(
        principal_axes(&Mat3::diagonal(Vec3::new(3.0, 2.0, 1.0))),
        (Vec3::new(3.0, 2.0, 1.0), Quat::IDENTITY)
    );
    assert_eq!(
        principal_axes(&Mat3::diagonal(Vec3::new(2.0, 2.0, 2.0))),
        (Vec3::new(2.0, 2.0, 2.0), Quat::IDENTITY)
    );
    assert_eq!(principal_axes(&Mat3::ZERO), (Vec3::ZERO, Quat::IDENTITY));
    // `mju_eig3` of MuJoCo 4.0.0.
    let m = Mat3::from_f64([[2.0, 0.3, -0.4], [0.3, 1.5, 0.2], [-0.4, 0.2, 3.0]]);
    let (moments, _) = principal_axes(&m);
    let expected = [3.1454695658332383, 2.0707013577348024, 1.2838290764319729];
    assert_close(&moments.to_array(), &expected, 1e-14, "mju_eig3");
    let (moments, frame) = principal_axes(&Mat3::diagonal(Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!(moments, Vec3::new(3.0, 2.0, 1.0));
    let half = 0.5f64.sqrt();
    assert_close(
        &frame.to_array(),
        &[0.0, half, 0.0, half],
        1e-15,
        "mju_eig3's frame",
    );
    // Non-finite input gives non-finite output, without an endless loop.
    let broken = Mat3::diagonal(Vec3::new(1.0, f64::NAN, 3.0));
    assert!(
        !principal_axes(&broken)
            .0
            .to_array()
            .iter()
            .all(|x| x.is_finite())
    );
}
