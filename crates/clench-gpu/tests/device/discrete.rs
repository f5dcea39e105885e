//! The integrator `discrete`: its metric, rows at the end of the step, and steps. Kernels in double precision serve any
//! model; those in single precision are specialized for their models, which compile sooner.

use crate::common::{
    self, Random, batch, batch_drifts_alike, doubles_arrive, forward_agrees_in_double,
    general_batch, own, random_state, text,
};
use clench_rigid::model::Model;
use std::sync::Arc;

const CONES: &str = "cone=\"elliptic\" impratio=\"2\"";

/// Loads a test model with the integrator and additional attributes of `<option>`.
fn discrete(name: &str, option: &str) -> Arc<Model> {
    let option = format!("<option integrator=\"discrete\" {option} ");
    text(&own(name).replacen("<option ", &option, 1))
}

/// Asserts that every field of 20 random states is the processor's in double precision, and that 20 steps arrive at the
/// same states.
fn agree(model: &Arc<Model>) {
    let mut random = Random::new(3);
    let states = Vec::from_iter((0..20).map(|_| random_state(model, &mut random, 0.5)));
    if let Some(mut batch) = general_batch(model, states.len()) {
        forward_agrees_in_double(&mut batch, &states, 1e-9);
        doubles_arrive(&mut batch, 20);
    }
}

#[test]
fn joints_and_constraints_agree() {
    agree(&discrete("medley", ""));
    agree(&discrete("medley", CONES));
}

#[test]
fn they_agree_in_single_precision_and_drift_as_on_the_processor() {
    if let Some(mut batch) = batch(&discrete("medley", CONES), 40) {
        common::forward_agrees(&mut batch, 1e-4, 0, 0.7);
        batch_drifts_alike(&mut batch, 30);
    }
}

/// Tests terms of tendons and actuators over several branches.
#[test]
fn couplings_agree() {
    agree(&discrete("linkage", ""));
}

#[test]
fn springs_that_yield_and_late_controls_agree() {
    agree(&discrete("pliant", ""));
}

/// Tests bodies on which only a tendon acts, and springs of constraints that a step cannot resolve.
#[test]
fn flying_bodies_on_a_string_and_stiff_constraints_agree() {
    let model = text(
        "<mujoco model='kites'>
           <option integrator='discrete' timestep='0.004' cone='elliptic'/>
           <default><geom solref='0.003 1'/><joint solreflimit='0.002 1' solimplimit='0.9999 0.9999 0.001'/></default>
           <worldbody>
             <geom type='plane' size='5 5 1'/>
             <body pos='0 0 2'><freejoint/><geom type='box' size='0.1 0.2 0.3'/><site name='a' pos='0.1 0.2 0'/></body>
             <body pos='1 0 2'><freejoint/><geom type='box' size='0.3 0.1 0.2'/><site name='b' pos='-0.3 0 0.2'/></body>
             <body pos='-1 0 2'><freejoint/><geom type='box' size='0.1 0.3 0.2'/></body>
             <body pos='0 1 0.09'><freejoint/><geom size='0.1'/>
               <body pos='0 0 0.2'><joint axis='0 1 0' limited='true' range='-10 10' margin='0.2'/><geom type='capsule' size='0.05 0.1'/></body>
             </body>
           </worldbody>
           <tendon>
             <spatial stiffness='300' damping='5'><site site='a'/><site site='b'/></spatial>
           </tendon>
         </mujoco>",
    );
    agree(&model);
}

#[test]
fn ellipsoids_in_a_medium_agree() {
    agree(&discrete("swimmers", ""));
}

#[test]
fn controllers_and_orientation_servos_agree() {
    agree(&discrete("controllers", ""));
    agree(&discrete("servos", ""));
}

/// Without islands, since conjugate gradients on the whole problem need more iterations than the islands'.
#[test]
fn conjugate_gradients_agree_on_couplings() {
    let option = "integrator=\"discrete\" solver=\"CG\" iterations=\"100\" tolerance=\"0\"";
    let flag = "<option><flag island=\"disable\"/></option><default>";
    let file = own("linkage").replacen("<option ", &format!("<option {option} "), 1);
    if let Some(mut batch) = batch(&text(&file.replacen("<default>", flag, 1)), 20) {
        common::forward_agrees(&mut batch, 1e-3, 0, 0.4);
    }
}

/// Both use another matrix than the metric if a term has several dofs, as in the linkage.
#[test]
fn exact_inverse_inertias_and_friction_that_does_not_slip_agree() {
    let option = "integrator=\"discrete\" noslip_iterations=\"3\" noslip_tolerance=\"0\"";
    let flag = "<option><flag diagexact=\"enable\"/></option><default>";
    for (name, cone) in [("medley", "elliptic"), ("linkage", "pyramidal")] {
        let option = format!("<option {option} cone=\"{cone}\" ");
        let file = own(name).replacen("<option ", &option, 1);
        agree(&text(&file.replacen("<default>", flag, 1)));
    }
}
