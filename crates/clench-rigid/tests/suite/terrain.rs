//! Bodies on terrain: a flat field acts like a plane for any triangulation.

use clench_math::Vec3;
use clench_rigid::Sim;
use clench_rigid::builder::{BodySpec, GeomSpec, HeightFieldSpec, JointSpec, ModelBuilder};
use clench_rigid::options::{FrictionCone, RigidOptions};
use std::sync::Arc;

fn field(cells: usize, heights: impl Fn(usize, usize) -> f64) -> HeightFieldSpec {
    let points = cells + 1;
    HeightFieldSpec {
        name: "ground".to_owned(),
        rows: points,
        columns: points,
        heights: (0..points * points)
            .map(|k| heights(k / points, k % points))
            .collect(),
        size: [3.0, 3.0, 0.5, 0.5],
        origin: None,
    }
}

fn moving(shape: GeomSpec, ground: Option<HeightFieldSpec>, velocity: [f64; 6]) -> Sim {
    let mut builder = ModelBuilder::new("terrain");
    match ground {
        Some(field) => {
            builder.add_ground(GeomSpec::height_field(&field.name));
            builder.height_fields.push(field);
        }
        None => builder.add_ground(GeomSpec::plane()),
    }
    let body = BodySpec::new("body")
        .at([0.013, 0.021, 0.0999])
        .joint(JointSpec::free("free"))
        .geom(shape);
    builder.add_body(ModelBuilder::WORLD, body);
    // The result does not depend on the order of contacts or on their tangents.
    let options = RigidOptions::new()
        .tolerance(0.0)
        .friction_cone(FrictionCone::Elliptic);
    let model = Arc::new(builder.build().unwrap());
    let mut sim = Sim::with_options(model, options).unwrap();
    sim.state.qvel.copy_from_slice(&velocity);
    sim
}

#[test]
fn nothing_stumbles_over_the_triangles_of_a_flat_field() {
    let rolling = [1.0, 0.3, 0.0, -3.0, 10.0, 0.0];
    let sliding = [1.5, -0.4, 0.0, 0.0, 0.0, 2.0];
    let lying = GeomSpec {
        quat: clench_math::Quat::new(0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt(), 0.0),
        ..GeomSpec::capsule(0.1, 0.2)
    };
    let cases = [
        (GeomSpec::sphere(0.1), rolling),
        (GeomSpec::cuboid([0.2, 0.15, 0.1]), sliding),
        (lying, rolling),
    ];
    for (shape, velocity) in cases {
        for cells in [3, 37, 100] {
            let flat = field(cells, |_, _| 0.0);
            let mut plane = moving(shape.clone(), None, velocity);
            let mut terrain = moving(shape.clone(), Some(flat), velocity);
            for step in 0..300 {
                plane.step().unwrap();
                terrain.step().unwrap();
                let pairs = plane.state.qpos.iter().zip(&terrain.state.qpos);
                let apart = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(
                    apart < 1e-8,
                    "{:?} on {cells} cells, step {step}: {apart}",
                    shape.kind
                );
            }
            let way = (terrain.state.qpos[0] - 0.013).hypot(terrain.state.qpos[1] - 0.021);
            assert!(way > 0.1, "{:?} moved by {way}", shape.kind);
        }
    }
}

#[test]
fn bodies_come_to_rest_in_the_valleys_of_rough_ground() {
    let ground = || field(24, |row, column| ((row * 7 + column * 5) % 11) as f64);
    let shapes = [
        GeomSpec::sphere(0.1),
        GeomSpec::cuboid([0.2, 0.15, 0.1]),
        GeomSpec::cylinder(0.15, 0.1),
        GeomSpec::capsule(0.1, 0.2),
        GeomSpec::ellipsoid([0.2, 0.15, 0.1]),
    ];
    for shape in shapes {
        let mut sim = moving(shape.clone(), Some(ground()), [0.0; 6]);
        sim.state.qpos[2] = 1.0;
        let start = sim.energy().unwrap();
        for _ in 0..2500 {
            sim.step().unwrap();
        }
        let position = Vec3::new(sim.state.qpos[0], sim.state.qpos[1], sim.state.qpos[2]);
        let speed = sim.state.qvel.iter().map(|v| v * v).sum::<f64>().sqrt();
        let energy = sim.energy().unwrap();
        assert!(
            energy.potential + energy.kinetic < start.potential,
            "{:?}",
            shape.kind
        );
        // It neither falls through nor is thrown out, and hardly moves.
        assert!(
            position.x.abs() < 1.5 && position.y.abs() < 1.5,
            "{:?}: {position:?}",
            shape.kind
        );
        assert!(
            (0.0..0.8).contains(&position.z),
            "{:?}: {position:?}",
            shape.kind
        );
        assert!(speed < 0.3, "{:?}: {speed}", shape.kind);
        for contact in sim.contacts() {
            assert!(contact.dist > -0.01, "{:?}: {}", shape.kind, contact.dist);
        }
    }
}
