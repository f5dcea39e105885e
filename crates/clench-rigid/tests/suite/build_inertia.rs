//! Masses and inertias that the builder derives from shapes, against the integrals that define them.

use clench_math::{Mat3, Quat, Vec3};
use clench_rigid::Model;
use clench_rigid::builder::{BodySpec, GeomSpec, InertiaFromGeom, JointSpec, ModelBuilder};
use std::f64::consts::PI;

/// Computes ∫ f over [a, b] by Gauss–Legendre on many pieces, exact to rounding for these smooth functions.
fn integrate(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    const NODES: [f64; 3] = [
        0.238_619_186_083_196_9,
        0.661_209_386_466_264_5,
        0.932_469_514_203_152,
    ];
    const WEIGHTS: [f64; 3] = [
        0.467_913_934_572_691,
        0.360_761_573_048_138_6,
        0.171_324_492_379_170_35,
    ];
    let pieces = 200;
    let half = 0.5 * (b - a) / f64::from(pieces);
    (0..pieces)
        .map(|i| {
            let middle = a + half * f64::from(2 * i + 1);
            let pair = |k: usize| f(middle - half * NODES[k]) + f(middle + half * NODES[k]);
            half * (0..3).map(|k| WEIGHTS[k] * pair(k)).sum::<f64>()
        })
        .sum()
}

/// Computes volume and moments (across, along the axis) at density 1 of a solid of revolution with radius r(z), for z
/// from 0 to `top`, and its mirror image.
fn solid_of_revolution(top: &[f64], r: impl Fn(f64) -> f64) -> [f64; 3] {
    let both = |f: &dyn Fn(f64) -> f64| {
        2.0 * top
            .windows(2)
            .map(|w| integrate(w[0], w[1], f))
            .sum::<f64>()
    };
    let area = |z: f64| PI * r(z).powi(2);
    [
        both(&area),
        both(&|z| area(z) * (r(z).powi(2) / 4.0 + z * z)),
        both(&|z| area(z) * r(z).powi(2) / 2.0),
    ]
}

/// A piece of a surface's profile: (r, z, |d(r, z)/dt|) for t in [0, 1], and its mirror image.
type Profile<'a> = &'a dyn Fn(f64) -> (f64, f64, f64);
fn surface_of_revolution(pieces: &[Profile]) -> [f64; 3] {
    let both = |weight: &dyn Fn(f64, f64) -> f64| {
        let piece = |p: &Profile| {
            2.0 * integrate(0.0, 1.0, |t| {
                let (r, z, speed) = p(t);
                2.0 * PI * r * speed * weight(r, z)
            })
        };
        pieces.iter().map(piece).sum::<f64>()
    };
    [
        both(&|_, _| 1.0),
        both(&|r, z| r * r / 2.0 + z * z),
        both(&|r, _| r * r),
    ]
}

fn one_geom(geom: GeomSpec) -> Model {
    let mut builder = ModelBuilder::new("one geom");
    builder.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("body")
            .joint(JointSpec::free("free"))
            .geom(geom),
    );
    builder.build().unwrap()
}

fn assert_close(actual: f64, expected: f64, what: &str) {
    let error = (actual - expected).abs() / expected.abs();
    assert!(error < 1e-12, "{what}: {actual} instead of {expected}");
}

fn assert_axial(geom: GeomSpec, [measure, across, along]: [f64; 3]) {
    let kind = geom.kind;
    let model = one_geom(geom.density(700.0));
    let inertia = model.params.body_inertia[1];
    assert_close(
        model.params.body_mass[1],
        700.0 * measure,
        &format!("mass of {kind:?}"),
    );
    assert_close(
        inertia.x,
        700.0 * across,
        &format!("inertia across {kind:?}"),
    );
    assert_close(
        inertia.y,
        700.0 * across,
        &format!("inertia across {kind:?}"),
    );
    assert_close(inertia.z, 700.0 * along, &format!("inertia along {kind:?}"));
}

#[test]
fn solids_of_revolution_match_their_integrals() {
    let (r, h) = (0.13, 0.31);
    let dome = |z: f64| (r * r - z * z).max(0.0).sqrt();
    assert_axial(GeomSpec::sphere(r), solid_of_revolution(&[0.0, r], dome));
    assert_axial(
        GeomSpec::cylinder(r, h),
        solid_of_revolution(&[0.0, h], |_| r),
    );
    let capsule = |z: f64| if z <= h { r } else { dome(z - h) };
    assert_axial(
        GeomSpec::capsule(r, h),
        solid_of_revolution(&[0.0, h, h + r], capsule),
    );
    let spheroid = |z: f64| r * (1.0 - (z / h).powi(2)).max(0.0).sqrt();
    assert_axial(
        GeomSpec::ellipsoid([r, r, h]),
        solid_of_revolution(&[0.0, h], spheroid),
    );
}

#[test]
fn shells_of_revolution_match_their_integrals() {
    let (r, h) = (0.13, 0.31);
    let quarter = |from: f64| {
        move |t: f64| {
            let angle = t * PI / 2.0;
            (r * angle.cos(), from + r * angle.sin(), r * PI / 2.0)
        }
    };
    let side = |t: f64| (r, t * h, h);
    let lid = |t: f64| (t * r, h, r);
    let shell = |geom: GeomSpec| GeomSpec {
        shellinertia: true,
        ..geom
    };
    assert_axial(
        shell(GeomSpec::sphere(r)),
        surface_of_revolution(&[&quarter(0.0)]),
    );
    assert_axial(
        shell(GeomSpec::capsule(r, h)),
        surface_of_revolution(&[&side, &quarter(h)]),
    );
    assert_axial(
        shell(GeomSpec::cylinder(r, h)),
        surface_of_revolution(&[&side, &lid]),
    );
}

#[test]
fn a_box_shell_is_the_difference_of_two_boxes() {
    let half = [0.2, 0.3, 0.5];
    let solid = |grow: f64| {
        let [x, y, z] = half.map(|a| a + grow);
        let volume = 8.0 * x * y * z;
        [
            volume,
            volume * (y * y + z * z) / 3.0,
            volume * (z * z + x * x) / 3.0,
            volume * (x * x + y * y) / 3.0,
        ]
    };
    // The derivative with respect to growth, by extrapolated central differences of a quintic.
    let step = 1e-4;
    let slope: Vec<f64> = (0..4)
        .map(|i| {
            let difference = |s: f64| (solid(s)[i] - solid(-s)[i]) / (2.0 * s);
            (4.0 * difference(step) - difference(2.0 * step)) / 3.0
        })
        .collect();
    let model = one_geom(GeomSpec {
        shellinertia: true,
        ..GeomSpec::cuboid(half).density(3.0)
    });
    let p = &model.params;
    let actual = [
        p.body_mass[1],
        p.body_inertia[1].x,
        p.body_inertia[1].y,
        p.body_inertia[1].z,
    ];
    for (actual, slope) in actual.iter().zip(slope) {
        assert!(
            (actual - 3.0 * slope).abs() < 1e-10 * actual,
            "{actual} instead of {}",
            3.0 * slope
        );
    }
}

#[test]
fn an_ellipsoid_is_a_stretched_sphere() {
    let [a, b, c] = [0.2, 0.3, 0.5];
    let p = one_geom(GeomSpec::ellipsoid([a, b, c]).mass(2.0)).params;
    // A ball of radius 1 has second moments of 1/5 per mass; stretching scales each by a semi-axis squared.
    let second =
        [a, b, c].map(|s| integrate(-1.0, 1.0, |x| 0.75 * (1.0 - x * x) * x * x) * s * s * 2.0);
    assert_close(p.body_inertia[1].x, second[1] + second[2], "about x");
    assert_close(p.body_inertia[1].y, second[0] + second[2], "about y");
    assert_close(p.body_inertia[1].z, second[0] + second[1], "about z");
}

/// Returns the inertia of body 1 about its origin, in its frame.
fn inertia_about_origin(model: &Model) -> Mat3<f64> {
    let p = &model.params;
    let axes = p.body_iquat[1].to_matrix();
    let about_centre = axes * Mat3::diagonal(p.body_inertia[1]) * axes.transpose();
    let (c, m) = (p.body_ipos[1], p.body_mass[1]);
    let mut total = about_centre;
    for i in 0..3 {
        for j in 0..3 {
            let square = if i == j { c.norm_squared() } else { 0.0 };
            total.rows[i][j] += m * (square - c[i] * c[j]);
        }
    }
    total
}

#[test]
fn parts_weigh_as_much_as_the_whole() {
    let (half, turn) = ([0.2, 0.3, 0.5], [0.5, 0.1, -0.7, 0.2]);
    let centre = Vec3::new(0.3, -0.2, 0.6);
    let quat = Quat::from_f64(turn).normalize();
    let whole = one_geom(GeomSpec::cuboid(half).at(centre.to_array()).turned(turn));

    // A cut at x = 0.05 gives parts 0.25 and 0.15 long.
    let part = |from: f64, to: f64| {
        let middle = centre + quat.rotate(Vec3::new(0.5 * (from + to), 0.0, 0.0));
        GeomSpec::cuboid([0.5 * (to - from), half[1], half[2]])
            .at(middle.to_array())
            .turned(turn)
    };
    let mut builder = ModelBuilder::new("cut");
    builder.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("box")
            .joint(JointSpec::free("f"))
            .geom(part(-0.2, 0.05))
            .geom(part(0.05, 0.2)),
    );
    let cut = builder.build().unwrap();

    assert_close(cut.params.body_mass[1], whole.params.body_mass[1], "mass");
    assert!((cut.params.body_ipos[1] - whole.params.body_ipos[1]).norm() < 1e-14);
    let (a, b) = (inertia_about_origin(&cut), inertia_about_origin(&whole));
    for i in 0..3 {
        assert!(
            (a.rows[i] - b.rows[i]).norm() < 1e-11,
            "{a:?} instead of {b:?}"
        );
    }
    // The principal moments come largest first, for any order of the whole box's.
    let moments = cut.params.body_inertia[1];
    assert!(moments.x >= moments.y && moments.y >= moments.z);
}

#[test]
fn compiler_settings_of_inertia_apply() {
    let described = |set: &dyn Fn(&mut ModelBuilder)| {
        let mut builder = ModelBuilder::new("settings");
        let body =
            BodySpec::new("a")
                .at([1.0, 2.0, 3.0])
                .inertial(4.0, [0.1, 0.0, 0.0], [1.0, 2.0, 2.5]);
        let geoms = body.geom(GeomSpec::sphere(0.1).mass(2.0)).geom(GeomSpec {
            group: 3,
            ..GeomSpec::sphere(0.1).mass(5.0)
        });
        builder.add_body(ModelBuilder::WORLD, geoms.joint(JointSpec::free("f")));
        set(&mut builder);
        builder.build()
    };
    let mass = |set: &dyn Fn(&mut ModelBuilder)| described(set).unwrap().params.body_mass[1];
    assert_eq!(mass(&|_| ()), 4.0);
    assert_eq!(
        mass(&|b| b.compiler.inertiafromgeom = InertiaFromGeom::Always),
        7.0
    );
    assert_eq!(
        mass(&|b| {
            b.compiler.inertiafromgeom = InertiaFromGeom::Always;
            b.compiler.inertiagrouprange = [0, 2];
        }),
        2.0
    );
    assert_eq!(mass(&|b| b.compiler.boundmass = 6.0), 6.0);
    let scaled = described(&|b| b.compiler.settotalmass = Some(8.0))
        .unwrap()
        .params;
    assert_eq!(scaled.body_mass[1], 8.0);
    assert_eq!(scaled.body_inertia[1].to_array(), [2.0, 4.0, 5.0]);
    let impossible = |b: &mut ModelBuilder| {
        b.bodies[1] = b.bodies[1].clone().inertial(4.0, [0.0; 3], [1.0, 1.0, 2.5]);
    };
    let error = described(&|b| impossible(b)).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("body \"a\": no body has the principal moments"),
        "{error}"
    );
    let balanced = described(&|b| {
        impossible(b);
        b.compiler.balanceinertia = true;
    });
    assert_eq!(
        balanced.unwrap().params.body_inertia[1].to_array(),
        [1.5; 3]
    );
}
