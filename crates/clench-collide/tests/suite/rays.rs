//! Properties of a ray's first hit: it lies on the surface, the normal points outward there, and no part of the shape
//! is in front of it.

use crate::common::{Random, V, convert_pose, off_surface};
use clench_collide::{
    HeightField, Hit, Hull, Pose, Ray, Shape, ShapeKind, TriangleMesh, UnitRay, convex_hull, ray,
};
use clench_math::{Lanes, Mat3, Real, Vec3};

const ROUND: [ShapeKind; 5] = [
    ShapeKind::Sphere,
    ShapeKind::Capsule,
    ShapeKind::Ellipsoid,
    ShapeKind::Cylinder,
    ShapeKind::Box,
];

fn inside(shape: &Shape<'static, f64>, pose: &Pose<f64>, point: V) -> bool {
    let (p, s) = (pose.local(point), shape.size());
    match shape.kind() {
        ShapeKind::Sphere => p.norm() < s.x,
        ShapeKind::Capsule => (p - Vec3::new(0.0, 0.0, p.z.clamp(-s.y, s.y))).norm() < s.x,
        ShapeKind::Ellipsoid => Vec3::new(p.x / s.x, p.y / s.y, p.z / s.z).norm() < 1.0,
        ShapeKind::Cylinder => p.x.hypot(p.y) < s.x && p.z.abs() < s.y,
        _ => p.x.abs() < s.x && p.y.abs() < s.y && p.z.abs() < s.z,
    }
}

#[test]
fn the_first_hit_lies_on_the_surface_and_nothing_is_before_it() {
    let mut random = Random(41);
    for kind in ROUND {
        let (mut hits, mut misses, mut within) = (0, 0, 0);
        for k in 0..2000 {
            let shape = random.shape(kind);
            let pose = Pose {
                position: random.vector(),
                rotation: random.rotation(),
            };
            let mut origin = pose.position + random.vector() * 0.7;
            let mut direction = random.direction() * random.range(0.1, 3.0);
            if k % 3 == 0 {
                direction = pose.position + random.vector() * 0.2 - origin;
            }
            if k % 50 == 0 {
                origin = pose.position;
                direction = pose.rotation.column(k / 50 % 3);
            }
            let hit = ray(&shape, &pose, &Ray { origin, direction });
            let begins_inside = inside(&shape, &pose, origin);
            within += usize::from(begins_inside);
            let steps = if hit.distance.is_finite() {
                hit.distance
            } else {
                4.0 / direction.norm()
            };
            for step in 0..200 {
                let at = origin + direction * (steps * (f64::from(step) + 0.5) / 200.0);
                assert_eq!(
                    inside(&shape, &pose, at),
                    begins_inside,
                    "{kind:?} {shape:?} {pose:?} {origin:?} {direction:?} {hit:?}"
                );
            }
            if !hit.distance.is_finite() {
                misses += 1;
                assert!(!begins_inside && hit.normal == V::ZERO);
                continue;
            }
            hits += 1;
            let at = origin + direction * hit.distance;
            assert!(off_surface(&shape, &pose, at) < 1e-12, "{kind:?} {hit:?}");
            assert!((hit.normal.norm() - 1.0).abs() < 1e-12);
            assert_eq!(hit.normal.dot(direction) > 0.0, begins_inside);
            // The normal points outward.
            assert!(
                !inside(&shape, &pose, at + hit.normal * 1e-6)
                    && inside(&shape, &pose, at - hit.normal * 1e-6)
            );
            let tip = crate::common::support(&shape, &pose, hit.normal);
            assert!((tip - at).dot(hit.normal).abs() < 1e-9, "{kind:?} {hit:?}");
        }
        assert!(
            hits > 500 && misses > 200 && within > 50,
            "{kind:?}: {hits} {misses} {within}"
        );
    }
}

#[test]
fn planes_are_hit_from_above_and_within_their_size() {
    let pose = Pose {
        position: Vec3::new(0.0, 0.0, 1.0),
        rotation: Mat3::IDENTITY,
    };
    let cast = |size, from: [f64; 3], to: [f64; 3]| {
        let ray_ = Ray {
            origin: Vec3::from_array(from),
            direction: Vec3::from_array(to),
        };
        ray(&Shape::new(ShapeKind::Plane, size), &pose, &ray_).distance
    };
    assert_eq!(cast(V::ZERO, [5.0, 9.0, 3.0], [0.0, 1.0, -4.0]), 0.5);
    assert_eq!(
        cast(V::ZERO, [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        f64::INFINITY
    );
    assert_eq!(
        cast(V::ZERO, [0.0, 0.0, 0.0], [0.0, 0.0, -1.0]),
        f64::INFINITY
    );
    assert_eq!(
        cast(V::ZERO, [0.0, 0.0, 2.0], [1.0, 0.0, 0.0]),
        f64::INFINITY
    );
    assert_eq!(
        cast(Vec3::new(1.0, 0.0, 0.1), [0.9, 50.0, 2.0], [0.0, 0.0, -1.0]),
        1.0
    );
    assert_eq!(
        cast(Vec3::new(1.0, 0.0, 0.1), [1.1, 50.0, 2.0], [0.0, 0.0, -1.0]),
        f64::INFINITY
    );
}

#[test]
fn lanes_are_scalars_and_single_precision_is_near() {
    let mut random = Random(46);
    type L = Lanes<f64, 4>;
    for kind in ROUND.into_iter().chain([ShapeKind::Plane]) {
        for _ in 0..100 {
            let shapes: Vec<_> = (0..4).map(|_| random.shape(kind)).collect();
            let rays: Vec<_> = (0..4)
                .map(|_| Ray {
                    origin: random.vector(),
                    direction: random.vector(),
                })
                .collect();
            let pose = Pose {
                position: random.vector() * 0.3,
                rotation: random.rotation(),
            };
            let gather = |v: &dyn Fn(usize) -> V| {
                let mut out = Vec3::<L>::ZERO;
                for lane in 0..4 {
                    for axis in 0..3 {
                        out[axis].set_lane(lane, v(lane)[axis]);
                    }
                }
                out
            };
            let shape = Shape::new(kind, gather(&|lane| shapes[lane].size()));
            let wide = Ray {
                origin: gather(&|lane| rays[lane].origin),
                direction: gather(&|lane| rays[lane].direction),
            };
            let hits = ray(&shape, &convert_pose::<L>(&pose), &wide);
            for lane in 0..4 {
                let alone = ray(&shapes[lane], &pose, &rays[lane]);
                assert_eq!(hits.distance.lane(lane).to_bits(), alone.distance.to_bits());
                assert_eq!(hits.normal.x.lane(lane).to_bits(), alone.normal.x.to_bits());
            }
            let of = |v: V| Vec3::<f32>::from_f64(v.to_array());
            let single = Ray {
                origin: of(rays[0].origin),
                direction: of(rays[0].direction),
            };
            let shape = Shape::new(kind, of(shapes[0].size()));
            let hit: Hit<f32> = ray(&shape, &convert_pose(&pose), &single);
            let alone = ray(&shapes[0], &pose, &rays[0]);
            let grazes = alone.normal.dot(rays[0].direction).abs() < 0.1;
            if hit.distance.is_finite() && alone.distance.is_finite() && !grazes {
                assert!(
                    (f64::from(hit.distance) - alone.distance).abs()
                        < 1e-4 * (1.0 + alone.distance)
                );
            }
        }
    }
}

#[test]
fn a_ray_enters_the_bounding_sphere_before_the_hit() {
    let mut random = Random(53);
    let (mut hits, mut proofs) = (0, 0);
    for k in 0..20_000 {
        // Balls are tiny and huge, near and far, and directions have any length.
        let scale = 10_f64.powi(k % 9 - 4);
        let radius = scale * random.range(0.1, 1.0);
        let ball = Shape::new(ShapeKind::Sphere, Vec3::new(radius, 0.0, 0.0));
        let center = random.vector() * 10_f64.powi(k % 7 - 3);
        let pose = Pose {
            position: center,
            rotation: Mat3::IDENTITY,
        };
        let origin = random.vector() * 10_f64.powi(k % 5);
        // Most rays graze the ball.
        let across = random.direction().cross(center - origin).normalize().0;
        let beside = across * (radius * random.range(0.99, 1.01));
        let direction = (center + beside - origin) * 10_f64.powi(k % 11 - 5);
        let line = Ray { origin, direction };
        let unit = UnitRay::of(&line);
        let hit = ray(&ball, &pose, &line).distance;
        if hit.is_finite() {
            hits += 1;
            assert!(unit.may_intersect(center, radius, hit), "{line:?}");
            assert!(
                unit.may_intersect(center, radius, f64::INFINITY),
                "{line:?}"
            );
        } else {
            proofs += usize::from(!unit.may_intersect(center, radius, f64::INFINITY));
        }
        let nearest = (center - origin).norm() - radius;
        // The test is sharp for distant balls.
        if nearest > 100.0 * radius {
            let within = 0.99 * nearest / direction.norm();
            assert!(!unit.may_intersect(center, radius, within), "{line:?}");
        }
    }
    assert!(hits > 2000 && proofs > 2000, "{hits} hits, {proofs} proofs");
}

#[test]
fn nothing_breaks_a_ray() {
    let mut random = Random(47);
    let field =
        HeightField::new(3, 4, (0..12).map(f64::from).collect(), [0.5, 0.4, 0.1, 0.2]).unwrap();
    let points: Vec<V> = (0..9).map(|_| random.direction()).collect();
    let hull = Hull::new(&convex_hull(&points, None).unwrap(), &points);
    let (vertices, faces) = crate::common::hulls::bumpy(&mut random);
    let mesh = TriangleMesh::new(vertices, faces).unwrap();
    let strange = [
        f64::NAN,
        f64::INFINITY,
        -f64::INFINITY,
        0.0,
        -0.0,
        1e-300,
        1e300,
        -1.0,
        1.0,
        0.5,
        5e-324,
        f64::MAX,
    ];
    let pick = |random: &mut Random| strange[(random.unit() * 12.0) as usize];
    let any = |random: &mut Random| Vec3::new(pick(random), pick(random), pick(random));
    for k in 0..40_000 {
        let kinds = ROUND
            .into_iter()
            .chain([ShapeKind::Plane])
            .collect::<Vec<_>>();
        let shape = match k % 8 {
            0 => Shape::mesh(&hull),
            1 => Shape::height_field(&field),
            k => Shape::new(
                kinds[k - 2],
                if random.unit() < 0.5 {
                    any(&mut random)
                } else {
                    Vec3::new(0.5, 0.5, 0.5)
                },
            ),
        };
        let cast = Ray {
            origin: if random.unit() < 0.5 {
                any(&mut random)
            } else {
                Vec3::new(0.5, -2.0, 0.0)
            },
            direction: if random.unit() < 0.5 {
                any(&mut random)
            } else {
                Vec3::new(0.0, 1.0, 0.0)
            },
        };
        let hits = [
            ray(&shape, &Pose::IDENTITY, &cast),
            mesh.ray(&Pose::IDENTITY, &cast),
        ];
        for hit in hits {
            let unit = (hit.normal.norm() - 1.0).abs() < 1e-9;
            assert!(
                hit.distance == f64::INFINITY && hit.normal == V::ZERO
                    || hit.distance >= 0.0 && hit.distance.is_finite() && unit,
                "{hit:?} of {cast:?} at {shape:?}"
            );
        }
        let d = cast.direction;
        let largest = d
            .to_array()
            .into_iter()
            .fold(0.0, |m: f64, x| m.max(x.abs()));
        let leads = largest >= f64::MIN_POSITIVE && d.to_array().iter().all(|x| x.is_finite());
        assert!(leads || hits.iter().all(|hit| hit.distance == f64::INFINITY));
    }
    // The length of the direction only sets the unit of distance.
    let ball = Shape::new(ShapeKind::Sphere, Vec3::new(0.5, 0.0, 0.0));
    for length in [1e-300, 1e-9, 1e9, 1e300] {
        let cast = Ray {
            origin: Vec3::new(0.0, 0.0, 2.5),
            direction: Vec3::new(0.0, 0.0, -length),
        };
        let hit = ray(&ball, &Pose::IDENTITY, &cast);
        assert!((hit.distance * length - 2.0).abs() < 1e-12, "{hit:?}");
    }
}
