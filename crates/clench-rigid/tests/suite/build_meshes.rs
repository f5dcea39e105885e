//! Meshes and height fields computed by hand: poses, masses, and changes of their parameters in batches.

use crate::common::hourglass;
use clench_collide::ShapeKind;
use clench_rigid::builder::{
    BodySpec, GeomSpec, HeightFieldSpec, JointSpec, MeshInertia, MeshSpec, ModelBuilder,
};
use clench_rigid::{Model, Sim};
use std::sync::Arc;

/// Returns a box from the origin to (1, 2, 3).
fn corners() -> Vec<[f64; 3]> {
    (0..8)
        .map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|side| side as f64))
        .map(|[x, y, z]| [x, 2.0 * y, 3.0 * z])
        .collect()
}

fn with_mesh(mesh: MeshSpec, geom: GeomSpec) -> ModelBuilder {
    let mut builder = ModelBuilder::new("mesh");
    builder.meshes.push(mesh);
    let body = BodySpec::new("body").joint(JointSpec::free("free"));
    builder.add_body(ModelBuilder::WORLD, body.geom(geom));
    builder
}

fn build(mesh: MeshSpec) -> Model {
    let geom = GeomSpec::mesh(&mesh.name).density(1.0);
    let builder = with_mesh(mesh, geom);
    builder.build().unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_hull_of_points_stands_about_its_centre() {
    let model = build(MeshSpec::hull("m", &corners()));
    let p = &model.params;
    assert!((p.body_mass[1] - 6.0).abs() < 1e-12);
    let mesh = &model.meshes[model.mesh("m").unwrap()];
    for (placed, written) in mesh.vertices.iter().zip(corners()) {
        let back = (p.geom_pos[0] + p.geom_quat[0].rotate(*placed)).to_array();
        let error = (back.iter().zip(written)).map(|(a, b)| (a - b).abs());
        assert!(error.fold(0.0, f64::max) < 1e-12);
    }
    // m (b² + c²) / 12, the largest first.
    let moments = p.body_inertia[1].to_array();
    for (found, expected) in moments.iter().zip([6.5, 5.0, 2.5]) {
        assert!((found - expected).abs() < 1e-12, "{moments:?}");
    }
    assert_eq!(model.geoms[0].mesh, Some(0));
    let hull = mesh.hull.as_ref().unwrap();
    assert!(hull.radius() <= p.geom_rbound[0] * (1.0 + 1e-12));
}

#[test]
fn inertia_modes_differ_for_a_concave_mesh() {
    let mass = |inertia| {
        build(MeshSpec {
            inertia,
            ..hourglass()
        })
        .params
        .body_mass[1]
    };
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a}, not {b}");
    // Two tetrahedra of base 2 and height 1.
    near(mass(MeshInertia::Exact), 4.0 / 3.0);
    near(mass(MeshInertia::Convex), 4.0);
    // The centroid is outside both halves, so pyramids that should be subtracted are added.
    assert!(mass(MeshInertia::Legacy) > 4.0 / 3.0 + 0.01);
    let area = mass(MeshInertia::Shell);
    let sides = 2.0 * (2.0 + 2.0 * 1.5f64.sqrt() + 2f64.sqrt());
    near(area, sides);
}

#[test]
fn principal_axes_rotate_only_beyond_the_precision_of_vertices() {
    let centered: Vec<[f64; 3]> = (corners().into_iter())
        .map(|[x, y, z]| [2.0 * x - 1.0, y - 1.0, z - 1.5])
        .collect();
    // The box has half sides 1, 1 + part and 1.5; `part` is a relative difference.
    let frame = |part: f64| {
        let mesh = MeshSpec::hull("m", &centered).scaled([1.0, 1.0 + part, 1.0]);
        build(mesh).params.geom_quat[0]
    };
    // The moments about y and x are 1 + 1.5² and 1 + 2 part + 1.5²: the first is larger if part is negative.
    let (unknown, known) = (1.5e-7, 1.8e-7);
    assert_eq!(frame(-unknown), clench_math::Quat::IDENTITY);
    assert_ne!(frame(-known), clench_math::Quat::IDENTITY);
}

#[test]
fn errors_name_the_invalid_element() {
    let refused = |builder: ModelBuilder| builder.build().unwrap_err().to_string();
    let mut flat = corners();
    flat.iter_mut().for_each(|corner| corner[2] = 0.0);
    let error = refused(with_mesh(MeshSpec::hull("m", &flat), GeomSpec::mesh("m")));
    assert!(
        error.contains("mesh \"m\"") && error.contains("plane"),
        "{error}"
    );
    let inwards: Vec<[u32; 3]> = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let tetrahedron = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let outwards = MeshSpec::triangles("m", &tetrahedron, &inwards);
    assert!(with_mesh(outwards, GeomSpec::mesh("m")).build().is_ok());
    let inwards: Vec<[u32; 3]> = inwards.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let error = refused(with_mesh(
        MeshSpec::triangles("m", &tetrahedron, &inwards),
        GeomSpec::mesh("m"),
    ));
    assert!(error.contains("negative"), "{error}");
    let unknown = with_mesh(MeshSpec::hull("m", &corners()), GeomSpec::mesh("n"));
    assert!(refused(unknown).contains("there is no mesh \"n\""));
    let mut twice = with_mesh(MeshSpec::hull("m", &corners()), GeomSpec::mesh("m"));
    twice.meshes.push(MeshSpec::hull("m", &corners()));
    assert!(refused(twice).contains("already in use"));
    let mut bad = MeshSpec::hull("m", &corners());
    bad.vertices[3].x = f64::NAN;
    assert!(refused(with_mesh(bad, GeomSpec::mesh("m"))).contains("vertex 3"));
    let mut vast = with_mesh(MeshSpec::hull("m", &corners()), GeomSpec::mesh("m"));
    vast.bodies[0].geoms.push(GeomSpec::cuboid([1e160; 3]));
    assert!(refused(vast).contains("bounding radius must be finite"));
}

fn terrain() -> ModelBuilder {
    let mut builder = ModelBuilder::new("terrain");
    builder.height_fields.push(HeightFieldSpec {
        name: "hills".to_owned(),
        rows: 2,
        columns: 3,
        heights: vec![1.0, 2.0, 3.0, 4.0, 5.0, 9.0],
        size: [1.0, 2.0, 0.5, 0.1],
        origin: None,
    });
    builder.add_ground(GeomSpec::height_field("hills"));
    builder
}

#[test]
fn a_height_field_keeps_its_shape() {
    let model = terrain().build().unwrap();
    let shape = &model.height_fields[model.geoms[0].height_field.unwrap()].shape;
    assert_eq!(shape.point(0, 0).to_array(), [-1.0, -2.0, 0.0]);
    assert_eq!(shape.point(1, 2).to_array(), [1.0, 2.0, 0.5]);
    assert_eq!(model.geoms[0].kind, ShapeKind::HeightField);
    let mut bad = terrain();
    bad.height_fields[0].heights.pop();
    assert!(bad.build().unwrap_err().to_string().contains("hills"));
}

#[test]
fn sizes_of_assets_are_the_same_in_every_environment() {
    let mut builder = with_mesh(MeshSpec::hull("m", &corners()), GeomSpec::mesh("m"));
    let seen = builder.bodies[1].geoms.pop().map(|geom| GeomSpec {
        contype: 0,
        conaffinity: 0,
        ..geom
    });
    builder.bodies[1].geoms.extend(seen);
    builder.add_ground(GeomSpec::sphere(0.1));
    let mut sim = Sim::<f64>::new(Arc::new(builder.build().unwrap())).unwrap();
    let sizes = sim.model().params.geom_size.clone();
    let radii = sim.model().params.geom_rbound.clone();
    let mut row: Vec<f64> = sizes.iter().flat_map(|size| size.to_array()).collect();
    row[0] = 0.2;
    sim.set_param("geom_size", &row).expect("a sphere may grow");
    row[4] *= 2.0;
    let error = sim.set_param("geom_size", &row).unwrap_err().to_string();
    assert!(error.contains("mesh or height field"), "{error}");
    assert_eq!(radii[1], sizes[1].norm());
}

/// Models share meshes while one of them exists; a mesh that differs in any number is another.
#[test]
fn models_share_equal_meshes() {
    let mesh = |x: f64| MeshSpec::hull("shared", &corners()).scaled([x, 1.0, 1.0]);
    let [model, same, other] = [0.25, 0.25, 0.5].map(|x| build(mesh(x)));
    assert!(Arc::ptr_eq(&model.meshes[0], &same.meshes[0]));
    assert!(!Arc::ptr_eq(&model.meshes[0], &other.meshes[0]));
    assert_ne!(model.meshes[0].measure, other.meshes[0].measure);

    // Without a colliding geom the mesh has no hull.
    let mut unused = ModelBuilder::new("mesh");
    unused.meshes.push(mesh(0.25));
    let unused = unused.build().expect("the mesh is valid");
    assert!(unused.meshes[0].hull.is_none());
    assert!(!Arc::ptr_eq(&model.meshes[0], &unused.meshes[0]));
}
