//! Meshes defined by name and parameters, MJCF's `builtin`: points and triangles as MuJoCo makes them, with 24 bits per
//! coordinate.

use super::triangles::Triangles;
use super::{bytes, lattice};
use crate::spending::Spending;
use clench_math::Vec3;
use std::collections::HashMap;
use std::f64::consts::PI;

/// The maximum resolution.
const MAX_RESOLUTION: usize = 1000;

/// Makes the mesh of a name.
///
/// # Errors
/// Returns an error if the name, the number of parameters or a parameter is invalid.
pub(crate) fn make(
    name: &str,
    parameters: &[f64],
    spending: &mut Spending,
) -> Result<Triangles, String> {
    if let Some(found) = lattice::make(name, parameters, spending) {
        return found;
    }
    // An upper bound for any of them: a grid of the resolutions.
    let resolution = |k: usize| {
        let requested = parameters.get(k).map_or(0, |&number| number as usize);
        requested.min(MAX_RESOLUTION)
    };
    let vertices = match name {
        "supersphere" | "supertorus" => resolution(0).pow(2),
        "wedge" | "plate" => resolution(0) * resolution(1),
        _ => 0,
    };
    spending.bytes(bytes(vertices, 2 * vertices))?;
    let whole = |what: &str, number: f64, min: usize, max: usize| {
        // As in MuJoCo, the fractional part is ignored.
        let integer = number.trunc();
        match integer >= min as f64 && integer <= max as f64 {
            true => Ok(integer as usize),
            false => Err(format!(
                "the {what} of params is {number}, but a {name} needs {min} to {max}"
            )),
        }
    };
    let count = |number: f64, min: usize, max: usize| whole("first", number, min, max);
    let grid = |rows: f64, columns: f64| {
        let columns = || whole("second", columns, 1, MAX_RESOLUTION);
        Ok::<_, String>([count(rows, 1, MAX_RESOLUTION)?, columns()?])
    };
    match (name, parameters) {
        ("sphere", &[subdivisions]) => Ok(sphere(count(subdivisions, 0, 4)?)),
        ("hemisphere", &[resolution]) => Ok(hemisphere(count(resolution, 0, 10)?)),
        ("cone", &[corners, radius]) if (0.0..=1.0).contains(&radius) => {
            Ok(cone(count(corners, 3, MAX_RESOLUTION)?, radius))
        }
        ("supersphere", &[resolution, e, n]) if e >= 0.0 && n >= 0.0 => {
            Ok(supersphere(count(resolution, 3, MAX_RESOLUTION)?, e, n))
        }
        ("supertorus", &[resolution, radius, s, t])
            if radius > 0.0 && radius <= 1.0 && s > 0.0 && t > 0.0 =>
        {
            Ok(supertorus(
                count(resolution, 3, MAX_RESOLUTION)?,
                radius,
                s,
                t,
            ))
        }
        ("wedge", &[rows, columns, width, height, fovea])
            if width > 0.0
                && width <= 180.0
                && height > 0.0
                && height <= 90.0
                && (0.0..=1.0).contains(&fovea) =>
        {
            Ok(wedge(grid(rows, columns)?, [width, height], fovea))
        }
        ("plate", &[rows, columns]) => Ok(plate(grid(rows, columns)?)),
        (
            "sphere" | "hemisphere" | "cone" | "supersphere" | "supertorus" | "wedge" | "plate",
            _,
        ) => Err(format!("a {name} cannot have the params {parameters:?}")),
        _ => Err(format!("there is no builtin {name}")),
    }
}

/// Creates a point or tangent, rounded to single precision.
fn point(x: f64, y: f64, z: f64) -> Vec3<f64> {
    Vec3::from_array([x, y, z].map(|coordinate| f64::from(coordinate as f32)))
}

/// The triangles of the icosahedron.
const ICOSAHEDRON: [[u32; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];

/// Returns the corners of an icosahedron: three rectangles with sides 2 and 2 φ, φ the golden ratio, each in a plane of
/// two axes.
fn icosahedron(golden: f32) -> Vec<[f32; 3]> {
    let corners = [
        (golden, -1.0),
        (golden, 1.0),
        (-golden, -1.0),
        (-golden, 1.0),
    ];
    [
        corners.map(|(long, short)| [short, long, 0.0]),
        corners.map(|(long, short)| [0.0, short, long]),
        corners.map(|(long, short)| [long, 0.0, short]),
    ]
    .concat()
}

/// Makes an icosphere: repeatedly cuts each triangle into four, with the new corners on the unit sphere.
fn sphere(subdivisions: usize) -> Triangles {
    let golden = (0.5 * (1.0 + 5f64.sqrt())) as f32;
    let norm = (1.0 + f64::from(golden * golden)).sqrt();
    let mut vertices = icosahedron(golden);
    for coordinate in vertices.as_flattened_mut() {
        *coordinate = (f64::from(*coordinate) / norm) as f32;
    }
    let mut faces = ICOSAHEDRON.to_vec();
    for _ in 0..subdivisions {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let [p, q] = [a, b].map(|corner| vertices[corner as usize]);
                let between = [0, 1, 2].map(|i| (p[i] + q[i]) / 2.0);
                let [x, y, z] = between;
                let norm = (x * x + y * y + z * z).sqrt();
                vertices.push(between.map(|x| x / norm));
                vertices.len() as u32 - 1
            })
        };
        let mut finer = Vec::with_capacity(4 * faces.len());
        for [a, b, c] in faces {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        faces = finer;
    }
    let exact = |corner: [f32; 3]| Vec3::from_array(corner.map(f64::from));
    Triangles {
        vertices: vertices.into_iter().map(exact).collect(),
        faces,
        ..Triangles::default()
    }
}

/// Makes the upper half of an octahedron, each triangle cut into rows of triangles, its corners moved to the unit
/// sphere, and a disc around the origin.
fn hemisphere(resolution: usize) -> Triangles {
    const EQUATOR: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    let rows = resolution + 1;
    let mut vertices = vec![Vec3::new(0.0, 0.0, 1.0)];
    for row in 1..=rows {
        let down = row as f64 / rows as f64;
        for side in 0..4 {
            let [start, end] = [EQUATOR[side], EQUATOR[(side + 1) % 4]];
            for step in 0..row {
                let along = |i: usize| {
                    let delta = (down * end[i] - down * start[i]) / row as f64;
                    down * start[i] + step as f64 * delta
                };
                let (x, y, z) = (along(0), along(1), 1.0 - down);
                let norm = (x * x + y * y + z * z).sqrt();
                vertices.push(point(x / norm, y / norm, z / norm));
            }
        }
    }
    let middle = vertices.len() as u32;
    vertices.push(Vec3::ZERO);
    // Corner number `step` of a side of a row; the pole is row 0.
    let corner = |row: usize, side: usize, step: usize| match row {
        0 => 0,
        _ => (1 + 2 * row * (row - 1) + (side * row + step) % (4 * row)) as u32,
    };
    let mut faces = Vec::new();
    for row in 0..rows {
        for side in 0..4 {
            for step in 0..=row {
                let here = corner(row, side, step);
                let below = [step, step + 1].map(|step| corner(row + 1, side, step));
                faces.push([here, below[0], below[1]]);
                if step < row {
                    faces.push([here, below[1], corner(row, side, step + 1)]);
                }
            }
        }
    }
    for step in 0..4 * rows {
        faces.push([corner(rows, 0, step), middle, corner(rows, 0, step + 1)]);
    }
    Triangles {
        vertices,
        faces,
        ..Triangles::default()
    }
}

/// Makes a cone: a regular polygon at z = −1 and another, of the given radius, or a point at z = 1.
fn cone(corners: usize, radius: f64) -> Triangles {
    let ring = |radius: f64, z: f64, turns: usize| {
        (0..corners).map(move |corner| {
            let angle = 2.0 * (corner + turns * corners) as f64 * PI / corners as f64;
            point(radius * angle.cos(), radius * angle.sin(), z)
        })
    };
    let mut vertices: Vec<Vec3<f64>> = ring(1.0, -1.0, 0).collect();
    match radius > 0.0 {
        // As in MuJoCo, the upper ring's angles are a full turn greater.
        true => vertices.extend(ring(radius, 1.0, 1)),
        false => vertices.push(Vec3::new(0.0, 0.0, 1.0)),
    }
    Triangles {
        vertices,
        ..Triangles::default()
    }
}

/// Returns abs(x)ⁿ with the sign of x.
fn signed_power(x: f64, exponent: f64) -> f64 {
    x.abs().powf(exponent).copysign(x)
}

/// Makes a superellipsoid with half axes of length one: rings of points between two poles.
fn supersphere(resolution: usize, e: f64, n: f64) -> Triangles {
    let step = |angle: f64, k: usize| k as f64 * angle / resolution as f64;
    let mut vertices = vec![Vec3::new(0.0, 0.0, -1.0)];
    for ring in 1..resolution {
        let v = -PI / 2.0 + step(PI, ring);
        for k in 0..resolution {
            let u = -PI + step(2.0 * PI, k);
            let out = signed_power(v.cos(), n);
            vertices.push(point(
                out * signed_power(u.cos(), e),
                out * signed_power(u.sin(), e),
                signed_power(v.sin(), n),
            ));
        }
    }
    let north = vertices.len() as u32;
    vertices.push(Vec3::new(0.0, 0.0, 1.0));
    let at = |ring: usize, k: usize| (1 + ring * resolution + k % resolution) as u32;
    let mut faces: Vec<[u32; 3]> = (0..resolution)
        .map(|k| [0, at(0, k + 1), at(0, k)])
        .collect();
    for ring in 0..resolution - 2 {
        for k in 0..resolution {
            let [below, next] = [at(ring, k), at(ring, k + 1)];
            let [above, beyond] = [at(ring + 1, k), at(ring + 1, k + 1)];
            faces.extend([[below, next, above], [next, beyond, above]]);
        }
    }
    let last = resolution - 2;
    faces.extend((0..resolution).map(|k| [at(last, k), at(last, k + 1), north]));
    Triangles {
        vertices,
        faces,
        ..Triangles::default()
    }
}

/// Makes a supertoroid about a circle of radius one.
fn supertorus(resolution: usize, radius: f64, s: f64, t: f64) -> Triangles {
    let angle = |k: usize| 2.0 * PI * k as f64 / resolution as f64;
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    let at = |i: usize, j: usize| ((i % resolution) * resolution + j % resolution) as u32;
    for i in 0..resolution {
        for j in 0..resolution {
            let (u, v) = (angle(i), angle(j));
            let out = 1.0 + radius * signed_power(v.cos(), s);
            vertices.push(point(
                out * signed_power(u.cos(), t),
                out * signed_power(u.sin(), t),
                radius * signed_power(v.sin(), s),
            ));
            let [here, next] = [at(i, j), at(i + 1, j)];
            let [above, beyond] = [at(i, j + 1), at(i + 1, j + 1)];
            faces.extend([[here, next, above], [next, beyond, above]]);
        }
    }
    Triangles {
        vertices,
        faces,
        ..Triangles::default()
    }
}

/// Returns the edges of equal bins from −1 to 1.
fn edges(bins: usize) -> impl Iterator<Item = f64> {
    // Summed in MuJoCo's order, so that the last bits agree.
    let width = 2.0 / bins as f64;
    (0..=bins).scan(-1.0, move |edge, _| {
        let here = *edge;
        *edge += width;
        Some(here)
    })
}

/// Makes the centres of bins of azimuth and elevation on the unit sphere, about −z, up to these angles (degrees) to
/// each side. The closer `fovea` is to one, the denser they are in the middle: an edge x moves to fovea x⁵ + (1 −
/// fovea) x.
fn wedge(bins: [usize; 2], angles: [f64; 2], fovea: f64) -> Triangles {
    let middles = |axis: usize| -> Vec<f64> {
        let moved = edges(bins[axis]).map(|x| match fovea > 0.0 {
            true => fovea * x.powi(5) + (1.0 - fovea) * x,
            false => x,
        });
        let scaled: Vec<f64> = moved.map(|x| x * (angles[axis] * PI / 180.0)).collect();
        (scaled.windows(2))
            .map(|pair| 0.5 * (pair[1] + pair[0]))
            .collect()
    };
    let elevations = middles(1);
    let (mut vertices, mut tangents) = (Vec::new(), Vec::new());
    for azimuth in middles(0) {
        let (sin, cos) = azimuth.sin_cos();
        for &elevation in &elevations {
            let (up, out) = elevation.sin_cos();
            vertices.push(point(out * sin, up, -out * cos));
            tangents.push([point(cos, 0.0, sin), point(-up * sin, out, up * cos)]);
        }
    }
    Triangles {
        vertices,
        tangents,
        ..Triangles::default()
    }
}

/// Makes the centres of the cells of a square with sides of length two at z = −1, and the triangles between them.
fn plate(cells: [usize; 2]) -> Triangles {
    let [rows, columns] = cells;
    let middle = |k: usize, count: usize| -1.0 + (k as f64 + 0.5) * (2.0 / count as f64);
    let at = |i: usize, j: usize| (i * columns + j) as u32;
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for i in 0..rows {
        for j in 0..columns {
            vertices.push(point(middle(i, rows), middle(j, columns), -1.0));
            if i > 0 && j > 0 {
                let [here, below] = [at(i, j), at(i, j - 1)];
                let [left, corner] = [at(i - 1, j), at(i - 1, j - 1)];
                faces.extend([[corner, below, left], [here, left, below]]);
            }
        }
    }
    let axes = [Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
    Triangles {
        tangents: vec![axes; vertices.len()],
        vertices,
        faces,
        ..Triangles::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wedge_is_a_part_of_the_unit_sphere_about_minus_z() {
        let found = wedge([4, 6], [90.0, 30.0], 0.5);
        assert_eq!(found.vertices.len(), 24);
        // The fovea moves the edges 1/2 and 1 of the last azimuth bin to (1/2⁵ + 1/2) / 2 = 17/64 and 1, of 90 degrees;
        // the edges 2/3 and 1 of elevation to 97/243 and 1, of 30 degrees.
        let azimuth = (17.0 / 64.0 + 1.0) / 2.0 * PI / 2.0;
        let elevation = (97.0 / 243.0 + 1.0) / 2.0 * PI / 6.0;
        let expected = Vec3::new(
            elevation.cos() * azimuth.sin(),
            elevation.sin(),
            -elevation.cos() * azimuth.cos(),
        );
        assert!((found.vertices[23] - expected).norm() < 1e-6);
        assert!(
            found
                .vertices
                .iter()
                .all(|v| (v.norm() - 1.0).abs() < 1e-6 && v.z < 0.0)
        );
    }
}
