//! Unsupported features are refused by name, before the first step and without a device.

use crate::common::text;
use clench_gpu::{GpuBatch, GpuError, GpuOptions};
use clench_rigid::options::RigidOptions;
use clench_solver::Switch;

/// Returns a model of a pendulum with an option.
fn model(option: &str) -> String {
    format!(
        "<mujoco>
           {option}
           <worldbody>
             <geom type='plane' size='1 1 1'/>
             <body pos='0 0 1' name='ball'><joint name='hinge'/><geom name='ball' size='0.1'/>
               <body name='bob' pos='0 0 1'><joint name='joint'/><geom size='0.1'/></body></body>
           </worldbody>
         </mujoco>"
    )
}

#[test]
fn unsupported_features_are_refused_by_name() {
    for (text_of_model, words) in [
        (
            model(
                "<option solver='CG'/><custom><text name='clench.contact_model' data='coulomb'/></custom>",
            ),
            "option contact_model: Coulomb's law needs Newton's method",
        ),
        (
            "<mujoco><worldbody><geom size='1'/></worldbody></mujoco>".to_owned(),
            "model: a model without",
        ),
    ] {
        let error =
            GpuBatch::<f32>::new(text(&text_of_model), 1, GpuOptions::default()).expect_err(words);
        assert!(matches!(error, GpuError::Unsupported(_)), "{error}");
        let said = error.to_string();
        assert!(said.contains(words), "{said} does not say {words}");
    }
}

#[test]
fn refusals_of_the_processor_hold() {
    let option = "<option integrator='discrete'><flag sleep='enable'/></option>";
    let options = GpuOptions {
        options: RigidOptions::new().islands(Switch::Off),
        ..GpuOptions::default()
    };
    let error =
        GpuBatch::<f32>::new(text(&model(option)), 1, options).expect_err("trees have no islands");
    let said = error.to_string();
    assert!(said.contains("sleep without islands"), "{said}");
}

#[test]
fn a_missing_device_is_an_error_with_advice() {
    let options = GpuOptions {
        device: Some("no such card".to_owned()),
        ..GpuOptions::default()
    };
    let error = GpuBatch::<f32>::new(text(&model("")), 1, options).expect_err("no such card");
    let said = error.to_string();
    let known = said.starts_with("there is no graphics device \"no such card\"; there are: ");
    assert!(known || said.contains("mesa-vulkan-drivers"), "{said}");
}
