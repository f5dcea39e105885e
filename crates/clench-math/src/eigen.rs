//! Principal axes of a symmetric 3 × 3 matrix, for model builders.
//!
//! Jacobi's method: while an off-diagonal entry d_ij is worth it, turn the frame about the third axis k by the angle
//! that zeroes it, tan 2φ = 2 d_ij / (d_ii − d_jj). Each turn removes 2 d_ij² from the off-diagonal sum of squares, and near the
//! end that sum is squared at every sweep. The frame is kept as a quaternion, so it stays a rotation.
//!
//! Where moments are nearly equal, the rule of stopping decides on the axes between them. Models are compared by their frames,
//! so the rule is MuJoCo's.

use crate::{Mat3, Quat, Vec3};

/// Off-diagonal entries below this part of the largest entry count as zero, as in MuJoCo: the size of the turned matrix's
/// rounding.
const NEGLIGIBLE: f64 = 4e-15;
/// Moments closer than this part of the largest are equal, and keep their order, as in MuJoCo.
const EQUAL: f64 = 1e-12;
/// Jacobi's method needs some ten turns; this bounds it on input that is not finite.
const MAX_TURNS: usize = 60;

/// The principal moments of a rotational inertia, largest first, and the rotation of its principal frame: columns
/// of the rotation's matrix are the axes, so `inertia = R diag R^T` (MuJoCo's `mju_eig3`).
///
/// Only the upper triangle is read. Input that is not finite gives a result that is not finite.
pub fn principal_axes(inertia: &Mat3<f64>) -> (Vec3<f64>, Quat<f64>) {
    diagonalize(inertia, NEGLIGIBLE, EQUAL)
}

/// As [`principal_axes`], of an inertia that is known no better than to a part `uncertainty` of its largest entry, such as that
/// of vertices with few digits: off-diagonal entries below it count as zero, moments closer than it as equal. So axes stay as
/// they are where nothing asks for others.
pub fn rough_principal_axes(inertia: &Mat3<f64>, uncertainty: f64) -> (Vec3<f64>, Quat<f64>) {
    diagonalize(inertia, uncertainty, uncertainty)
}

fn diagonalize(inertia: &Mat3<f64>, negligible: f64, equal: f64) -> (Vec3<f64>, Quat<f64>) {
    let [a, b, c] = inertia.rows;
    let matrix = Mat3::from_rows(a, Vec3::new(a.y, b.y, b.z), Vec3::new(a.z, b.z, c.z));
    let scale = largest_entry(&matrix);
    let mut frame = Quat::IDENTITY;
    let mut turned = matrix;
    for _ in 0..MAX_TURNS {
        let Some(turn) = jacobi_turn(&turned, negligible * scale) else {
            break;
        };
        frame = (frame * turn).normalize();
        let axes = frame.to_matrix();
        turned = axes.transpose() * matrix * axes;
    }
    sort_descending(
        Vec3::new(turned.rows[0].x, turned.rows[1].y, turned.rows[2].z),
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

/// The turn that zeroes the largest off-diagonal entry, `None` where that is negligible.
fn jacobi_turn(d: &Mat3<f64>, negligible: f64) -> Option<Quat<f64>> {
    let pairs = [(1, 2), (2, 0), (0, 1)];
    let size = |k: usize| d.rows[pairs[k].0][pairs[k].1].abs();
    let k = (0..3).fold(0, |best, k| if size(k) > size(best) { k } else { best });
    if size(k) <= negligible {
        return None;
    }
    let (i, j) = pairs[k];
    // The smaller of the two angles, so that the turns die out: |φ| ≤ π/4.
    let difference = d.rows[i][i] - d.rows[j][j];
    let opposite = 2.0 * d.rows[i][j];
    let side = match difference != 0.0 {
        true => opposite * difference,
        // Both quarter turns serve; MuJoCo's choice decides which axis comes first.
        false if k == 1 => 1.0,
        false => -1.0,
    };
    let angle = 0.5 * f64::atan2(opposite.copysign(side), difference.abs());
    let mut axis = Vec3::ZERO;
    axis[k] = 1.0;
    Some(Quat::from_axis_angle(axis, angle))
}

/// Swaps neighbours by quarter turns of the frame until the moments fall.
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
