//! Models with more dofs than fit into the memory of a workgroup.

use crate::common::{self, text};
use clench_gpu::{GpuBatch, GpuError, GpuOptions};
use clench_rigid::model::Model;
use std::sync::Arc;

/// Returns balls next to each other that touch the floor and each other, and a chain of links between two of them.
fn crowd(balls: usize, links: usize) -> String {
    let mut bodies = String::new();
    for k in 0..balls {
        let (x, y) = (0.19 * (k % 5) as f64, 0.19 * (k / 5) as f64);
        bodies += &format!(
            "<body pos='{x} {y} 0.1'><freejoint/><geom type='sphere' size='0.1' mass='{}'/></body>",
            1 + k % 3
        );
    }
    for k in 0..links {
        let (x, axis) = if k == 0 {
            (-0.3, "0 1 0")
        } else {
            (0.1, ["0 1 0", "1 0 0", "0 0 1"][k % 3])
        };
        bodies += &format!(
            "<body pos='{x} 0 {}'><joint axis='{axis}' armature='0.01' damping='0.1'/>\
             <geom type='capsule' fromto='0 0 0 0.1 0 0' size='0.02' contype='0' conaffinity='2'/>",
            if k == 0 { 0.05 } else { 0.0 }
        );
    }
    bodies += &"</body>".repeat(links);
    format!(
        "<mujoco model='crowd'>
           <option timestep='0.004'/>
           <worldbody>
             <geom type='plane' size='5 5 1' contype='3'/>
             {bodies}
           </worldbody>
         </mujoco>"
    )
}

#[test]
fn a_crowd_whose_hessian_lies_outside_the_workgroup() {
    let model = text(&crowd(16, 12));
    assert_eq!(model.nv, 108);
    let Some(batch) = common::agree(&model, 20, 0.2) else {
        return;
    };
    let solves = batch.solves().expect("a device");
    assert!(solves.iter().all(|s| s.contacts > 10 && s.iterations > 1));
}

/// Returns a model of `balls` balls: three start on the floor, and two are connected.
fn flock(balls: usize, option: &str) -> Arc<Model> {
    let ball = |k: usize| {
        let height = if k < 3 { 0.1 } else { 1.0 };
        format!(
            "<body name='{k}' pos='{k} 0 {height}'><freejoint/><geom size='0.1' contype='0'/></body>"
        )
    };
    text(&format!(
        "<mujoco model='flock'>
           <option {option}/>
           <worldbody><geom type='plane' size='1 1 1'/>{}</worldbody>
           <equality><connect body1='2' body2='3' anchor='0.5 0 0.5'/></equality>
         </mujoco>",
        String::from_iter((0..balls).map(ball))
    ))
}

/// The model is so large that even the vectors do not fit into the memory of a workgroup of Mesa's software device.
#[test]
fn conjugate_gradients_solve_models_too_large_for_newton() {
    let model = flock(136, "solver='CG' tolerance='1e-10'");
    assert_eq!(model.nv, 816);
    let Some(batch) = common::agree_within(1e-3, 0, &model, 3, 0.2) else {
        return;
    };
    let solves = batch.solves().expect("a device");
    assert!(solves.iter().all(|s| s.iterations > 1 && s.rows > 3));
}

#[test]
fn more_dofs_than_newton_is_for_are_refused() {
    let error =
        GpuBatch::<f32>::new(flock(86, ""), 1, GpuOptions::default()).expect_err("516 dofs");
    let max = 512;
    assert_eq!(error, GpuError::TooManyDofs { max, nv: 516 });
    assert!(error.to_string().contains("CG has no such limit"));
}
