//! The trial of a loaded model: nothing may panic, and every result must be finite.

use clench::math::Vec3;
use clench::{Budget, Model, RayFilter, SaveModel, Sim};
use std::sync::Arc;

/// Returns the budget of a model: small, since a fuzzer steps thousands of models a second.
pub fn budget() -> Budget {
    Budget::default().times(1.0 / 256.0)
}

/// The error of a model whose mass matrix is singular up to rounding.
const SINGULAR: &str = "the mass matrix is not positive definite";

/// The number of steps of a trial.
const STEPS: usize = 3;

/// Saves a model, steps it, and queries it.
pub fn run(model: Model) {
    // A model that MJCF cannot express is an error; a saved model is readable within the default budget.
    if let Ok(text) = model.to_mjcf() {
        match clench::load_str_within(&text, Budget::default()) {
            Ok(again) => assert_eq!(
                (again.nq, again.nv, again.nu()),
                (model.nq, model.nv, model.nu())
            ),
            // If inertias differ by more than the precision, rounding decides it, and saved orientations are rounded.
            Err(error) => assert!(
                error.message.contains(SINGULAR),
                "a saved model is refused: {error}"
            ),
        }
    }
    let Ok(mut sim) = Sim::<f64>::new(Arc::new(model)) else {
        return;
    };
    for _ in 0..STEPS {
        if sim.step().is_err() {
            break;
        }
        check_result(&sim);
    }
    if sim.forward().is_err() {
        return;
    }
    let _ = sim.ray(
        Vec3::new(0.1, 0.2, 5.0),
        Vec3::new(0.0, 0.1, -1.0),
        &RayFilter::default(),
    );
    if let Some(last) = sim.model().geoms.len().checked_sub(1) {
        let _ = sim.distance(0, last, f64::INFINITY);
    }
    let _ = sim.energy();
}

/// Checks that a step or forward pass without an error left finite results.
pub fn check_result(sim: &Sim<f64>) {
    let finite = |values: &[f64]| values.iter().all(|x| x.is_finite());
    assert!(finite(&sim.state.qpos) && finite(&sim.state.qvel) && finite(&sim.state.act));
    assert!(finite(&sim.workspace().qacc) && finite(&sim.workspace().qfrc_constraint));
}

/// Returns a model with every kind of state.
pub fn machine() -> Arc<Model> {
    let text = include_str!("../seeds/mjcf/machine.xml");
    Arc::new(clench::load_str(text).expect("our own model"))
}
