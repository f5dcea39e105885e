//! Budgets of models: a step that would exceed one is a fault with its own text, and allocates nothing for it.

use clench_rigid::builder::{BodySpec, BuildError, GeomSpec, JointSpec, ModelBuilder};
use clench_rigid::{Batch, Budget, Fault, Model, Sim, SimError};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Builds free balls, each `spacing` metres from the next.
fn balls(count: usize, spacing: f64, budget: Budget) -> Result<Arc<Model>, BuildError> {
    let mut builder = ModelBuilder::new("balls");
    builder.budget = budget;
    for i in 0..count {
        let ball = BodySpec::new(format!("ball{i}"))
            .at([spacing * i as f64, 0.0, 0.0])
            .joint(JointSpec::free(""))
            .geom(GeomSpec::sphere(0.1));
        builder.add_body(ModelBuilder::WORLD, ball);
    }
    builder.build().map(Arc::new)
}

/// Returns the fault of a step of `count` balls in one place.
#[track_caller]
fn fault(count: usize, budget: Budget) -> String {
    let mut sim = Sim::<f64>::new(balls(count, 0.0, budget).unwrap()).unwrap();
    sim.state.qvel[0] = 1.0;
    let before = sim.state.qpos.clone();
    let error = sim.step().unwrap_err();
    assert!(
        matches!(error, SimError::Fault(Fault::OverBudget { .. })),
        "{error}"
    );
    assert_eq!(sim.state.qpos, before);
    error.to_string()
}

#[test]
fn a_step_of_too_many_contacts_is_a_fault() {
    let few = Budget {
        contacts: 1000,
        ..Budget::default()
    };
    let text = fault(60, few);
    assert!(text.contains("more than 1000 contacts; "), "{text}");
    assert!(text.contains("larger budget"), "{text}");
    // Many geoms are not compared pair by pair.
    let text = fault(150, few);
    assert!(text.contains("more than 4000 pairs of geoms"), "{text}");
}

#[test]
fn a_step_of_too_large_a_matrix_is_a_fault() {
    // 1770 contacts of 3 rows over 12 dofs each, and 360 coupled dofs.
    let (jacobian, factor) = (1770 * 36, 360 * 361 / 2);
    let of = |matrix: u64| Budget {
        matrix,
        ..Budget::default()
    };
    let text = fault(60, of(jacobian - 1));
    assert!(text.contains("numbers in the Jacobian"), "{text}");
    let text = fault(60, of(factor - 1));
    assert!(text.contains("numbers in the factor"), "{text}");
    let mut sim = Sim::<f64>::new(balls(60, 0.0, of(factor)).unwrap()).unwrap();
    sim.step().unwrap();
}

#[test]
fn balls_that_touch_nothing_need_little() {
    let small = Budget {
        contacts: 0,
        matrix: 60 * 21,
        ..Budget::default()
    };
    let mut sim = Sim::<f64>::new(balls(60, 1.0, small).unwrap()).unwrap();
    sim.step().unwrap();
    let less = Budget {
        matrix: 60 * 21 - 1,
        ..small
    };
    let error = balls(60, 1.0, less).unwrap_err();
    assert!(error.to_string().contains("mass matrix"), "{error}");
}

#[test]
fn an_environment_over_budget_disturbs_no_other() {
    for count in [40, 140] {
        let budget = Budget {
            contacts: 100,
            ..Budget::default()
        };
        let model = balls(count, 1.0, budget).unwrap();
        let mut batch = Batch::<f64>::new(model.clone(), 9).unwrap();
        let mut sim = Sim::<f64>::new(model).unwrap();
        // All balls of one environment are in one place.
        for ball in 0..count {
            batch.state.qpos.row_mut(4)[7 * ball] = 0.0;
        }
        batch.step_n(3).unwrap();
        for _ in 0..3 {
            sim.step().unwrap();
        }
        for env in 0..9 {
            let status = format!("{:?}", batch.status(env));
            if env == 4 {
                assert!(status.contains("OverBudget"), "{status}");
            } else {
                assert_eq!(status, "Running");
                assert_eq!(batch.state.qpos.row(env), &sim.state.qpos[..]);
            }
        }
    }
}

#[test]
fn fixed_geoms_may_be_in_one_place_however_many() {
    let mut builder = ModelBuilder::new("crowd");
    for _ in 0..60_000 {
        builder.add_ground(GeomSpec::sphere(0.1));
    }
    let ball = BodySpec::new("ball")
        .at([0.0, 0.0, 5.0])
        .joint(JointSpec::free(""))
        .geom(GeomSpec::sphere(0.1));
    builder.add_body(ModelBuilder::WORLD, ball);
    let mut sim = Sim::<f64>::new(Arc::new(builder.build().unwrap())).unwrap();
    let start = Instant::now();
    for _ in 0..3 {
        sim.step().unwrap();
    }
    assert!(start.elapsed() < Duration::from_secs(10));
}

#[test]
fn memory_of_a_large_model_grows_linearly() {
    let start = Instant::now();
    let model = balls(20_000, 1.0, Budget::default()).unwrap();
    let mut sim = Sim::<f64>::new(model).unwrap();
    sim.step().unwrap();
    assert!(start.elapsed() < Duration::from_secs(20));
}
