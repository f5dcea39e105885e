//! Bodies of sizes from 10⁻⁹ to 10⁹ m obey Euler's equations, to the precision of their inertias.

use clench_math::{Quat, Vec3};
use clench_rigid::Sim;
use clench_rigid::builder::{BodySpec, GeomMass, GeomSpec, JointSpec, ModelBuilder};
use std::sync::Arc;

const G: f64 = 9.81;

/// Random numbers in [−1, 1) (Knuth's linear congruential generator).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = (self.0.wrapping_mul(6_364_136_223_846_793_005))
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn vector(&mut self) -> Vec3<f64> {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

/// Returns the acceleration of a free box without contacts, of 1 kg or water's density; `spin` is in its own frame.
/// Returns an error if the inertia is too small to divide by.
fn acceleration(
    half: Vec3<f64>,
    one_kg: bool,
    turn: Quat<f64>,
    spin: Vec3<f64>,
) -> Result<Vec<f64>, String> {
    let mut builder = ModelBuilder::new("box");
    let mut shape = GeomSpec::cuboid(half.to_array());
    if one_kg {
        shape.mass = GeomMass::Mass(1.0);
    }
    builder.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("box")
            .joint(JointSpec::free("free"))
            .geom(shape),
    );
    let mut sim: Sim =
        Sim::new(Arc::new(builder.build().map_err(|e| e.to_string())?)).expect("valid");
    sim.state.qpos[3..7].copy_from_slice(&[turn.w, turn.x, turn.y, turn.z]);
    sim.state.qvel[3..6].copy_from_slice(&spin.to_array());
    sim.forward().map_err(|e| e.to_string())?;
    Ok(sim.workspace().qacc.clone())
}

/// Computes the acceleration by Euler: I dω/dt = Iω × ω, with moments of inertia m (b² + c²) / 3.
fn euler(half: Vec3<f64>, w: Vec3<f64>) -> Vec3<f64> {
    let [a, b, c] = half.to_array();
    let about = |b: f64, c: f64| (c - b) * (c + b) / (b * b + c * c);
    Vec3::new(
        about(b, c) * w.y * w.z,
        about(c, a) * w.z * w.x,
        about(a, b) * w.x * w.y,
    )
}

#[test]
fn a_cube_of_any_size_only_falls() {
    let mut numbers = Numbers(3);
    let mut moved = 0;
    for exponent in -9..=9 {
        for one_kg in [false, true] {
            let half = Vec3::new(1.0, 1.0, 1.0) * 10f64.powi(exponent);
            let turn = Quat::from_rotation_vector(numbers.vector() * 3.0);
            let Ok(found) = acceleration(half, one_kg, turn, numbers.vector()) else {
                // Below the mass of a molecule, the inertia is too small to divide by.
                assert!(exponent < -2, "a cube of 1e{exponent} m");
                continue;
            };
            moved += 1;
            for (k, x) in found.iter().enumerate() {
                let expected = if k == 2 { -G } else { 0.0 };
                assert!((x - expected).abs() < 1e-13, "1e{exponent} m: {found:?}");
            }
        }
    }
    assert!(moved >= 24, "{moved}");
}

#[test]
fn a_box_of_any_shape_tumbles_by_eulers_equations() {
    let mut numbers = Numbers(5);
    let mut moved = 0;
    for _ in 0..2000 {
        let size = 9.0 * numbers.next();
        // Shapes range from cubes to needles and sheets.
        let spread = 8.0 * numbers.next();
        let half = Vec3::from_array(
            numbers
                .vector()
                .to_array()
                .map(|x| 10f64.powf((size + spread * x).clamp(-9.0, 9.0))),
        );
        let turn = Quat::from_rotation_vector(numbers.vector() * 3.0);
        let spin = numbers.vector();
        let Ok(found) = acceleration(half, numbers.next() > 0.0, turn, spin) else {
            continue;
        };
        moved += 1;
        let [a, b, c] = half.to_array();
        let inertias = [b.hypot(c).powi(2), c.hypot(a).powi(2), a.hypot(b).powi(2)];
        // Iω × ω loses precision by the ratio of the largest to the smallest moment of inertia.
        let ratio = inertias.iter().fold(0.0, |most: f64, x| most.max(*x))
            / inertias
                .iter()
                .fold(f64::INFINITY, |least, x| least.min(*x));
        let expected = euler(half, spin);
        let error = (Vec3::new(found[3], found[4], found[5]) - expected).norm();
        assert!(
            error <= 16.0 * f64::EPSILON * ratio,
            "{half:?}, moments of inertia 1 to {ratio}: {error}"
        );
        let fall = (Vec3::new(found[0], found[1], found[2] + G)).norm();
        assert!(fall < 1e-12, "{half:?}: {fall}");
    }
    assert!(moved >= 800, "{moved}");
}
