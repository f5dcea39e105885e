//! Solvers and their statistics: conjugate gradients, the duality gap, and starting points that are proven to be good.

use crate::common::{self, Random, convert, general_batch, own, random_state, text, upload};
use clench_rigid::Sim;
use clench_rigid::model::Model;
use clench_solver::Status;
use std::sync::Arc;

/// Loads a test model with an additional attribute of `<option>`.
fn with_option(name: &str, option: &str) -> Arc<Model> {
    let text_of_model = own(name).replace("<option ", &format!("<option {option} "));
    assert!(text_of_model.contains(option), "{name} has no option");
    text(&text_of_model)
}

/// With tolerance 0 both iterate until rounding stops them; with a larger tolerance the results differ by as much as
/// that.
#[test]
fn conjugate_gradients_agree_with_the_processor() {
    for (name, spread) in [("runner", 1.0), ("medley", 0.4)] {
        let model = with_option(name, "solver=\"CG\" iterations=\"100\" tolerance=\"0\"");
        let Some(batch) = common::agree_within(1e-3, 0, &model, 20, spread) else {
            return;
        };
        let solves = batch.solves().expect("a device");
        let hard = solves.iter().filter(|s| s.iterations > 5).count();
        assert!(hard > 5, "{name}: {hard} solves are hard");
    }
}

#[test]
fn conjugate_gradients_agree_on_elliptic_cones() {
    let option = "solver=\"CG\" iterations=\"100\" tolerance=\"0\" cone=\"elliptic\"";
    common::agree_within(1e-3, 0, &with_option("medley", option), 20, 0.4);
}

/// Runs either solver for few iterations, when the gap is far above rounding.
#[test]
fn the_duality_gap_is_the_processors() {
    for solver in ["Newton", "CG"] {
        let option = format!("solver=\"{solver}\" iterations=\"1\" tolerance=\"0\"");
        let model = with_option("runner", &option);
        let mut random = Random::new(5);
        let states = Vec::from_iter((0..20).map(|_| random_state(&model, &mut random, 1.0)));
        let Some(mut batch) = general_batch::<f32>(&model, states.len()) else {
            return;
        };
        upload(&mut batch, &states);
        batch.forward().expect("a device");
        let mut sim = Sim::<f64>::new(model.clone()).expect("a good model");
        let mut large = 0;
        let solves = batch.solves().expect("a device");
        for (state, &solve) in states.iter().zip(&solves) {
            sim.state = convert(&model, state);
            sim.forward().expect("a good state");
            let gap = sim.stats().gap;
            let found = f64::from(solve.gap);
            assert!(
                (found - gap).abs() <= 0.02 * gap + 1e-5,
                "{solver}: {found} {gap}"
            );
            large += usize::from(gap > 1e-3);
        }
        assert!(large > 3, "{solver}: {large} gaps are large");
        // An integrator overwrites the factor of M with its own.
        batch.step(1).expect("a device");
        assert_eq!(solves, batch.solves().expect("a device"), "{solver}");
    }
}

#[test]
fn a_start_that_is_good_enough_is_proven_so() {
    let model = text(
        "<mujoco>
           <worldbody>
             <geom type='plane' size='1 1 1'/>
             <body pos='0 0 0.1'><freejoint/><geom size='0.1'/></body>
           </worldbody>
         </mujoco>",
    );
    let Some(mut batch) = general_batch::<f32>(&model, 2) else {
        return;
    };
    let mut states = vec![common::random_state(&model, &mut Random::new(1), 0.0); 2];
    states[1].qpos[2] = 1.0;
    upload(&mut batch, &states);
    batch.step(400).expect("a device");
    let solves = batch.solves().expect("a device");
    assert_eq!(solves[0].status, Status::Proven, "{:?}", solves[0]);
    assert_eq!(solves[0].iterations, 0);
    assert!(solves[0].gap <= 1e-5, "{:?}", solves[0]);
}

#[test]
fn solves_take_as_many_iterations_as_on_the_processor() {
    for option in ["cone='pyramidal'", "cone='elliptic'"] {
        for name in ["runner", "medley"] {
            common::efforts::efforts_agree::<f32>(&own(name), option, 0.04);
            common::efforts::efforts_agree::<f32>(
                &own(name),
                &format!("{option} solver='CG'"),
                0.05,
            );
        }
    }
}
