//! Rays against shapes made of triangles: meshes, hulls and height fields are hit like their individual triangles.

use crate::common::hulls::bumpy;
use crate::common::{Random, V};
use clench_collide::{
    HeightField, Hull, Pose, Ray, Shape, TriangleMesh, TriangleMeshError, convex_hull, ray,
};
use clench_math::Vec3;

/// Intersects a ray with all triangles by the textbook method (Möller & Trumbore 1997).
fn by_force(vertices: &[V], faces: &[[u32; 3]], origin: V, direction: V) -> f64 {
    let hit = |face: &[u32; 3]| {
        let [p, q, r] = face.map(|v| vertices[v as usize]);
        let (e, f) = (q - p, r - p);
        let h = direction.cross(f);
        let determinant = e.dot(h);
        if determinant == 0.0 {
            return f64::INFINITY;
        }
        let s = origin - p;
        let u = s.dot(h) / determinant;
        let g = s.cross(e);
        let v = direction.dot(g) / determinant;
        let t = f.dot(g) / determinant;
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 {
            t
        } else {
            f64::INFINITY
        }
    };
    faces.iter().map(hit).fold(f64::INFINITY, f64::min)
}

#[test]
fn triangles_are_hit_as_by_trying_them_all() {
    let mut random = Random(42);
    for _ in 0..10 {
        let (vertices, faces) = bumpy(&mut random);
        let mesh = TriangleMesh::new(vertices.clone(), faces.clone()).unwrap();
        let pose = Pose {
            position: random.vector(),
            rotation: random.rotation(),
        };
        let (mut hits, mut misses) = (0, 0);
        for k in 0..400 {
            let (from, to) = (random.vector(), random.vector() * 0.6);
            let from = if k % 4 == 0 { from * 0.1 } else { from };
            let cast = Ray {
                origin: pose.point(from),
                direction: pose.rotation * (to - from),
            };
            let hit = mesh.ray(&pose, &cast);
            let truth = by_force(&vertices, &faces, from, to - from);
            assert!(
                hit.distance == truth || (hit.distance - truth).abs() < 1e-9,
                "{hit:?} for {truth}"
            );
            if hit.distance.is_finite() {
                hits += 1;
                assert!((hit.normal.norm() - 1.0).abs() < 1e-12);
            } else {
                misses += 1;
            }
        }
        assert!(hits > 200 && misses > 50, "{hits} {misses}");
    }
}

#[test]
fn no_ray_slips_out_of_a_closed_mesh() {
    let mut random = Random(43);
    let (vertices, faces) = bumpy(&mut random);
    let mesh = TriangleMesh::new(vertices.clone(), faces).unwrap();
    for k in 0..20_000 {
        // Also at vertices and at the middles of edges.
        let direction = match k % 3 {
            0 => random.direction(),
            1 => vertices[k % vertices.len()],
            _ => vertices[k % vertices.len()] + vertices[(k + 1) % vertices.len()],
        };
        let hit = mesh.ray(
            &Pose::IDENTITY,
            &Ray {
                origin: V::ZERO,
                direction,
            },
        );
        assert!(
            hit.distance.is_finite() || direction.norm() == 0.0,
            "{direction:?}"
        );
    }
}

#[test]
fn a_mesh_of_nothing_is_never_hit_and_a_broken_one_is_refused() {
    let empty = TriangleMesh::new(Vec::new(), Vec::new()).unwrap();
    let down = Ray {
        origin: V::ZERO,
        direction: Vec3::new(0.0, 0.0, -1.0),
    };
    assert_eq!(empty.ray(&Pose::IDENTITY, &down).distance, f64::INFINITY);
    let corner = TriangleMesh::new(vec![V::ZERO; 3], vec![[0, 1, 2], [0, 1, 3]]);
    assert_eq!(corner, Err(TriangleMeshError::Corner(1, 3)));
    let nan = TriangleMesh::new(vec![V::ZERO, Vec3::new(0.0, f64::NAN, 0.0)], Vec::new());
    assert_eq!(nan, Err(TriangleMeshError::NotFinite(1)));
    // All triangles coincide: splitting them does not shrink their bounds.
    let same = TriangleMesh::new(vec![V::ZERO; 3], vec![[0, 1, 2]; 1000]).unwrap();
    assert_eq!(same.ray(&Pose::IDENTITY, &down).distance, f64::INFINITY);
}

#[test]
fn hulls_are_hit_like_their_triangles() {
    let mut random = Random(44);
    let points: Vec<V> = (0..60)
        .map(|_| random.direction() * random.range(0.3, 0.4))
        .collect();
    let surface = convex_hull(&points, None).unwrap();
    let hull = Hull::new(&surface, &points);
    let faces: Vec<[u32; 3]> = (0..hull.face_count())
        .flat_map(|face| {
            let corners = hull.corners(face).to_vec();
            (2..corners.len()).map(move |k| [corners[0], corners[k - 1], corners[k]])
        })
        .collect();
    let mesh = TriangleMesh::new(hull.vertices().to_vec(), faces).unwrap();
    let pose = Pose {
        position: random.vector(),
        rotation: random.rotation(),
    };
    let mut hits = 0;
    for k in 0..1000 {
        let from = random.vector() * if k % 4 == 0 { 0.15 } else { 1.0 };
        let cast = Ray {
            origin: pose.point(from),
            direction: pose.rotation * (random.vector() * 0.5 - from),
        };
        let (a, b) = (
            ray(&Shape::mesh(&hull), &pose, &cast),
            mesh.ray(&pose, &cast),
        );
        assert!(
            a.distance == b.distance || (a.distance - b.distance).abs() < 1e-9,
            "{a:?} {b:?}"
        );
        assert!((a.normal - b.normal).norm() < 1e-6);
        hits += usize::from(a.distance.is_finite());
    }
    assert!(hits > 300 && hits < 1000);
}

/// Returns true if a point is between the surface of a height field and its base.
fn is_inside(field: &HeightField, p: V) -> bool {
    let [x, y, _, base] = field.size();
    let over = p.x.abs() < x && p.y.abs() < y;
    over && p.z > -base && p.z < field.height_at(p.x, p.y)
}

/// Adds the plane between a height field and its base, which rays from inside hit.
fn add_floor(field: &HeightField, vertices: &mut Vec<V>, faces: &mut Vec<[u32; 3]>) {
    let [x, y, ..] = field.size();
    let first = vertices.len() as u32;
    let corners = [(-x, -y), (x, -y), (x, y), (-x, y)];
    vertices.extend(corners.map(|(x, y)| Vec3::new(x, y, 0.0)));
    faces.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

/// Returns the height field as a closed mesh.
fn skin(field: &HeightField) -> (Vec<V>, Vec<[u32; 3]>) {
    let (rows, columns) = (field.rows(), field.columns());
    let [.., base] = field.size();
    let top = (0..rows * columns).map(|k| field.point(k / columns, k % columns));
    let mut vertices: Vec<V> = top.collect();
    let below: Vec<V> = vertices
        .iter()
        .map(|v| Vec3::new(v.x, v.y, -base))
        .collect();
    vertices.extend(below);
    let at = |row: usize, column: usize, low: usize| {
        (low * rows * columns + row * columns + column) as u32
    };
    let mut faces = Vec::new();
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            for low in 0..2 {
                let v = |r, c| at(row + r, column + c, low);
                faces.push([v(0, 0), v(1, 1), v(1, 0)]);
                faces.push([v(0, 0), v(0, 1), v(1, 1)]);
            }
        }
    }
    let mut wall = |a: (usize, usize), b: (usize, usize)| {
        let [p, q, r, s] = [
            at(a.0, a.1, 0),
            at(b.0, b.1, 0),
            at(a.0, a.1, 1),
            at(b.0, b.1, 1),
        ];
        faces.push([p, r, q]);
        faces.push([q, r, s]);
    };
    for column in 0..columns - 1 {
        wall((0, column), (0, column + 1));
        wall((rows - 1, column + 1), (rows - 1, column));
    }
    for row in 0..rows - 1 {
        wall((row, columns - 1), (row + 1, columns - 1));
        wall((row + 1, 0), (row, 0));
    }
    (vertices, faces)
}

#[test]
fn height_fields_are_hit_like_their_triangles() {
    let mut random = Random(45);
    for k in 0..40 {
        let (rows, columns) = (2 + k % 7, 2 + k % 11);
        let heights = (0..rows * columns).map(|_| random.unit()).collect();
        let field = HeightField::new(rows, columns, heights, [0.5, 0.7, 0.4, 0.2]).unwrap();
        let closed = skin(&field);
        let mut parted = closed.clone();
        add_floor(&field, &mut parted.0, &mut parted.1);
        let pose = Pose {
            position: random.vector(),
            rotation: random.rotation(),
        };
        let shape = Shape::height_field(&field);
        let mut hits = 0;
        for k in 0..400 {
            let from = random.vector() * if k % 3 == 0 { 0.4 } else { 1.2 };
            let mut to = random.vector().scale_by(Vec3::new(0.6, 0.8, 0.3)) - from;
            if k % 7 == 0 {
                to = Vec3::new(0.0, 0.0, if k % 2 == 0 { -1.0 } else { 1.0 });
            }
            let cast = Ray {
                origin: pose.point(from),
                direction: pose.rotation * to,
            };
            let hit = ray(&shape, &pose, &cast);
            let inside = is_inside(&field, from);
            let (vertices, faces) = if inside { &parted } else { &closed };
            let truth = by_force(vertices, faces, from, to);
            assert!(
                hit.distance == truth || (hit.distance - truth).abs() < 1e-9,
                "{hit:?} for {truth}: {from:?} {to:?}"
            );
            if hit.distance.is_finite() {
                hits += 1;
                let on =
                    pose.local(cast.origin + cast.direction * (hit.distance + 1e-7 / to.norm()));
                let ahead = by_force(vertices, faces, on, pose.rotation.transpose_mul(hit.normal));
                let behind = by_force(
                    vertices,
                    faces,
                    on,
                    -pose.rotation.transpose_mul(hit.normal),
                );
                // The point is just outside or just inside, so the surface is close along the normal or against it.
                assert!(ahead < 1e-5 || behind < 1e-5, "{hit:?} {ahead} {behind}");
            }
        }
        assert!(hits > 150 && hits < 400, "{hits}");
    }
}

#[test]
fn a_ray_crosses_a_large_field_from_end_to_end() {
    let field = HeightField::new(
        1000,
        1000,
        (0..1_000_000).map(|k| f64::from(k % 1000 % 3)).collect(),
        [50.0, 50.0, 1.0, 1.0],
    )
    .unwrap();
    let shape = Shape::height_field(&field);
    let start = std::time::Instant::now();
    for k in 0..1000 {
        let y = -49.0 + 0.098 * f64::from(k);
        let graze = Ray {
            origin: Vec3::new(-60.0, y, 1.1),
            direction: Vec3::new(1.0, 1e-3, -1e-3),
        };
        let hit = ray(&shape, &Pose::IDENTITY, &graze);
        // The first ray descends to 1 m after 100 m, at the end of the field or beyond it.
        let to = Ray {
            direction: Vec3::new(1.0, 1e-3, -3e-3),
            ..graze
        };
        let far = ray(&shape, &Pose::IDENTITY, &to);
        assert!(
            hit.distance > 99.0 && far.distance < 90.0,
            "{hit:?} {far:?} {y}"
        );
    }
    assert!(start.elapsed().as_secs() < 20);
}
