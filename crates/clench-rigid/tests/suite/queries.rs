//! Ray hits and distances of geoms in scenes with simple answers.

use crate::common::hourglass;
use clench_collide::ShapeKind;
use clench_math::{Quat, Vec3};
use clench_rigid::builder::{BodySpec, GeomSpec, HeightFieldSpec, JointSpec, ModelBuilder};
use clench_rigid::{RayFilter, RayHit, Sim, SimError};
use std::sync::Arc;

type V = Vec3<f64>;

const UP: V = Vec3::new(0.0, 0.0, 1.0);

fn v(x: f64, y: f64, z: f64) -> V {
    Vec3::new(x, y, z)
}

fn forwarded(builder: &ModelBuilder) -> Sim {
    let model = builder.build().unwrap_or_else(|error| panic!("{error}"));
    let mut sim = Sim::new(Arc::new(model)).unwrap();
    sim.forward().unwrap();
    sim
}

/// Builds a 4 m by 6 m floor, a post on it, and 2 m above it a movable ball with a small box inside.
fn scene() -> ModelBuilder {
    let mut builder = ModelBuilder::new("scene");
    builder.add_ground(GeomSpec {
        size: v(2.0, 3.0, 1.0),
        ..GeomSpec::plane().named("floor")
    });
    builder.add_ground(GeomSpec {
        group: 2,
        ..GeomSpec::cylinder(0.1, 0.5)
            .named("post")
            .at([1.0, 0.0, 0.5])
    });
    let ball = BodySpec::new("ball")
        .at([0.0, 0.0, 2.0])
        .joint(JointSpec::free("free"))
        .geom(GeomSpec::sphere(0.5).named("ball"))
        .geom(GeomSpec {
            group: 1,
            ..GeomSpec::cuboid([0.1, 0.1, 0.1]).named("core")
        });
    builder.add_body(ModelBuilder::WORLD, ball);
    builder
}

fn hit(sim: &mut Sim, origin: V, direction: V, filter: RayFilter) -> Option<(String, f64, V)> {
    let RayHit {
        geom,
        distance,
        normal,
    } = sim.ray(origin, direction, &filter).expect("finite")?;
    Some((sim.model().geoms[geom].name.clone(), distance, normal))
}

#[test]
fn a_ray_hits_the_first_geom_that_it_may() {
    let mut sim = forwarded(&scene());
    let all = RayFilter::default();
    let ball = sim.model().geoms[2].body;
    let mut expect = |origin, direction, filter, name: &str, distance: f64| {
        let (found, d, normal) = hit(&mut sim, origin, direction, filter).expect("a hit");
        assert_eq!(found, name);
        assert!((d - distance).abs() < 1e-12, "{name}: {d}");
        assert!((normal.norm() - 1.0).abs() < 1e-12);
    };
    let down = v(0.0, 0.0, -0.5);
    expect(v(0.0, 0.0, 4.0), down, all, "ball", 3.0);
    let groups = |groups| RayFilter { groups, ..all };
    let without_balls = groups([false, true, true, true, true, true]);
    expect(v(0.0, 0.0, 4.0), down, without_balls, "core", 3.8);
    let past_the_ball = RayFilter {
        excluded_body: Some(ball),
        ..all
    };
    expect(v(0.0, 0.0, 4.0), down, past_the_ball, "floor", 8.0);
    // A ray from inside hits the surface as it leaves.
    expect(v(0.0, 0.0, 2.3), UP, all, "ball", 0.2);
    expect(v(0.0, 0.0, 2.0), UP, all, "core", 0.1);
    expect(v(3.0, 0.0, 0.5), v(-1.0, 0.0, 0.0), all, "post", 1.9);

    assert_eq!(hit(&mut sim, v(0.0, 0.0, 4.0), UP, all), None);
    let moving = RayFilter {
        fixed: false,
        ..all
    };
    assert_eq!(
        hit(&mut sim, v(3.0, 0.0, 0.5), v(-1.0, 0.0, 0.0), moving),
        None
    );
    assert_eq!(
        hit(&mut sim, v(0.0, 0.0, 4.0), down, groups([false; 6])),
        None
    );
    // The floor is finite.
    assert_eq!(hit(&mut sim, v(2.1, 0.0, 1.0), down, all), None);
    assert_eq!(hit(&mut sim, v(0.0, 3.1, 1.0), down, all), None);
    for nothing in [V::ZERO, v(f64::NAN, 0.0, 1.0), v(0.0, f64::INFINITY, 0.0)] {
        assert_eq!(hit(&mut sim, v(0.0, 0.0, 4.0), nothing, all), None);
        assert_eq!(hit(&mut sim, nothing * f64::NAN, down, all), None);
    }
    // A group number above the last counts as the last.
    let mut far = scene();
    far.bodies[1].geoms[0].group = 99;
    let mut far = forwarded(&far);
    let (found, ..) = hit(
        &mut far,
        v(0.0, 0.0, 4.0),
        down,
        groups([true, true, true, true, true, false]),
    )
    .unwrap();
    assert_eq!(found, "core");
}

#[test]
fn rays_hit_geoms_at_their_written_poses() {
    let mut sim = forwarded(&scene());
    let all = RayFilter::default();
    let (name, ..) = hit(&mut sim, v(0.0, 0.0, 4.0), -UP, all).unwrap();
    assert_eq!(name, "ball");
    sim.state.qpos[0] = 1.0;
    let (name, distance, _) = hit(&mut sim, v(0.0, 0.0, 4.0), -UP, all).unwrap();
    assert_eq!((name.as_str(), distance), ("floor", 4.0));
    let (name, ..) = hit(&mut sim, v(1.0, 0.0, 4.0), -UP, all).unwrap();
    assert_eq!(name, "ball");
}

#[test]
fn invisible_geoms_are_not_hit() {
    let mut builder = scene();
    builder.bodies[1].geoms[0].visible = false;
    let mut sim = forwarded(&builder);
    let (name, ..) = hit(&mut sim, v(0.0, 0.0, 4.0), -UP, RayFilter::default()).unwrap();
    assert_eq!(name, "core");
}

#[test]
fn rays_pass_through_the_waist_of_a_mesh_whose_hull_collides() {
    for collides in [0, 1] {
        let mut builder = ModelBuilder::new("mesh");
        builder.meshes.push(hourglass());
        let turn = Quat::from_axis_angle(UP, 0.7);
        let body = BodySpec::new("glass")
            .joint(JointSpec::free("free"))
            .geom(GeomSpec {
                contype: collides,
                conaffinity: collides,
                quat: turn,
                ..GeomSpec::mesh("hourglass").at([0.1, 0.2, 0.3])
            });
        builder.add_body(ModelBuilder::WORLD, body);
        builder.add_ground(GeomSpec::sphere(0.1).at([5.0, 0.0, 0.3]));
        let mut sim = forwarded(&builder);
        let place = |local: V| v(0.1, 0.2, 0.3) + turn.rotate(local);
        let along = turn.rotate(v(0.0, 1.0, 0.0));
        let all = RayFilter::default();
        // Beside the waist, at half height of the upper half, and from above.
        assert_eq!(sim.ray(place(v(-0.3, -4.0, 0.0)), along, &all), Ok(None));
        let side = sim
            .ray(place(v(-0.3, -4.0, 0.5)), along, &all)
            .unwrap()
            .expect("a hit");
        assert!((side.distance - 3.6).abs() < 1e-9, "{side:?}");
        let top = sim.ray(place(v(-0.3, 0.0, 3.0)), -UP, &all);
        let top = top.unwrap().expect("a hit");
        assert!((top.distance - 2.0).abs() < 1e-9 && (top.normal - UP).norm() < 1e-9);
        // The distance is that of the hull, even if the mesh does not collide.
        let mesh = (0..2)
            .find(|g| sim.model().geoms[*g].kind == ShapeKind::Mesh)
            .unwrap();
        let found = sim
            .distance(mesh, 1 - mesh, f64::INFINITY)
            .unwrap()
            .expect("a distance");
        let back = sim
            .distance(1 - mesh, mesh, f64::INFINITY)
            .unwrap()
            .unwrap();
        assert!((found.distance - back.distance).abs() < 1e-12);
        assert_eq!(found.points, [back.points[1], back.points[0]]);
        // The ball is nearest to the hull's upright edge between the tips.
        let edge = place(v(1.0, 0.0, 0.0));
        let truth = (v(5.0, 0.0, 0.3) - edge).norm() - 0.1;
        assert!(
            (found.distance - truth).abs() < 1e-9,
            "{} for {truth}",
            found.distance
        );
    }
}

#[test]
fn terrain_is_hit_and_carries_distances() {
    let mut builder = ModelBuilder::new("terrain");
    let heights = vec![0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    builder.height_fields.push(HeightFieldSpec {
        name: "hill".to_owned(),
        rows: 3,
        columns: 3,
        heights,
        size: [1.0, 1.0, 0.5, 0.1],
        origin: None,
    });
    builder.add_ground(GeomSpec::height_field("hill"));
    let ball = BodySpec::new("ball")
        .at([0.0, 0.0, 1.0])
        .joint(JointSpec::free("free"));
    builder.add_body(ModelBuilder::WORLD, ball.geom(GeomSpec::sphere(0.1)));
    let mut sim = forwarded(&builder);
    let found = sim
        .ray(v(0.0, 0.0, 0.8), -UP, &RayFilter::default())
        .unwrap()
        .expect("a hit");
    assert_eq!(found.geom, 0);
    assert!((found.distance - 0.3).abs() < 1e-12);
    let apart = sim.distance(1, 0, 1.0).unwrap().expect("near");
    assert!((apart.distance - 0.4).abs() < 1e-9 && (apart.normal + UP).norm() < 1e-9);
    assert_eq!(sim.distance(1, 0, 0.3).unwrap(), None);
}

#[test]
fn distances_are_of_geoms_that_exist() {
    let mut sim = forwarded(&scene());
    let near = sim.distance(0, 2, f64::INFINITY).unwrap().unwrap();
    assert!((near.distance - 1.5).abs() < 1e-12);
    assert!((near.points[1] - v(0.0, 0.0, 1.5)).norm() < 1e-12);
    // Geoms of one body also have a distance: minus the half size of the box and the ball's radius.
    let within = sim.distance(2, 3, 0.0).unwrap().unwrap();
    assert!((within.distance + 0.6).abs() < 1e-12);
    assert!(matches!(
        sim.distance(0, 9, 1.0),
        Err(SimError::NoSuchElement {
            kind: "geom",
            index: 9,
            count: 4
        })
    ));
}

/// Returns the distance of a ray from above, and that of two geoms.
fn measure(sim: &mut Sim) -> (f64, f64) {
    let down = sim.ray(v(0.0, 0.0, 9.0), -UP, &RayFilter::default());
    let apart = sim.distance(0, 2, f64::INFINITY).unwrap().unwrap();
    (down.unwrap().expect("a hit").distance, apart.distance)
}

#[test]
fn queries_of_a_new_simulation_see_its_initial_state() {
    let new = || Sim::new(forwarded(&scene()).model().clone()).unwrap();
    assert_eq!(measure(&mut new()), measure(&mut forwarded(&scene())));
    let mass = new().mass_matrix().unwrap();
    assert_eq!(mass, forwarded(&scene()).mass_matrix().unwrap());
    assert!(mass[0] > 500.0, "{mass:?}");
    for output in ["xpos", "qfrc_bias"] {
        let found = new().output(output).unwrap();
        assert_eq!(found, forwarded(&scene()).output(output).unwrap());
        assert!(found.iter().any(|&x| x != 0.0));
    }
    let mut sim = new();
    sim.refresh().unwrap();
    assert_eq!(sim.workspace().qacc, forwarded(&scene()).workspace().qacc);
}

#[test]
fn queries_use_the_written_state_as_in_mujoco() {
    let mut sim = forwarded(&scene());
    sim.step().unwrap();
    sim.step().unwrap();
    // After a step, outputs follow from the state at its start.
    let (xpos, qpos) = (sim.output("xpos").unwrap(), sim.state.qpos.clone());
    assert!(xpos[5] > qpos[2]);
    let (down, apart) = measure(&mut sim);
    assert!((9.0 - down - (xpos[5] + 0.5)).abs() < 1e-12);
    assert!((apart - (xpos[5] - 0.5)).abs() < 1e-12);
    // Controls and forces take effect in the next step.
    sim.state.qfrc_applied[2] = 7.0;
    assert_eq!(sim.output("xpos").unwrap(), xpos);
    // Positions take effect at once.
    sim.state.qpos[2] = 4.0;
    let (down, apart) = measure(&mut sim);
    assert!((down - 4.5).abs() < 1e-12 && (apart - 3.5).abs() < 1e-12);
    assert_eq!(sim.output("xpos").unwrap()[5], 4.0);
    // So do velocities, parameters and resets.
    sim.state.qvel[2] = -3.0;
    assert_eq!(sim.output("cvel").unwrap()[11], -3.0);
    sim.set_param("body_mass", &[0.0, 2.0]).unwrap();
    assert_eq!(sim.mass_matrix().unwrap()[0], 2.0);
    sim.reset();
    assert_eq!(sim.output("xpos").unwrap()[5], 2.0);
    // A query of an invalid state returns an error.
    sim.state.qpos[2] = f64::NAN;
    assert!(matches!(sim.mass_matrix(), Err(SimError::Fault(_))));
    sim.state.qpos[2] = 3.0;
    assert_eq!(sim.output("xpos").unwrap()[5], 3.0);
}

#[test]
fn results_of_a_step_are_read_without_another_pass() {
    let (mut asked, mut alone) = (forwarded(&scene()), forwarded(&scene()));
    for _ in 0..300 {
        asked.step().unwrap();
        alone.step().unwrap();
        let contacts = alone.workspace().contacts.len();
        assert_eq!(asked.contacts().len(), contacts);
        measure(&mut asked);
        assert_eq!(asked.output("qacc").unwrap(), alone.workspace().qacc);
        assert_eq!(asked.state.qpos, alone.state.qpos);
    }
}
