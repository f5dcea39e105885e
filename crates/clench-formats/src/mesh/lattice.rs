//! Builtin meshes that are convex hulls of points of a lattice: `grid`, `box`, `cylinder` and `ellipsoid`.
//! MuJoCo also makes tetrahedra between the points, for flexes; a geom has only the hull.

use super::bytes;
use super::triangles::Triangles;
use crate::spending::Spending;
use clench_math::Vec3;

/// The shapes of a lattice.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// All points of a block.
    Grid,
    /// The surface of a block, and its centre.
    Box,
    /// A box, whose cross-sections become ellipses.
    Cylinder,
    /// A box, whose points move along rays from the centre.
    Ellipsoid,
}

/// The maximum number of points along an axis.
const MAX_COUNT: usize = 1000;

/// Makes the mesh of a name, or returns `None` if the name is not one of a lattice.
///
/// # Errors
/// Returns an error if the parameters are invalid, or those of a surface, or if there are too many points.
pub(super) fn make(
    name: &str,
    parameters: &[f64],
    spending: &mut Spending,
) -> Option<Result<Triangles, String>> {
    let kind = match name {
        "grid" => Kind::Grid,
        "box" => Kind::Box,
        "cylinder" => Kind::Cylinder,
        "ellipsoid" => Kind::Ellipsoid,
        "square" | "disc" => return Some(Err(surface(name))),
        _ => return None,
    };
    Some(of_kind(kind, name, parameters, spending))
}

/// Returns the message about a mesh without volume.
fn surface(name: &str) -> String {
    format!("a builtin {name} of two dimensions is for flexes, which are not supported")
}

fn of_kind(
    kind: Kind,
    name: &str,
    parameters: &[f64],
    spending: &mut Spending,
) -> Result<Triangles, String> {
    let (counts, spacing) = match *parameters {
        [a, b, c, x, y, z] => ([a, b, c], [x, y, z]),
        [a, b, c, x, y, z, dim] if dim.trunc() == 3.0 => ([a, b, c], [x, y, z]),
        [.., dim] if parameters.len() == 7 && dim.trunc() == 2.0 => return Err(surface(name)),
        _ => return Err(format!("a {name} cannot have the params {parameters:?}")),
    };
    if let Some(bad) = counts.iter().find(|count| !in_range(count.trunc())) {
        return Err(format!(
            "a count of params is {bad}, but a {name} needs 2 to {MAX_COUNT}"
        ));
    }
    let counts = counts.map(|count| count as usize);
    let [a, b, c] = counts;
    let points = match kind {
        Kind::Grid => a.saturating_mul(b).saturating_mul(c),
        Kind::Box | Kind::Cylinder | Kind::Ellipsoid => 2 * (a * b + b * c + c * a),
    };
    spending.bytes(bytes(points, 2 * points))?;
    Ok(Triangles {
        vertices: vertices(kind, counts, spacing),
        ..Triangles::default()
    })
}

fn in_range(count: f64) -> bool {
    (2.0..=MAX_COUNT as f64).contains(&count)
}

/// Returns the points in MuJoCo's order, in single precision.
fn vertices(kind: Kind, counts: [usize; 3], spacing: [f64; 3]) -> Vec<Vec3<f64>> {
    let place = |index: [usize; 3]| {
        let unit = std::array::from_fn(|i| 2.0 * index[i] as f64 / (counts[i] - 1) as f64 - 1.0);
        let unit = projected(kind, unit);
        let half = |i: usize| 0.5 * spacing[i] * (counts[i] - 1) as f64;
        Vec3::from_array(std::array::from_fn(|i| {
            f64::from((unit[i] * half(i)) as f32)
        }))
    };
    let [a, b, c] = counts;
    let mut found = Vec::new();
    match kind {
        Kind::Grid => {
            let all = (0..a).flat_map(|i| (0..b).flat_map(move |j| (0..c).map(move |k| [i, j, k])));
            found.extend(all.map(place));
        }
        Kind::Box | Kind::Cylinder | Kind::Ellipsoid => {
            found.push(Vec3::ZERO);
            for k in [0, c - 1] {
                let ends = (0..a).flat_map(|i| (0..b).map(move |j| [i, j, k]));
                found.extend(ends.map(place));
            }
            for j in [0, b - 1] {
                let sides = (0..a).flat_map(|i| (1..c - 1).map(move |k| [i, j, k]));
                found.extend(sides.map(place));
            }
            for i in [0, a - 1] {
                let sides = (1..b - 1).flat_map(|j| (1..c - 1).map(move |k| [i, j, k]));
                found.extend(sides.map(place));
            }
        }
    }
    found
}

/// Moves a point of the cube from −1 to 1 to its place in a shape.
fn projected(kind: Kind, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let onto = |reach: f64, length: f64| if length > 0.0 { reach / length } else { 0.0 };
    match kind {
        Kind::Grid | Kind::Box => [x, y, z],
        Kind::Cylinder => {
            let factor = onto(x.abs().max(y.abs()), x.hypot(y));
            [factor * x, factor * y, z]
        }
        Kind::Ellipsoid => {
            let factor = onto(1.0, Vec3::new(x, y, z).norm());
            [factor * x, factor * y, factor * z]
        }
    }
}
