//! Poses of lights.

use clench_dynamics::model::{CameraMode, Light};
use clench_dynamics::workspace::Workspace;
use clench_math::{Real, Scalar, Vec3};

/// Returns the position, m, and unit direction of lights in world axes, by the rules of MuJoCo's `mj_camlight`, for
/// lane 0.
pub fn light_poses<T: Real>(lights: &[Light], ws: &Workspace<T>) -> Vec<[[f64; 3]; 2]> {
    let pose = |light: &Light| {
        let (pos, dir) = light_pose(light, ws);
        [pos.to_array(), dir.to_array()]
    };
    lights.iter().map(pose).collect()
}

fn light_pose<T: Real>(light: &Light, ws: &Workspace<T>) -> (Vec3<f64>, Vec3<f64>) {
    let wide = |v: Vec3<T>| Vec3::from_array(v.to_array().map(|x| x.lane(0).to_f64()));
    let at = |body: usize| wide(ws.position.xpos[body]);
    let com = |body: usize| wide(ws.position.subtree_com[body]);
    let rotated = |v: Vec3<f64>| {
        let rows = ws.position.xmat[light.body].rows.map(wide);
        Vec3::from_array(rows.map(|row| row.dot(v)))
    };
    let fixed = || at(light.body) + rotated(light.pos);
    match light.mode {
        CameraMode::Fixed => (fixed(), rotated(light.dir)),
        CameraMode::Track => (at(light.body) + light.pos0, light.dir0),
        CameraMode::TrackCom(_) => (com(light.body) + light.poscom0, light.dir0),
        CameraMode::TargetBody(target) => (fixed(), (at(target) - fixed()).normalize().0),
        CameraMode::TargetBodyCom(target) => (fixed(), (com(target) - fixed()).normalize().0),
    }
}
