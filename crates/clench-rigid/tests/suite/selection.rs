//! Selection of geoms that may collide: order and parameters.

use crate::scenes::{add, free, geom, joint, model, plane, sphere, world};
use clench_collide::ShapeKind;
use clench_math::{Lanes, Real};
use clench_rigid::Model;
use clench_rigid::builder::{ContactOverride, ExcludeSpec, GeomSpec, ModelBuilder, PairSpec};
use clench_rigid::contact::{Candidate, candidates, contact_params, contact_range};
use clench_rigid::model::JointKind;

fn named(name: &str) -> GeomSpec {
    GeomSpec {
        name: name.into(),
        ..sphere(0.1)
    }
}

fn hinge() -> Vec<clench_rigid::builder::JointSpec> {
    vec![joint(JointKind::Hinge, "", [0.0, 1.0, 0.0])]
}

/// Returns the names of the candidates' geoms.
fn pairs(builder: &ModelBuilder) -> Vec<String> {
    let model = model(builder);
    let name = |g: u32| model.geoms[g as usize].name.clone();
    let label = |c: &Candidate| format!("{}-{}", name(c.geoms[0]), name(c.geoms[1]));
    candidates(&model).iter().map(label).collect()
}

/// Builds the bodies floor; a (free) > b (hinge) > c (welded to b) > d (hinge); e (free); m (mocap) > n (fixed to it).
fn family() -> ModelBuilder {
    let mut b = world();
    b.bodies[0].geoms.push(named("floor"));
    let a = add(&mut b, 0, "a", [0.0; 3], free(), vec![named("a")]);
    let child = add(&mut b, a, "b", [0.0; 3], hinge(), vec![named("b")]);
    let welded = add(&mut b, child, "c", [0.0; 3], vec![], vec![named("c")]);
    add(&mut b, welded, "d", [0.0; 3], hinge(), vec![named("d")]);
    add(&mut b, 0, "e", [0.0; 3], free(), vec![named("e")]);
    let m = add(&mut b, 0, "m", [0.0; 3], vec![], vec![named("m")]);
    b.bodies[m].mocap = true;
    add(&mut b, m, "n", [0.0; 3], vec![], vec![named("n")]);
    b
}

#[test]
fn relatives_and_bodies_that_cannot_move_do_not_collide() {
    // As in MuJoCo 4.0.0: parents are determined after welding, the world is no parent, and the mocap body collides
    // with all moving bodies but not with the world.
    let expected = [
        "floor-a", "floor-b", "floor-c", "floor-d", "floor-e", "a-d", "a-e", "a-m", "a-n", "b-e",
        "b-m", "b-n", "c-e", "c-m", "c-n", "d-e", "d-m", "d-n", "e-m", "e-n",
    ];
    assert_eq!(pairs(&family()), expected);
}

#[test]
fn the_parent_filter_can_be_off() {
    let mut builder = family();
    builder.physics.flags.filterparent = false;
    let all = pairs(&builder);
    for pair in ["a-b", "a-c", "b-d", "c-d"] {
        assert!(all.contains(&pair.to_string()), "{pair}");
    }
    assert!(!all.contains(&"b-c".to_string()), "welded together");
}

#[test]
fn masks_and_excludes_take_pairs_out_and_explicit_pairs_bring_them_in() {
    let mut builder = family();
    builder.bodies[5].geoms[0].contype = 2;
    builder.bodies[5].geoms[0].conaffinity = 4;
    builder.bodies[6].geoms[0].conaffinity = 2;
    builder.excludes.push(ExcludeSpec {
        body1: "m".into(),
        body2: "a".into(),
        ..ExcludeSpec::default()
    });
    let pair = |geom1: &str, geom2: &str| PairSpec {
        geom1: geom1.into(),
        geom2: geom2.into(),
        ..PairSpec::default()
    };
    builder.pairs = vec![pair("m", "a"), pair("b", "a"), pair("d", "floor")];
    // As in MuJoCo 4.0.0.
    let expected = [
        "floor-a", "floor-b", "floor-c", "floor-d", "a-b", "a-d", "a-m", "a-n", "b-m", "b-n",
        "c-m", "c-n", "d-m", "d-n", "e-m",
    ];
    assert_eq!(pairs(&builder), expected);
}

#[test]
fn order_is_by_bodies_then_by_geoms_the_simpler_shape_first() {
    // As measured in MuJoCo 4.0.0.
    let mut b = world();
    let shapes = |order: [ShapeKind; 3], first: usize| {
        let numbered = |(i, kind)| GeomSpec {
            name: format!("{}", first + i),
            ..geom(kind, [0.1, 0.1, 0.1])
        };
        order
            .into_iter()
            .enumerate()
            .map(numbered)
            .collect::<Vec<_>>()
    };
    use ShapeKind::{Box, Capsule, Sphere};
    add(
        &mut b,
        0,
        "a",
        [0.0; 3],
        free(),
        shapes([Box, Sphere, Capsule], 0),
    );
    add(
        &mut b,
        0,
        "b",
        [0.0; 3],
        free(),
        shapes([Capsule, Sphere, Box], 3),
    );
    assert_eq!(
        pairs(&b),
        [
            "0-5", "1-3", "1-4", "1-5", "2-3", "2-5", "3-0", "4-0", "4-2"
        ]
    );
}

/// Returns the parameters of the only candidate of a floor and a ball.
fn mixed(edit: impl FnOnce(&mut GeomSpec, &mut GeomSpec)) -> (std::sync::Arc<Model>, Candidate) {
    let mut builder = world();
    let (mut floor, mut ball) = (plane(), sphere(0.1));
    edit(&mut floor, &mut ball);
    builder.bodies[0].geoms.push(floor);
    add(&mut builder, 0, "ball", [0.0; 3], free(), vec![ball]);
    let model = model(&builder);
    let candidate = candidates(&model)[0];
    (model, candidate)
}

#[test]
fn between_equals_friction_is_the_larger_and_softness_the_average() {
    let (model, pair) = mixed(|floor, ball| {
        floor.friction = [0.5, 0.02, 0.001];
        ball.friction = [0.7, 0.01, 0.002];
        (floor.condim, ball.condim) = (1, 4);
        (floor.solmix, ball.solmix) = (3.0, 1.0);
        (floor.solref, ball.solref) = ([0.02, 1.0], [0.06, 0.6]);
        (floor.solimp, ball.solimp) = ([0.8, 0.9, 0.001, 0.5, 2.0], [0.4, 0.5, 0.005, 0.1, 4.0]);
        (floor.margin, ball.margin, floor.gap, ball.gap) = (0.01, 0.02, 0.003, 0.004);
    });
    let p = contact_params(&model, &model.params, &pair);
    assert_eq!((p.dim, p.friction), (4, [0.7, 0.7, 0.02, 0.002, 0.002]));
    assert_eq!(p.solref, [0.75 * 0.02 + 0.25 * 0.06, 0.75 + 0.25 * 0.6]);
    assert_eq!(p.solimp[4], 2.5);
    assert_eq!(p.includemargin, 0.03);
    let (_, range): (f64, f64) = contact_range(&model, &model.params, &pair);
    assert!((range - 0.037).abs() < 1e-17, "margins and gaps add up");
}

#[test]
fn the_higher_priority_decides_but_not_about_margins() {
    let (model, pair) = mixed(|floor, ball| {
        floor.friction = [2.0, 0.02, 0.001];
        ball.friction = [0.1, 0.01, 0.002];
        (floor.condim, ball.condim) = (6, 3);
        ball.priority = 1;
        ball.solref = [-100.0, -5.0];
        (floor.margin, ball.margin) = (0.01, 0.02);
    });
    let p = contact_params(&model, &model.params, &pair);
    assert_eq!((p.dim, p.friction), (3, [0.1, 0.1, 0.01, 0.002, 0.002]));
    assert_eq!((p.solref, p.includemargin), ([-100.0, -5.0], 0.03));
}

#[test]
fn direct_solrefs_take_the_smaller_numbers_and_weights_may_vanish() {
    let (model, pair) = mixed(|floor, ball| {
        (floor.solref, ball.solref) = ([-100.0, -7.0], [0.02, 1.0]);
        (floor.solmix, ball.solmix) = (0.0, 2.0);
        ball.solimp = [0.5, 0.6, 0.001, 0.5, 2.0];
        (floor.friction, ball.friction) = ([0.0; 3], [0.0; 3]);
    });
    let p = contact_params(&model, &model.params, &pair);
    assert_eq!(p.solref, [-100.0, -7.0]);
    assert_eq!(p.solimp[..2], [0.5, 0.6], "all the weight is the ball's");
    assert_eq!(p.friction, [1e-5; 5], "friction has a floor");
    let (model, pair) = mixed(|floor, ball| {
        (floor.solmix, ball.solmix) = (0.0, 0.0);
        ball.solref = [0.04, 1.0];
    });
    assert_eq!(
        contact_params(&model, &model.params, &pair).solref,
        [0.03, 1.0]
    );
}

#[test]
fn the_override_replaces_all_but_condim_and_gap() {
    let mut builder = world();
    let contact = ContactOverride {
        margin: 0.05,
        solref: [0.1, 0.9],
        solimp: [0.1, 0.2, 0.3, 0.4, 5.0],
        friction: [0.9, 0.8, 0.7, 0.6, 0.5],
    };
    builder.physics.contact_override = Some(contact);
    let gap = |g: GeomSpec| GeomSpec {
        gap: 0.001,
        condim: 6,
        ..g
    };
    builder.bodies[0].geoms.push(gap(plane()));
    add(
        &mut builder,
        0,
        "ball",
        [0.0; 3],
        free(),
        vec![gap(sphere(0.1))],
    );
    let model = model(&builder);
    let pair = candidates(&model)[0];
    let p = contact_params(&model, &model.params, &pair);
    assert_eq!(
        (p.dim, p.friction, p.solref, p.solimp),
        (6, contact.friction, contact.solref, contact.solimp)
    );
    assert_eq!(p.solreffriction, contact.solref);
    let (margin, range): (f64, f64) = contact_range(&model, &model.params, &pair);
    assert_eq!((margin, range), (0.05, 0.05 + 0.002));
}

#[test]
fn lanes_mix_like_scalars() {
    type L = Lanes<f64, 4>;
    let (model, pair) = mixed(|floor, ball| {
        (floor.solref, ball.solref) = ([0.02, 1.0], [0.05, 0.5]);
        (floor.solmix, ball.solmix) = (1.0, 2.0);
    });
    let mut wide = model.params.broadcast::<L>();
    wide.geom_solref[0][0] = L::from_array([0.02, -50.0, 0.1, 0.02]);
    wide.geom_solmix[1] = L::from_array([2.0, 1.0, 0.0, 5.0]);
    let together = contact_params(&model, &wide, &pair);
    for lane in 0..4 {
        let mut alone = model.params.clone();
        alone.geom_solref[0][0] = wide.geom_solref[0][0].lane(lane);
        alone.geom_solmix[1] = wide.geom_solmix[1].lane(lane);
        let alone = contact_params(&model, &alone, &pair);
        for i in 0..2 {
            assert_eq!(
                together.solref[i].lane(lane).to_bits(),
                alone.solref[i].to_bits()
            );
        }
        assert_eq!(
            together.solimp[2].lane(lane).to_bits(),
            alone.solimp[2].to_bits()
        );
    }
}

#[test]
fn the_sweep_of_a_large_scene_finds_all_pairs() {
    // 60 moving balls in a heap, each in a larger visual-only ball. Far-away shapes trigger the sweep.
    let seen = || GeomSpec {
        contype: 0,
        conaffinity: 0,
        ..sphere(0.3)
    };
    let heap = |extra: i32| {
        let mut b = world();
        b.bodies[0].geoms.push(plane());
        for i in 0..60 {
            let (x, y, z) = (i % 5, i / 5 % 4, i / 20);
            let pos = [
                0.18 * f64::from(x),
                0.18 * f64::from(y),
                0.09 + 0.17 * f64::from(z),
            ];
            add(&mut b, 0, "", pos, free(), vec![sphere(0.1), seen()]);
        }
        for i in 0..extra {
            b.bodies[0].geoms.push(GeomSpec {
                pos: clench_math::Vec3::from_f64([100.0 + f64::from(i), 0.0, 50.0]),
                ..sphere(0.1)
            });
        }
        let mut sim = crate::scenes::sim(&b);
        sim.forward().expect("finite");
        let body = |g: usize| sim.model().geoms[g].body;
        let key = |c: &clench_rigid::contact::Contact<f64>| (c.geoms.map(body), c.dist.to_bits());
        sim.contacts().iter().map(key).collect::<Vec<_>>()
    };
    let (listed, swept) = (heap(0), heap(200));
    assert!(listed.len() > 100, "{}", listed.len());
    assert_eq!(listed, swept);
}
