//! Models of more dofs than the memory of a workgroup has room for.

use crate::common::{self, text};
use clench_gpu::{GpuBatch, GpuError, GpuOptions};

/// Balls side by side that touch the floor and each other, and a chain of links between two of them.
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

#[test]
fn more_dofs_than_newton_is_for_are_refused() {
    let model = text(&crowd(86, 0));
    let error = GpuBatch::new(model, 1, GpuOptions::default()).expect_err("516 dofs");
    let most = 512;
    assert_eq!(error, GpuError::TooManyDofs { most, nv: 516 });
}
