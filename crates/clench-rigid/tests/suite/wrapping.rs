//! Strings around and through spheres and cylinders.

use clench_math::{Mat3, Quat, Vec3};
use clench_rigid::dynamics::wrap::{Obstacle, WrapShape, Wrapped, wrap};
use std::f64::consts::PI;

const TOLERANCE: f64 = 1e-12;

/// Returns an obstacle of radius 1 at the origin.
fn unit(shape: WrapShape, side: Option<[f64; 3]>) -> Obstacle<f64> {
    Obstacle {
        shape,
        centre: Vec3::ZERO,
        axes: Mat3::IDENTITY,
        radius: 1.0,
        side: side.map(Vec3::from_f64),
    }
}

fn string(ends: [[f64; 3]; 2], obstacle: &Obstacle<f64>) -> Wrapped<f64> {
    wrap(ends.map(Vec3::from_f64), obstacle)
}

fn total(ends: [[f64; 3]; 2], found: &Wrapped<f64>) -> f64 {
    let [a, b] = ends.map(Vec3::from_f64);
    (found.points[0] - a).norm() + found.length + (b - found.points[1]).norm()
}

const SHAPES: [WrapShape; 2] = [WrapShape::Sphere, WrapShape::Cylinder];

#[test]
fn a_string_that_misses_is_straight() {
    for shape in SHAPES {
        let found = string([[-3.0, 1.2, 0.0], [3.0, 1.1, 0.0]], &unit(shape, None));
        assert!(!found.touches, "{shape:?}");
    }
}

#[test]
fn a_string_around_half_a_circle_is_as_long_as_that() {
    // The tangents along ±x at height ±1 make the arc half the circle.
    let side = Some([1.5, 0.0, 0.0]);
    for shape in SHAPES {
        let ends = [[-2.0, 1.0, 0.0], [-2.0, -1.0, 0.0]];
        let found = string(ends, &unit(shape, side));
        assert!(found.touches, "{shape:?}");
        assert!((found.length - PI).abs() < TOLERANCE);
        assert!((total(ends, &found) - (4.0 + PI)).abs() < TOLERANCE);
    }
}

#[test]
fn without_a_side_site_the_string_takes_the_shorter_path() {
    for shape in SHAPES {
        let ends = [[-2.0, 0.3, 0.0], [2.0, 0.3, 0.0]];
        let found = string(ends, &unit(shape, None));
        assert!(found.touches && found.points.iter().all(|point| point.y > 0.0));
    }
}

#[test]
fn a_string_wraps_on_the_side_of_the_side_site() {
    for shape in SHAPES {
        let ends = [[-2.0, 0.3, 0.0], [2.0, 0.3, 0.0]];
        let below = string(ends, &unit(shape, Some([0.0, -1.5, 0.0])));
        assert!(below.touches && below.points.iter().all(|point| point.y < 0.0));
        // Both paths together are the whole circle minus the angles of the four tangents.
        let above = string(ends, &unit(shape, None));
        let turn = above.length + below.length;
        let tangents = 4.0 * (1.0f64 / (4.0f64 + 0.09).sqrt()).acos();
        assert!((turn + tangents - 2.0 * PI).abs() < TOLERANCE);
        // A string that already passes on that side is unchanged.
        let clear = string(
            [[-2.0, 1.1, 0.0], [2.0, 1.2, 0.0]],
            &unit(shape, Some([0.1, 2.0, 0.0])),
        );
        assert!(!clear.touches);
    }
}

#[test]
fn along_a_cylinder_a_string_rises_evenly() {
    let ends = [[-2.0, 1.0, 0.0], [-2.0, -1.0, 3.0]];
    let found = string(ends, &unit(WrapShape::Cylinder, Some([1.5, 0.0, 0.0])));
    let slope = 3.0 / (4.0 + PI);
    assert!((found.points[0].z - 2.0 * slope).abs() < TOLERANCE);
    assert!((found.points[1].z - (2.0 + PI) * slope).abs() < TOLERANCE);
    assert!((total(ends, &found) - (4.0 + PI).hypot(3.0)).abs() < TOLERANCE);
}

#[test]
fn a_string_through_a_geom_is_reflected_at_equal_angles() {
    for shape in SHAPES {
        let ends = [[1.5, 0.7, 0.0], [0.6, 2.5, 0.0]];
        let found = string(ends, &unit(shape, Some([0.1, -0.2, 0.1])));
        assert!(found.touches && found.length == 0.0);
        let at = found.points[0];
        assert!((at.norm() - 1.0).abs() < TOLERANCE && (found.points[1] - at).norm() == 0.0);
        let angle = |end: [f64; 3]| (Vec3::from_f64(end) - at).normalize().0.dot(at);
        // Newton's method has MuJoCo's tolerance.
        assert!((angle(ends[0]) - angle(ends[1])).abs() < 1e-5);
        // A string that crosses the geom anyway is straight.
        let straight = string(
            [[-2.0, 0.3, 0.0], [2.0, 0.3, 0.0]],
            &unit(shape, Some([0.0; 3])),
        );
        assert!(!straight.touches);
    }
}

#[test]
fn a_string_that_begins_inside_is_straight() {
    for shape in SHAPES {
        for side in [None, Some([0.0, 2.0, 0.0]), Some([0.1, 0.0, 0.0])] {
            let found = string([[0.2, 0.3, 0.0], [3.0, 0.0, 0.0]], &unit(shape, side));
            assert!(!found.touches, "{shape:?}, {side:?}");
        }
    }
}

#[test]
fn a_string_and_its_obstacle_move_together() {
    let (turn, shift) = (
        Quat::new(0.8, 0.36, -0.48, 0.0),
        Vec3::from_f64([1.0, -2.0, 0.5]),
    );
    let world = |v: [f64; 3]| shift + turn.rotate(Vec3::from_f64(v));
    for shape in SHAPES {
        for side in [[0.3, -1.5, 0.2], [0.1, 0.2, 0.3]] {
            let ends = [[-2.0, 0.6, 0.1], [1.7, 0.9, -0.4]];
            let still = string(ends, &unit(shape, Some(side)));
            let moved = wrap(
                ends.map(world),
                &Obstacle {
                    centre: shift,
                    axes: turn.to_matrix(),
                    side: Some(world(side)),
                    ..unit(shape, None)
                },
            );
            assert_eq!(still.touches, moved.touches);
            for (a, b) in still.points.iter().zip(moved.points) {
                assert!((world(a.to_array()) - b).norm() < TOLERANCE);
            }
        }
    }
}

#[test]
fn degenerate_wraps_give_finite_numbers() {
    const GRID: [f64; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];
    let points = || {
        GRID.iter()
            .flat_map(|&x| GRID.iter().map(move |&y| [x, y, 0.0]))
    };
    let sides = [
        None,
        Some([0.0; 3]),
        Some([0.0, 1.0, 0.0]),
        Some([0.0, 0.0, 2.0]),
        Some([0.5, 0.0, 0.0]),
    ];
    for shape in SHAPES {
        for side in sides {
            for (first, second) in points().flat_map(|a| points().map(move |b| (a, b))) {
                let found = string([first, second], &unit(shape, side));
                let single = wrap(
                    [first, second].map(Vec3::<f32>::from_f64),
                    &Obstacle {
                        shape,
                        centre: Vec3::ZERO,
                        axes: Mat3::IDENTITY,
                        radius: 1.0,
                        side: side.map(Vec3::from_f64),
                    },
                );
                let finite = found.length.is_finite()
                    && single.length.is_finite()
                    && found.points.iter().all(|p| p.norm().is_finite())
                    && single.points.iter().all(|p| p.norm().is_finite());
                assert!(finite, "{first:?} {second:?} {side:?}");
            }
        }
    }
}
