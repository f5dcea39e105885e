//! Triangulation of polygons, as MuJoCo 4.0 does for OBJ files.
//!
//! A quadrilateral is split along its shorter diagonal, a larger polygon by ear clipping: corner by corner, projected
//! along the coordinate axis that its first corner faces most, a corner is cut off if it is not reflex and its triangle
//! contains no other vertex. On a polygon that is not convex, the search may terminate early and omit the
//! remainder. Rounding affects the result, so all is in single precision, and a corner's sense is compared with the
//! sign of x₀ y₁ − y₀ x₁, as in tinyobjloader, the reader that MuJoCo uses.

use clench_math::Vec3;

/// Larger polygons are omitted, as in MuJoCo.
const MAX_CORNERS: usize = 100;

/// Returns the triangles of a polygon with these corners, as indices of the corners.
pub(super) fn triangulate(polygon: &[Vec3<f64>]) -> Vec<[usize; 3]> {
    let points: Vec<[f32; 3]> = (polygon.iter())
        .map(|place| place.to_array().map(|x| x as f32))
        .collect();
    match points[..] {
        [_, _, _] => vec![[0, 1, 2]],
        [a, b, c, d] => match square(a, c) < square(b, d) {
            true => vec![[0, 1, 2], [0, 2, 3]],
            false => vec![[0, 1, 3], [1, 2, 3]],
        },
        _ if points.len() > MAX_CORNERS => Vec::new(),
        _ => {
            let [x, y] = plane(&points);
            clip(points.iter().map(|point| [point[x], point[y]]))
        }
    }
}

/// Returns the square of a distance.
fn square(p: [f32; 3], q: [f32; 3]) -> f32 {
    let [x, y, z] = [0, 1, 2].map(|i| q[i] - p[i]);
    x * x + y * y + z * z
}

/// Returns the two coordinates in which the first corner that is not straight has the largest area.
fn plane(points: &[[f32; 3]]) -> [usize; 2] {
    let count = points.len();
    for k in 0..count {
        let [p, q, r] = [k, k + 1, k + 2].map(|i| points[i % count]);
        let edge = |from: [f32; 3], to: [f32; 3]| [0, 1, 2].map(|i| to[i] - from[i]);
        let (a, b) = (edge(p, q), edge(q, r));
        let along = |i: usize, j: usize| (a[i] * b[j] - a[j] * b[i]).abs();
        let [x, y, z] = [along(1, 2), along(2, 0), along(0, 1)];
        if x.max(y).max(z) > f32::EPSILON {
            return match () {
                () if x > y && x > z => [1, 2],
                () if z > x && z > y => [0, 1],
                () => [0, 2],
            };
        }
    }
    [1, 2]
}

/// Clips ears off a polygon until a triangle is left, or a round finds none.
fn clip(flat: impl Iterator<Item = [f32; 2]>) -> Vec<[usize; 3]> {
    let mut faces = Vec::new();
    let mut left: Vec<(usize, [f32; 2])> = flat.enumerate().collect();
    let (mut first, mut tries) = (0, left.len());
    while left.len() > 3 && tries > 0 {
        let count = left.len();
        first %= count;
        tries -= 1;
        let ear = [0, 1, 2].map(|k| left[(first + k) % count]);
        let triangle = ear.map(|(_, point)| point);
        let mut others = (3..count).map(|k| left[(first + k) % count].1);
        if is_reflex(&triangle) || others.any(|point| is_inside(point, &triangle)) {
            first += 1;
            continue;
        }
        faces.push(ear.map(|(corner, _)| corner));
        left.remove((first + 1) % count);
        // An ear found by the last try of a round is the last one; any other starts a new round.
        if tries > 0 {
            tries = left.len() + 1;
        }
    }
    if let [(a, _), (b, _), (c, _)] = left[..] {
        faces.push([a, b, c]);
    }
    faces
}

/// Returns true if a corner turns against the sense of its first edge about the origin.
fn is_reflex([p, q, r]: &[[f32; 2]; 3]) -> bool {
    let rotation = (q[0] - p[0]) * (r[1] - q[1]) - (q[1] - p[1]) * (r[0] - q[0]);
    let sense = (p[0] * q[1] - p[1] * q[0]) * 0.5;
    rotation * sense < 0.0
}

/// Returns true if a point is in a triangle: a ray from it along the first axis crosses an odd number of edges.
fn is_inside([x, y]: [f32; 2], triangle: &[[f32; 2]; 3]) -> bool {
    let [p, q, r] = *triangle;
    let crosses = |[ax, ay]: [f32; 2], [bx, by]: [f32; 2]| {
        (ay > y) != (by > y) && x < (bx - ax) * (y - ay) / (by - ay) + ax
    };
    crosses(p, r) ^ crosses(q, p) ^ crosses(r, q)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The outline of the letter E.
    const OUTLINE: [[f64; 2]; 12] = [
        [-0.3, -0.5],
        [0.4, -0.5],
        [0.4, -0.3],
        [-0.1, -0.3],
        [-0.1, -0.1],
        [0.3, -0.1],
        [0.3, 0.1],
        [-0.1, 0.1],
        [-0.1, 0.3],
        [0.4, 0.3],
        [0.4, 0.5],
        [-0.3, 0.5],
    ];

    /// Its triangles when it is translated.
    fn faces([x, y]: [f64; 2]) -> Vec<[usize; 3]> {
        triangulate(&OUTLINE.map(|[a, b]| Vec3::new(a + x, b + y, 0.0)))
    }

    #[test]
    fn concave_polygons_are_triangulated_as_by_mujoco() {
        // The faces that MuJoCo 4.0.0 makes of these polygons.
        let all = [
            [0, 1, 2],
            [0, 2, 3],
            [0, 3, 4],
            [0, 4, 5],
            [0, 5, 6],
            [0, 6, 7],
            [7, 8, 9],
            [9, 10, 11],
            [11, 0, 7],
            [7, 9, 11],
        ];
        assert_eq!(faces([0.0, 0.0]), all);
        assert_eq!(faces([2.0, 1.0]), [[1, 2, 3], [5, 6, 7], [9, 10, 11]]);
        assert_eq!(faces([-2.0, 1.0]), [[3, 4, 5], [7, 8, 9]]);
        let some = [
            [0, 1, 2],
            [0, 2, 3],
            [3, 4, 5],
            [3, 5, 6],
            [7, 8, 9],
            [9, 10, 11],
            [11, 0, 3],
        ];
        assert_eq!(faces([-0.4, 0.0]), some);
    }

    #[test]
    fn polygons_with_more_than_a_hundred_corners_are_omitted() {
        let count = |corners: u32| {
            let corner = |k: u32| f64::from(k) * std::f64::consts::TAU / f64::from(corners);
            let places: Vec<_> = (0..corners)
                .map(|k| Vec3::new(corner(k).cos(), corner(k).sin(), 0.0))
                .collect();
            triangulate(&places).len()
        };
        assert_eq!((count(100), count(101)), (98, 0));
    }
}
