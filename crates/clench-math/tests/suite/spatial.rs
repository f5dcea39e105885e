//! Spatial algebra: duality, the Jacobi identity, and inertia under a change of reference point.

use crate::support::{Random, assert_close};
use clench_math::{Force, Inertia, Mat3, Motion, Vec3};

const ROUNDS: usize = 2000;

fn motion(random: &mut Random) -> Motion<f64> {
    Motion::new(random.vector(1.0), random.vector(1.0))
}
fn force(random: &mut Random) -> Force<f64> {
    Force::new(random.vector(1.0), random.vector(1.0))
}
/// Returns a body's inertia about points at `offset` (from the point to its centre of mass), its principal moments and
/// axes.
fn inertia(random: &mut Random, offset: Vec3<f64>) -> (Inertia<f64>, Vec3<f64>, Mat3<f64>) {
    let diagonal = random.vector(0.4) + Vec3::new(1.0, 1.0, 1.0);
    let axes = random.rotation().to_matrix();
    (
        Inertia::from_principal(diagonal, &axes, offset, 2.5),
        diagonal,
        axes,
    )
}

#[test]
fn crossing_forces_is_dual_to_crossing_motions() {
    let mut random = Random::new(1);
    for _ in 0..ROUNDS {
        let (v, m, f) = (motion(&mut random), motion(&mut random), force(&mut random));
        let (left, right) = (m.dot(v.cross_force(f)), -v.cross(m).dot(f));
        assert!((left - right).abs() < 1e-14, "{left} {right}");
    }
}

#[test]
fn crossing_is_antisymmetric_and_satisfies_jacobi() {
    let mut random = Random::new(2);
    for _ in 0..ROUNDS {
        let (a, b, c) = (
            motion(&mut random),
            motion(&mut random),
            motion(&mut random),
        );
        assert_close(
            &a.cross(b).to_array(),
            &(-b.cross(a)).to_array(),
            1e-15,
            "a × b = −b × a",
        );
        let cyclic = a.cross(b.cross(c)) + b.cross(c.cross(a)) + c.cross(a.cross(b));
        assert_close(&cyclic.to_array(), &[0.0; 6], 1e-14, "Jacobi");
    }
}

/// A motion field at another point and a force moved there do the same work.
#[test]
fn power_does_not_depend_on_the_reference_point() {
    let mut random = Random::new(3);
    for _ in 0..ROUNDS {
        let (m, f, shift) = (motion(&mut random), force(&mut random), random.vector(2.0));
        let moved_motion = Motion::new(m.angular, m.velocity_at(shift));
        let moved_force = Force::new(f.angular - shift.cross(f.linear), f.linear);
        assert!((m.dot(f) - moved_motion.dot(moved_force)).abs() < 1e-14);
    }
}

#[test]
fn inertia_is_symmetric_and_positive() {
    let mut random = Random::new(4);
    for _ in 0..ROUNDS {
        let offset = random.vector(1.0);
        let (body, ..) = inertia(&mut random, offset);
        let (a, b) = (motion(&mut random), motion(&mut random));
        assert!((a.dot(body * b) - b.dot(body * a)).abs() < 1e-13);
        assert!(a.dot(body * a) > 0.0);
    }
}

/// Kinetic energy and momentum are those of the body, for any reference point.
#[test]
fn inertia_moves_with_its_reference_point() {
    let mut random = Random::new(5);
    for _ in 0..ROUNDS {
        let (offset, shift) = (random.vector(1.0), random.vector(1.0));
        let (here, diagonal, axes) = inertia(&mut random, offset);
        let there = Inertia::from_principal(diagonal, &axes, offset - shift, here.mass);
        let v = motion(&mut random);
        let v_there = Motion::new(v.angular, v.velocity_at(shift));
        let (momentum, momentum_there) = (here * v, there * v_there);
        let moved = Force::new(
            momentum.angular - shift.cross(momentum.linear),
            momentum.linear,
        );
        assert_close(
            &momentum_there.to_array(),
            &moved.to_array(),
            1e-13,
            "momentum",
        );

        // Computed directly: mass at the centre of mass, and rotation about it.
        let centre_velocity = v.velocity_at(offset);
        let local = axes.transpose_mul(v.angular);
        let energy = 0.5 * here.mass * centre_velocity.norm_squared()
            + 0.5 * local.scale_by(diagonal).dot(local);
        assert!((0.5 * v.dot(momentum) - energy).abs() < 1e-13);
    }
}

#[test]
fn inertias_about_one_point_add() {
    let mut random = Random::new(6);
    for _ in 0..ROUNDS {
        let (offset_a, offset_b) = (random.vector(1.0), random.vector(1.0));
        let (a, ..) = inertia(&mut random, offset_a);
        let (b, ..) = inertia(&mut random, offset_b);
        let mut both = a;
        both += b;
        let v = motion(&mut random);
        assert_close(
            &(both * v).to_array(),
            &(a * v + b * v).to_array(),
            1e-13,
            "a + b",
        );
        let mut nothing = Inertia::ZERO;
        nothing += a;
        assert_eq!(nothing, a);
    }
}
