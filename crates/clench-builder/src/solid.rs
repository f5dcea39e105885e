//! Volume, centre of mass and inertia of a triangulated solid, computed as in MuJoCo.
//!
//! Each triangle is the base of a pyramid with a common apex, whose volume has the sign of the side on which the apex
//! is. Over a closed surface the sum does not depend on the apex. A pyramid's centre of mass is at 3/4 of the line to
//! the centroid of its base, and ∫ x xᵀ dV over a pyramid D, E, F with its apex at the origin is V/20 (Σ_i 2 p_i p_iᵀ +
//! Σ_{i≠j} p_i p_jᵀ); over only the triangle, it is its area over 12 times the same. MuJoCo uses the 3/4 for a shell
//! too.

use super::MeshInertia;
use clench_math::{Mat3, Vec3};

/// Triangles, and their mass distribution.
pub(super) struct Solid<'a> {
    pub vertices: &'a [Vec3<f64>],
    pub triangles: &'a [[u32; 3]],
    pub spread: MeshInertia,
}

/// A triangle's area, unit normal and centroid.
struct Triangle {
    area: f64,
    normal: Vec3<f64>,
    center: Vec3<f64>,
}

/// Twice the area (m²) below which a triangle is ignored (MuJoCo's `mjMINVAL`).
const NO_AREA: f64 = 1e-15;

impl Triangle {
    fn of([a, b, c]: [Vec3<f64>; 3]) -> Self {
        let (normal, twice) = (b - a).cross(c - a).normalize();
        Triangle {
            area: if twice < NO_AREA { 0.0 } else { 0.5 * twice },
            normal,
            center: (a + b + c) * (1.0 / 3.0),
        }
    }
}

impl Solid<'_> {
    fn corners(&self) -> impl Iterator<Item = [Vec3<f64>; 3]> {
        let at = |c: u32| self.vertices[c as usize];
        self.triangles.iter().map(move |corners| corners.map(at))
    }

    /// Returns the weight of a triangle, seen from an apex: volume of its pyramid, or area.
    fn weight(&self, triangle: &Triangle, apex: Vec3<f64>) -> f64 {
        let volume = (triangle.center - apex).dot(triangle.normal) * triangle.area / 3.0;
        match self.spread {
            MeshInertia::Shell => triangle.area,
            MeshInertia::Legacy => volume.abs(),
            MeshInertia::Convex | MeshInertia::Exact => volume,
        }
    }

    /// Returns the centroid of the surface, and its area.
    pub(super) fn surface(&self) -> (Vec3<f64>, f64) {
        let mut sum = Vec3::ZERO;
        let mut total = 0.0;
        for triangle in self.corners().map(Triangle::of) {
            sum += triangle.center * triangle.area;
            total += triangle.area;
        }
        (sum * (1.0 / total), total)
    }

    /// Returns the centre of mass, and the volume (area of a shell), by pyramids with this apex.
    pub(super) fn center(&self, apex: Vec3<f64>) -> (Vec3<f64>, f64) {
        let mut sum = Vec3::ZERO;
        let mut total = 0.0;
        for triangle in self.corners().map(Triangle::of) {
            let weight = self.weight(&triangle, apex);
            sum += (triangle.center * 0.75 + apex * 0.25) * weight;
            total += weight;
        }
        (sum * (1.0 / total), total)
    }

    /// Returns the inertia at unit density about a point, m⁵ (m⁴ for a shell), and the volume (area), by pyramids with
    /// their apex there.
    pub(super) fn inertia(&self, about: Vec3<f64>) -> (Mat3<f64>, f64) {
        let share = match self.spread {
            MeshInertia::Shell => 1.0 / 12.0,
            MeshInertia::Convex | MeshInertia::Exact | MeshInertia::Legacy => 1.0 / 20.0,
        };
        // The moments xx, yy, zz, xy, xz, yz.
        let mut moments = [0.0; 6];
        let mut total = 0.0;
        for corners in self.corners() {
            let corners = corners.map(|corner| corner - about);
            let weight = self.weight(&Triangle::of(corners), Vec3::ZERO);
            total += weight;
            let sum = corners[0] + corners[1] + corners[2];
            for (moment, (i, j)) in moments.iter_mut().zip(PAIRS) {
                let own: f64 = corners.iter().map(|p| p[i] * p[j]).sum();
                *moment += weight * share * (own + sum[i] * sum[j]);
            }
        }
        let [xx, yy, zz, xy, xz, yz] = moments;
        let inertia = Mat3::from_f64([
            [yy + zz, -xy, -xz],
            [-xy, xx + zz, -yz],
            [-xz, -yz, xx + yy],
        ]);
        (inertia, total)
    }
}

const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
