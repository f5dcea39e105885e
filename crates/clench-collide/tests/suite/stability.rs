//! Contact points of resting faces move little when a body does.

use crate::common::{Random, Scene, V, hulls};
use clench_collide::{PATCH_POINTS, Pose, Shape, ShapeKind};
use clench_math::{Quat, Vec3};

/// The radius of a face, m.
const RADIUS: f64 = 0.1;
const HALF: f64 = 0.05;

fn cylinder() -> Shape<'static, f64> {
    Shape::new(ShapeKind::Cylinder, Vec3::new(RADIUS, HALF, 0.0))
}

fn prism(corners: usize) -> Shape<'static, f64> {
    Shape::mesh(hulls::hull_of(&hulls::cap_circles(RADIUS, HALF, corners)))
}

fn slab() -> Shape<'static, f64> {
    Shape::new(ShapeKind::Box, Vec3::new(0.3, 0.4, HALF))
}

/// Returns a shape on another, pressed by 0.2 mm less `up`, moved and rotated.
fn scene(
    below: Shape<'static, f64>,
    above: Shape<'static, f64>,
    [x, y]: [f64; 2],
    up: f64,
    turn: Quat<f64>,
) -> Scene {
    let top = if below.kind() == ShapeKind::Plane {
        0.0
    } else {
        HALF
    };
    let above_at = Pose {
        position: Vec3::new(x, y, top + HALF - 2e-4 + up),
        rotation: turn.to_matrix(),
    };
    let (lower, upper) = ((below, Pose::IDENTITY), (above, above_at));
    let in_order = below.kind() <= above.kind();
    let ((a, pose_a), (b, pose_b)) = if in_order {
        (lower, upper)
    } else {
        (upper, lower)
    };
    Scene {
        a,
        pose_a,
        b,
        pose_b,
        margin: 1e-3,
    }
}

fn points(scene: &Scene) -> Vec<V> {
    let contacts = scene.contacts();
    contacts.as_slice().iter().map(|c| c.position).collect()
}

/// Returns the Hausdorff distance of two sets of points.
fn apart(these: &[V], those: &[V]) -> f64 {
    let one_way = |these: &[V], those: &[V]| {
        let nearest = |p: &V| {
            those
                .iter()
                .map(|q| (*p - *q).norm())
                .fold(f64::INFINITY, f64::min)
        };
        these.iter().map(nearest).fold(0.0, f64::max)
    };
    one_way(these, those).max(one_way(those, these))
}

/// Returns the ratios of point motion to body motion in many small random motions, in ascending order.
fn jumps(below: Shape<'static, f64>, above: Shape<'static, f64>, tilt: f64) -> Vec<f64> {
    const MOTION: f64 = 1e-9;
    let mut random = Random(11);
    let mut ratios = Vec::new();
    for _ in 0..400 {
        let beside = [0, 1].map(|_| random.range(-0.03, 0.03));
        let (axis, yaw) = (random.range(0.0, 6.3), random.range(-3.0, 3.0));
        let about = |axis: V, angle: f64| Quat::from_axis_angle(axis, angle);
        let turn = about(Vec3::new(axis.cos(), axis.sin(), 0.0), tilt)
            * about(Vec3::new(0.0, 0.0, 1.0), yaw);
        let before = points(&scene(below, above, beside, 0.0, turn));
        let way = random.direction() * MOTION;
        let turned = Quat::from_rotation_vector(random.direction() * (MOTION / RADIUS)) * turn;
        let beside = [beside[0] + way.x, beside[1] + way.y];
        let after = points(&scene(below, above, beside, way.z, turned));
        assert!((3..=PATCH_POINTS).contains(&before.len()));
        ratios.push(apart(&before, &after) / MOTION);
    }
    ratios.sort_by(f64::total_cmp);
    ratios
}

fn scenes() -> [(&'static str, Shape<'static, f64>, Shape<'static, f64>); 7] {
    [
        ("a cylinder on a slab", slab(), cylinder()),
        ("a cylinder on a cylinder", cylinder(), cylinder()),
        ("a cylinder on a prism", prism(40), cylinder()),
        ("a prism on a slab", slab(), prism(40)),
        ("a prism on a prism", prism(40), prism(40)),
        ("few corners on few", prism(11), prism(11)),
        (
            "a prism on a plane",
            Shape::new(ShapeKind::Plane, V::ZERO),
            prism(40),
        ),
    ]
}

#[test]
fn points_of_level_faces_move_little_with_the_body() {
    for (name, below, above) in scenes() {
        for tilt in [0.0, 1e-7] {
            let ratios = jumps(below, above, tilt);
            let most = ratios[ratios.len() - 1];
            assert!(most < 10.0, "{name}, tilted by {tilt}: {most}");
        }
    }
}

#[test]
fn points_of_tilted_faces_turn_with_the_deepest() {
    // The deepest point of a circle turns with the direction of the tilt; that of a polygon jumps from corner to
    // corner.
    let tilt = 1e-3;
    for (name, below, above) in scenes() {
        let ratios = jumps(below, above, tilt);
        let most = ratios[ratios.len() - 1 - ratios.len() / 50];
        assert!(most < 10.0 + 5.0 / tilt, "{name}: {most}");
    }
}
