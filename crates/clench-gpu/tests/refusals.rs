//! What the device cannot do yet is refused by name, before the first step and without a device.

mod common;

use clench_gpu::{GpuBatch, GpuError, GpuOptions};
use common::text;

/// A model of one ball, with something more at each of four places.
fn model(option: &str, geom: &str, in_world: &str, after: &str) -> String {
    format!(
        "<mujoco>
           {option}
           <worldbody>
             <geom type='plane' size='1 1 1'/>
             <body pos='0 0 1' name='ball'><joint name='hinge'/><geom name='ball' size='0.1' {geom}/>
               <body name='bob' pos='0 0 1'><joint name='joint'/><geom size='0.1'/></body></body>
             {in_world}
           </worldbody>
           {after}
         </mujoco>"
    )
}

#[test]
fn what_is_not_there_yet_is_refused_by_name() {
    let chain = |n: usize| {
        let open = "<body pos='0 0 0.1'><joint/><geom size='0.01' contype='0' conaffinity='0'/>";
        open.repeat(n) + &"</body>".repeat(n)
    };
    let free = "<body name='b' pos='3 0 1'><freejoint name='f'/><geom name='box' type='box' size='0.1 0.1 0.1'/></body>";
    for (text_of_model, words) in [
        (
            model("<option integrator='implicitfast'/>", "", "", ""),
            "option integrator: implicit",
        ),
        (
            model("<option solver='CG'/>", "", "", ""),
            "option constraint_solver: Newton",
        ),
        (
            model("<option><flag autoreset='enable'/></option>", "", "", ""),
            "option autoreset",
        ),
        (
            model("<option noslip_iterations='3'/>", "", "", ""),
            "option noslip_iterations",
        ),
        (
            model(
                "",
                "",
                "<body gravcomp='1' name='light' pos='2 0 0'><freejoint/><geom size='0.1'/></body>",
                "",
            ),
            "body \"light\": gravity",
        ),
        (
            model(
                "",
                "",
                "",
                "<equality><joint name='tie' joint1='hinge' joint2='joint'/></equality>",
            ),
            "equality \"tie\"",
        ),
        (
            model(
                "",
                "",
                "",
                "<tendon><fixed name='string' stiffness='1'><joint joint='hinge' coef='1'/></fixed></tendon>",
            ),
            "tendon \"string\"",
        ),
        (
            model(
                "",
                "",
                free,
                "<actuator><motor name='push' joint='f' gear='1'/></actuator>",
            ),
            "actuator \"push\": actuators on",
        ),
        (
            model(
                "",
                "",
                "",
                "<actuator><general name='slow' joint='hinge' dyntype='filter' dynprm='1'/></actuator>",
            ),
            "actuator \"slow\": actuators with",
        ),
        (
            model(
                "",
                "",
                "",
                "<actuator><muscle name='biceps' joint='hinge' lengthrange='0 1'/></actuator>",
            ),
            "actuator \"biceps\"",
        ),
        (model("", "", free, ""), "sphere geom \"ball\" and"),
        (model("", "", &chain(21), ""), "a path of more than 20 dofs"),
        (
            "<mujoco><worldbody><geom size='1'/></worldbody></mujoco>".to_owned(),
            "model: a model without",
        ),
    ] {
        let error = GpuBatch::new(text(&text_of_model), 1, GpuOptions::default()).expect_err(words);
        assert!(matches!(error, GpuError::Unsupported(_)), "{error}");
        let said = error.to_string();
        assert!(said.contains(words), "{said} does not say {words}");
    }
}

#[test]
fn a_device_that_is_not_there_is_an_error_that_says_what_to_do() {
    let options = GpuOptions {
        device: Some("no such card".to_owned()),
        ..GpuOptions::default()
    };
    let error = GpuBatch::new(text(&model("", "", "", "")), 1, options).expect_err("no such card");
    let said = error.to_string();
    let known = said.starts_with("there is no graphics device \"no such card\"; there are: ");
    assert!(known || said.contains("mesa-vulkan-drivers"), "{said}");
}
