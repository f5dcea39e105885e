//! Yielding springs: their maximum force, their rest position afterwards, and their state.

use crate::common::{model, sim};
use crate::machines::world;
use clench_math::Quat;
use clench_rigid::builder::{
    BodySpec, GeomSpec, JointSpec, KeyframeSpec, ModelBuilder, TendonSpec,
};
use clench_rigid::model::{Integrator, JointKind};
use clench_rigid::{Sim, State};

const INTEGRATORS: [Integrator; 4] = [
    Integrator::Euler,
    Integrator::Implicit,
    Integrator::ImplicitFast,
    Integrator::Rk4,
];

/// Builds a bob of 1 kg on a slide whose spring of 10 N/m yields at 0.2 m.
fn bob(integrator: Integrator) -> ModelBuilder {
    let mut b = world("bob");
    b.physics.gravity = [0.0; 3];
    b.physics.integrator = integrator;
    let mut joint = JointSpec::slide("bob", [1.0, 0.0, 0.0]);
    joint.stiffness = [10.0, 0.0, 0.0];
    joint.springyield = 0.2;
    joint.springref = 0.1;
    b.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("bob")
            .joint(joint)
            .geom(GeomSpec::sphere(0.1).mass(1.0)),
    );
    b
}

#[test]
fn a_spring_pulls_no_harder_than_its_yield_lets_it() {
    for integrator in INTEGRATORS {
        let mut sim = sim(&bob(integrator));
        assert_eq!(sim.state.plastic, [0.1]);
        sim.state.qvel[0] = 2.0;
        let mut start = sim.state.plastic[0];
        for _ in 0..700 {
            sim.step().unwrap();
            let rest = sim.state.plastic[0];
            assert!(rest >= start, "it is stretched to one side only");
            start = rest;
            sim.forward().unwrap();
            let force = sim.output("qfrc_passive").unwrap()[0];
            assert!(force.abs() < 2.0 + 1e-9, "{integrator:?}: {force}");
        }
        // A force of 2 N would stop it 2/2 = 1 m beyond the yield at 0.3 m, less the work of the spring before.
        assert!((1.0..1.2).contains(&start), "{integrator:?}: {start}");
    }
}

#[test]
fn springs_below_the_yield_are_elastic() {
    let mut yielding = sim(&bob(Integrator::Euler));
    let mut elastic = bob(Integrator::Euler);
    elastic.bodies[1].joints[0].springyield = 0.0;
    let mut elastic = sim(&elastic);
    assert!(elastic.state.plastic.is_empty());
    for _ in 0..500 {
        yielding.step().unwrap();
        elastic.step().unwrap();
        assert_eq!(yielding.state.qpos, elastic.state.qpos);
    }
    assert_eq!(yielding.state.plastic, [0.1]);
}

#[test]
fn plastic_rest_lengths_are_state() {
    let mut sim = sim(&bob(Integrator::Euler));
    sim.state.plastic[0] = 0.35;
    sim.state.qpos[0] = 0.25;
    sim.forward().unwrap();
    let force = sim.output("qfrc_passive").unwrap()[0];
    assert!((force - 1.0).abs() < 1e-12, "{force}");
    let energy = sim.energy().unwrap().potential;
    assert!((energy - 0.5 * 10.0 * 0.1 * 0.1).abs() < 1e-12, "{energy}");
    sim.reset();
    assert_eq!(sim.state.plastic, [0.1]);
}

/// A ball joint springs back only by the part of its rotation within the yield.
#[test]
fn a_ball_joint_rests_at_an_orientation() {
    let mut b = world("ball");
    b.physics.gravity = [0.0; 3];
    let mut joint = JointSpec::ball("ball");
    joint.stiffness = [1.0, 0.0, 0.0];
    joint.springyield = 0.3;
    b.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("ball")
            .joint(joint)
            .geom(GeomSpec::sphere(0.1).mass(1.0)),
    );
    let mut sim = sim(&b);
    assert_eq!(sim.state.plastic, [1.0, 0.0, 0.0, 0.0]);
    let turned = Quat::new(0.8, 0.0, 0.6, 0.0);
    turned.write(&mut sim.state.qpos);
    sim.step().unwrap();
    let (at, rest) = (
        Quat::from_slice(&sim.state.qpos),
        Quat::from_slice(&sim.state.plastic),
    );
    let left = at.difference(rest);
    assert!((left.norm() - 0.3).abs() < 1e-12, "{left:?}");
    assert!(left.y > 0.0 && left.x == 0.0 && left.z == 0.0, "{left:?}");
}

/// The dead band moves as a whole, until the tendon exceeds it by the yield.
#[test]
fn the_dead_band_of_a_tendon_follows() {
    for integrator in INTEGRATORS {
        let mut b = bob(integrator);
        b.bodies[1].joints[0].springyield = 0.0;
        let mut tendon = TendonSpec::fixed("band", &[("bob", 2.0)]);
        tendon.springlength = Some([0.1, 0.3]);
        tendon.springyield = 0.2;
        b.tendons.push(tendon);
        let mut sim = sim(&b);
        assert_eq!(sim.state.plastic, [0.1, 0.3]);
        sim.state.qpos[0] = -0.4;
        sim.step().unwrap();
        let (length, low) = (2.0 * sim.state.qpos[0], sim.state.plastic[0]);
        assert!((low - 0.2 - length).abs() < 1e-12, "{integrator:?}");
        assert!((sim.state.plastic[1] - low - 0.2).abs() < 1e-12);
    }
}

#[test]
fn springs_that_are_off_do_not_yield() {
    let mut b = bob(Integrator::Euler);
    b.physics.flags.spring = false;
    let mut sim = sim(&b);
    sim.state.qpos[0] = 5.0;
    sim.step().unwrap();
    assert_eq!(sim.state.plastic, [0.1]);
}

#[test]
fn keyframes_store_plastic_states() {
    let mut b = bob(Integrator::Euler);
    let key = |plastic: Option<Vec<f64>>| KeyframeSpec {
        plastic,
        ..KeyframeSpec::default()
    };
    b.keyframes = vec![key(Some(vec![0.7])), key(None)];
    let built = model(&b);
    let mut state = State::<f64>::new(&built);
    for (index, rest) in [0.7, 0.1].into_iter().enumerate() {
        state.set_keyframe(&built, &built.keyframes[index]);
        assert_eq!(state.plastic, [rest]);
    }
    b.keyframes = vec![key(Some(vec![0.7, 0.8]))];
    let error = b.build().unwrap_err().to_string();
    assert!(error.contains("plastic has 2 numbers"), "{error}");
}

#[test]
fn a_free_joint_has_no_spring_that_yields() {
    let mut b = world("free");
    let joint = JointSpec {
        kind: JointKind::Free,
        springyield: 0.1,
        ..JointSpec::default()
    };
    b.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("free")
            .joint(joint)
            .geom(GeomSpec::sphere(0.1).mass(1.0)),
    );
    assert!(b.build().unwrap_err().to_string().contains("springyield"));
    let mut b = bob(Integrator::Euler);
    b.bodies[1].joints[0].springyield = -0.1;
    assert!(b.build().unwrap_err().to_string().contains("springyield"));
}

#[test]
fn an_existing_yield_can_be_changed() {
    let mut sim: Sim = sim(&bob(Integrator::Euler));
    sim.set_param("jnt_springyield", &[0.0]).unwrap();
    sim.state.qpos[0] = 5.0;
    sim.step().unwrap();
    assert_eq!(sim.state.plastic, [0.1], "0 is no yield at all");
    let mut elastic = bob(Integrator::Euler);
    elastic.bodies[1].joints[0].springyield = 0.0;
    let mut elastic = crate::common::sim(&elastic);
    elastic.set_param("jnt_springyield", &[0.2]).unwrap_err();
}
