//! Principal axes of a symmetric 3 × 3 matrix, for model builders.
//!
//! Jacobi's method: while an off-diagonal entry d_ij is not negligible, rotate the frame about the third axis k by the
//! angle that zeroes it, tan 2φ = 2 d_ij / (d_ii − d_jj). Each rotation removes 2 d_ij² from the off-diagonal sum of
//! squares, and near the end that sum is squared at every sweep. The frame is stored as a quaternion, so it stays a
//! rotation.
//!
//! If moments are nearly equal, the stopping rule determines the axes between them. Models are compared by their
//! frames, so the rule is MuJoCo's.

use crate::{Mat3, Quat, Vec3};

/// Off-diagonal entries below this fraction of the largest entry count as zero, as in MuJoCo: the rounding error of the
/// rotated matrix.
const NEGLIGIBLE: f64 = 4e-15;
/// Moments closer than this fraction of the largest entry are equal, and keep their order, as in MuJoCo.
const EQUAL: f64 = 1e-12;
/// The maximum number of rotations. Jacobi's method needs about ten; this limits it on input that is not finite.
const MAX_ROTATIONS: usize = 60;

/// Computes the principal moments of a rotational inertia, largest first, and the rotation of its principal frame. The
/// columns of the rotation's matrix are the axes, so `inertia = R diag R^T` (MuJoCo's `mju_eig3`).
///
/// Only the upper triangle is read. Input that is not finite gives a result that is not finite.
pub fn principal_axes(inertia: &Mat3<f64>) -> (Vec3<f64>, Quat<f64>) {
    diagonalize(inertia, NEGLIGIBLE, EQUAL)
}

/// Computes [`principal_axes`] of an inertia with a relative `uncertainty` of its largest entry, such as that of
/// vertices with few digits. Off-diagonal entries below it count as zero, and moments closer than it as equal, so the
/// axes stay unchanged unless the inertia requires others.
pub fn rough_principal_axes(inertia: &Mat3<f64>, uncertainty: f64) -> (Vec3<f64>, Quat<f64>) {
    diagonalize(inertia, uncertainty, uncertainty)
}

fn diagonalize(inertia: &Mat3<f64>, negligible: f64, equal: f64) -> (Vec3<f64>, Quat<f64>) {
    let [a, b, c] = inertia.rows;
    let matrix = Mat3::from_rows(a, Vec3::new(a.y, b.y, b.z), Vec3::new(a.z, b.z, c.z));
    let scale = largest_entry(&matrix);
    let mut frame = Quat::IDENTITY;
    let mut rotated = matrix;
    for _ in 0..MAX_ROTATIONS {
        let Some(rotation) = jacobi_rotation(&rotated, negligible * scale) else {
            break;
        };
        frame = (frame * rotation).normalize();
        let axes = frame.to_matrix();
        rotated = axes.transpose() * matrix * axes;
    }
    sort_descending(
        Vec3::new(rotated.rows[0].x, rotated.rows[1].y, rotated.rows[2].z),
        frame,
        equal * scale,
    )
}

fn largest_entry(m: &Mat3<f64>) -> f64 {
    m.rows
        .iter()
        .flat_map(|row| row.to_array())
        .fold(0.0, |largest, entry| f64::max(largest, entry.abs()))
}

/// Returns the rotation that zeroes the largest off-diagonal entry, `None` if that is negligible.
fn jacobi_rotation(d: &Mat3<f64>, negligible: f64) -> Option<Quat<f64>> {
    let pairs = [(1, 2), (2, 0), (0, 1)];
    let size = |k: usize| d.rows[pairs[k].0][pairs[k].1].abs();
    let k = (0..3).fold(0, |best, k| if size(k) > size(best) { k } else { best });
    if size(k) <= negligible {
        return None;
    }
    let (i, j) = pairs[k];
    // The smaller of the two angles, so that the method converges: |φ| ≤ π/4.
    let difference = d.rows[i][i] - d.rows[j][j];
    let opposite = 2.0 * d.rows[i][j];
    let side = match difference != 0.0 {
        true => opposite * difference,
        // Both quarter turns are valid; MuJoCo's choice determines which axis comes first.
        false if k == 1 => 1.0,
        false => -1.0,
    };
    let angle = 0.5 * f64::atan2(opposite.copysign(side), difference.abs());
    let mut axis = Vec3::ZERO;
    axis[k] = 1.0;
    Some(Quat::from_axis_angle(axis, angle))
}

/// Swaps neighbours by quarter turns of the frame until the moments descend.
fn sort_descending(
    mut moments: Vec3<f64>,
    mut frame: Quat<f64>,
    equal: f64,
) -> (Vec3<f64>, Quat<f64>) {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let about_z = Quat::new(half, 0.0, 0.0, half);
    let about_x = Quat::new(half, half, 0.0, 0.0);
    for (i, quarter_turn) in [(0, about_z), (1, about_x), (0, about_z)] {
        if moments[i] + equal < moments[i + 1] {
            let larger = moments[i + 1];
            moments[i + 1] = moments[i];
            moments[i] = larger;
            frame = (frame * quarter_turn).normalize();
        }
    }
    (moments, frame)
}
