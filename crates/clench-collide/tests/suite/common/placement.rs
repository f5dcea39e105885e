//! Placements of two shapes, typical of a simulation or degenerate.

use super::{Random, Scene, V, fields, hulls, mesh_hull};
use clench_collide::{Pose, Shape, ShapeKind};
use clench_math::{Quat, Vec3};

/// Returns the number of values in the size of a shape.
pub fn size_count(kind: ShapeKind) -> usize {
    match kind {
        ShapeKind::Sphere => 1,
        ShapeKind::Capsule | ShapeKind::Cylinder => 2,
        _ => 3,
    }
}

/// The placement of two shapes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// Up to 2 cm deep, at random.
    Pressed,
    /// Apart within the margin of 1 cm, at random.
    Apart,
    /// Turned by right angles, on multiples of 2 cm.
    Grid,
    /// A face or side on that of the other, tilted by 1e-7 to 3e-3 rad.
    Resting,
}

/// All placements.
pub const PLACEMENTS: [Placement; 4] = [
    Placement::Pressed,
    Placement::Apart,
    Placement::Grid,
    Placement::Resting,
];

/// Returns two shapes of about 10 cm.
pub fn placed(random: &mut Random, kinds: (ShapeKind, ShapeKind), placement: Placement) -> Scene {
    let round = |v: V| Vec3::from_array(v.to_array().map(|x| (x * 50.0).round() / 50.0));
    let mut shapes = [kinds.0, kinds.1].map(|kind| match kind {
        ShapeKind::Mesh => Shape::mesh(random.pick(hulls::handy())),
        _ => Shape::new(kind, random.size(0.04, 0.12)),
    });
    let mut rotations = [random.rotation(), random.rotation()];
    let mut direction = random.direction();
    match placement {
        Placement::Pressed | Placement::Apart => {}
        Placement::Grid => {
            let sized = shapes.iter_mut().filter(|s| s.kind() != ShapeKind::Mesh);
            sized.for_each(|shape| *shape = shape.resized(round(shape.size())));
            rotations = [random.quarter_turns(), random.quarter_turns()];
        }
        Placement::Resting => {
            let tilt = random.direction() * 10f64.powf(random.range(-7.0, -2.5));
            let yaw = Quat::from_axis_angle(Vec3::new(0.0, 0.0, 1.0), random.range(0.0, 6.3));
            let turn = Quat::from_rotation_vector(tilt) * yaw;
            rotations = [
                random.quarter_turns(),
                turn.to_matrix() * random.quarter_turns(),
            ];
            direction = Vec3::new(random.range(-0.3, 0.3), random.range(-0.3, 0.3), 1.0);
            direction = direction.normalize().0;
        }
    }
    let pose = |rotation| Pose {
        position: V::ZERO,
        rotation,
    };
    let mut scene = Scene {
        a: shapes[0],
        pose_a: pose(rotations[0]),
        b: shapes[1],
        pose_b: pose(rotations[1]),
        margin: 1.0,
    };
    if kinds.0 == ShapeKind::Plane {
        direction = scene.pose_a.axis();
    }
    let wanted = match placement {
        Placement::Pressed | Placement::Grid => -random.range(0.0, 0.02),
        Placement::Apart => random.range(0.0, 0.0099),
        Placement::Resting => -random.range(0.0, 1e-3),
    };
    let (mut near, mut far) = (0.0, 0.5);
    for _ in 0..40 {
        let middle = (near + far) / 2.0;
        scene.pose_b.position = direction * middle;
        let apart = scene.deepest().is_none_or(|c| c.distance > wanted);
        *(if apart { &mut far } else { &mut near }) = middle;
    }
    if placement == Placement::Grid {
        scene.pose_b.position = round(scene.pose_b.position);
    }
    scene.margin = if placement == Placement::Apart {
        0.01
    } else {
        0.0
    };
    scene
}

/// Returns degenerate shapes and poses of every kind: of zero size, tiny, huge, thin, concentric, aligned, touching
/// exactly, far away.
pub fn degenerate_scene(random: &mut Random, kinds: (ShapeKind, ShapeKind)) -> Scene {
    let length = |random: &mut Random| match (random.unit() * 8.0) as usize {
        0 => 0.0,
        1 => 1e-6,
        2 => 1e-3,
        3 => 1e3,
        4 | 5 => 0.1,
        _ => random.range(0.05, 0.5),
    };
    let shape = |random: &mut Random, kind| match kind {
        ShapeKind::Mesh if random.unit() < 0.7 => Shape::mesh(random.pick(hulls::degenerate())),
        ShapeKind::Mesh => Shape::mesh(random.pick(hulls::wide())),
        ShapeKind::HeightField => {
            let fields = fields::degenerate();
            Shape::height_field(&fields[(random.unit() * fields.len() as f64) as usize])
        }
        _ => Shape::new(
            kind,
            Vec3::new(length(random), length(random), length(random)),
        ),
    };
    let rotation = |random: &mut Random| match (random.unit() * 3.0) as usize {
        0 => random.quarter_turns(),
        1 => {
            let tilt = random.direction() * 10f64.powf(random.range(-12.0, -2.0));
            Quat::from_rotation_vector(tilt).to_matrix() * random.quarter_turns()
        }
        _ => random.rotation(),
    };
    let (a, mut b) = (shape(random, kinds.0), shape(random, kinds.1));
    let is_terrain = a.kind() == ShapeKind::HeightField;
    if random.unit() < 0.2 && mesh_hull(&a) == mesh_hull(&b) && !is_terrain {
        // Copies the sizes that the first shape has.
        let mut size = b.size();
        (0..size_count(a.kind())).for_each(|i| size[i] = a.size()[i]);
        b = b.resized(size);
    }
    let (rotation_a, rotation_b) = (rotation(random), rotation(random));
    let direction = match (random.unit() * 3.0) as usize {
        0 => rotation_a.column(0),
        1 => rotation_b.column(2),
        _ => random.direction(),
    };
    let mut scene = Scene {
        a,
        pose_a: Pose {
            position: V::ZERO,
            rotation: rotation_a,
        },
        b,
        pose_b: Pose {
            position: V::ZERO,
            rotation: rotation_b,
        },
        margin: random.pick(&[0.0, 0.0, 0.01, 10.0]),
    };
    let finite = |r: f64| if r.is_finite() { r } else { 1.0 };
    let reach = finite(a.bounding_radius()) + finite(b.bounding_radius());
    // A height field has no support function; any position near its surface will do.
    let touching = match a.kind() {
        ShapeKind::HeightField => a.size().z * random.range(-1.0, 4.0),
        _ => -scene.gap_along(direction),
    };
    scene.pose_b.position = match (random.unit() * 5.0) as usize {
        0 => V::ZERO,
        1 => direction * touching,
        2 => direction * (reach * random.unit()),
        3 => direction * (touching * random.range(0.99, 1.01)),
        _ => direction * (reach + 10.0 * random.unit()),
    };
    if random.unit() < 0.1 {
        let far = random.vector() * 1e4;
        scene.pose_a.position += far;
        scene.pose_b.position += far;
    }
    scene
}
