//! Vectors, rotations and spatial vectors in lanes equal, to the bit, those of each environment alone.

use crate::support::{EqualsAlone, Formula, Random, TestScalar, in_instruction_sets};
use clench_math::{Force, Inertia, Mat3, Motion, Quat, Real, Vec3};

#[derive(Clone, Copy)]
struct Vectors;
impl Formula for Vectors {
    const ARGUMENTS: usize = 6;
    #[inline(always)]
    fn evaluate<T: Real>(self, arguments: &[T]) -> Vec<(&'static str, T)> {
        let (a, b) = (
            Vec3::from_slice(arguments),
            Vec3::from_slice(&arguments[3..]),
        );
        let (unit, length) = a.normalize();
        let mut sum = a;
        sum += b;
        sum -= a.scale_by(b);
        let matrix = Mat3::from_columns(a, b, a.cross(b));
        let product = matrix * Mat3::diagonal(b) * matrix.transpose();
        let other = Mat3::select(a.x.lt(b.x), Mat3::IDENTITY, product);
        let mut all = vec![
            ("dot", a.dot(b)),
            ("norm", b.norm()),
            ("length", length),
            ("determinant", product.determinant()),
        ];
        for (name, vector) in [
            ("normalize", unit),
            ("perpendicular", unit.any_perpendicular()),
            ("sum", sum),
            ("select", Vec3::select(a.y.gt(b.y), a * b.x, -b)),
            ("M v", product * a),
            ("Mᵀ v", matrix.transpose_mul(a)),
            ("M N", (product * other).rows[1]),
            ("column", other.column(2)),
        ] {
            all.extend(vector.to_array().map(|x| (name, x)));
        }
        all
    }
}

#[derive(Clone, Copy)]
struct Rotations;
impl Formula for Rotations {
    const ARGUMENTS: usize = 8;
    #[inline(always)]
    fn evaluate<T: Real>(self, arguments: &[T]) -> Vec<(&'static str, T)> {
        let p = Quat::from_slice(arguments).normalize();
        let q = Quat::from_slice(&arguments[4..]).normalize();
        let (v, w) = (p.imaginary().normalize().0, q.imaginary().normalize().0);
        let mut all = Vec::new();
        for (name, q) in [
            ("normalize", p),
            ("multiply", p * q.conjugate()),
            ("of an axis", Quat::from_axis_angle(v, arguments[4])),
            ("of a vector", Quat::from_rotation_vector(v * arguments[5])),
            ("of a matrix", Quat::from_matrix(&q.to_matrix())),
            ("between vectors", Quat::from_two_vectors(v, w)),
            ("between opposites", Quat::from_two_vectors(v, -v)),
            ("integrate", q.integrate(v, arguments[6])),
            ("select", Quat::select(p.w.lt(q.w), p, q)),
        ] {
            all.extend(q.to_array().map(|x| (name, x)));
        }
        for (name, vector) in [
            ("rotate", q.rotate(v)),
            ("rotation vector", q.to_rotation_vector()),
            ("difference", p.difference(q)),
        ] {
            all.extend(vector.to_array().map(|x| (name, x)));
        }
        all
    }
}

#[derive(Clone, Copy)]
struct SpatialVectors;
impl Formula for SpatialVectors {
    const ARGUMENTS: usize = 16;
    #[inline(always)]
    fn evaluate<T: Real>(self, arguments: &[T]) -> Vec<(&'static str, T)> {
        let vector = |i: usize| Vec3::from_slice(&arguments[3 * i..]);
        let m = Motion::new(vector(0), vector(1));
        let mut f = Force::new(vector(2), vector(3));
        let axes = Quat::from_slice(&arguments[12..]).normalize().to_matrix();
        let mut body = Inertia::from_principal(vector(4), &axes, vector(3), arguments[0]);
        body += Inertia::from_principal(vector(0), &axes, vector(1), arguments[1]);
        let momentum = body * m;
        f += momentum * arguments[5];
        f -= m.cross_force(momentum);
        let mut all = vec![("power", m.dot(f))];
        let turned = m.cross(Motion::new(vector(2), vector(0)));
        for (name, six) in [
            ("momentum", momentum.to_array()),
            ("force", f.to_array()),
            ("motion", (turned - -m).to_array()),
            ("inertia", body.rotational),
        ] {
            all.extend(six.map(|x| (name, x)));
        }
        let velocity = m.velocity_at(body.rotate(vector(2)));
        all.extend(velocity.to_array().map(|x| ("velocity", x)));
        all
    }
}

fn lanes_equal_scalars<S: TestScalar>(formula: impl Formula) {
    let check = |draw: &dyn Fn(&mut Random) -> S| {
        in_instruction_sets(EqualsAlone {
            formula,
            rounds: 1000,
            draw,
        });
    };
    check(&|random| S::new(random.between(-2.0, 2.0)));
    // Zeros, equal coordinates and vectors too short to have a direction, for which lanes take different branches.
    check(&|random| {
        let size = [1.0, 1.0, 0.0, 1e-16][(random.bits() % 4) as usize];
        S::new(random.between(-2.0, 2.0).floor() * size)
    });
    // Some environments hold arbitrary numbers.
    check(&|random| match random.bits() % 16 {
        0 => random.any(),
        _ => S::new(random.between(-2.0, 2.0)),
    });
}

macro_rules! tests {
    ($($test:ident: $formula:ident;)*) => {$(
        #[test]
        fn $test() {
            lanes_equal_scalars::<f64>($formula);
            lanes_equal_scalars::<f32>($formula);
        }
    )*};
}
tests! {
    vectors_and_matrices: Vectors;
    rotations: Rotations;
    spatial_vectors: SpatialVectors;
}
