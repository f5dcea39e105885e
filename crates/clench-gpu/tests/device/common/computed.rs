//! The processor's results, by the names of the device's fields.

use clench_gpu::GpuSolve;
use clench_math::{Mat3, Motion, Quat, Real, Scalar, Vec3};
use clench_rigid::Sim;
use clench_rigid::batch::Precision;
use std::collections::BTreeMap;

/// Returns the processor's results for one environment, by the names of the device's fields.
pub fn computed<S: Precision>(sim: &Sim<S>) -> BTreeMap<&'static str, Vec<f64>> {
    let ws = sim.workspace();
    let (pos, vel, force) = (&ws.position, &ws.velocity, &ws.force);
    let plain = |x: &[S::SingleEnv]| x.iter().copied().map(first).collect::<Vec<f64>>();
    let vectors =
        |v: &[Vec3<S::SingleEnv>]| v.iter().flat_map(|v| v.to_array().map(first)).collect();
    let quats = |q: &[Quat<S::SingleEnv>]| q.iter().flat_map(|q| q.to_array().map(first)).collect();
    let matrices = |m: &[Mat3<S::SingleEnv>]| {
        let rows = m.iter().flat_map(|m| m.rows);
        rows.flat_map(|r| r.to_array().map(first)).collect()
    };
    let motions =
        |m: &[Motion<S::SingleEnv>]| m.iter().flat_map(|m| m.to_array().map(first)).collect();
    let mut all = BTreeMap::new();
    all.insert("xpos", vectors(&pos.xpos));
    all.insert("xquat", quats(&pos.xquat));
    all.insert("xmat", matrices(&pos.xmat));
    all.insert("xipos", vectors(&pos.xipos));
    all.insert("ximat", matrices(&pos.ximat));
    all.insert("xanchor", vectors(&pos.xanchor));
    all.insert("xaxis", vectors(&pos.xaxis));
    all.insert("geom_xpos", vectors(&pos.geom_xpos));
    all.insert("geom_xmat", matrices(&pos.geom_xmat));
    all.insert("site_xpos", vectors(&pos.site_xpos));
    all.insert("site_xmat", matrices(&pos.site_xmat));
    all.insert("ten_length", plain(&pos.ten_length));
    all.insert("ten_jacobian", plain(&pos.ten_jacobian));
    all.insert("ten_velocity", plain(&vel.ten_velocity));
    all.insert("actuator_moment", plain(&pos.actuator_moment));
    all.insert("act_dot", plain(&force.act_dot));
    all.insert("qfrc_gravcomp", plain(&force.qfrc_gravcomp));
    all.insert("subtree_com", vectors(&pos.subtree_com));
    all.insert("cdof", motions(&pos.cdof));
    all.insert("cdof_dot", motions(&vel.cdof_dot));
    all.insert("cvel", motions(&vel.cvel));
    all.insert("qm", plain(&ws.problem.mass.values));
    all.insert("actuator_length", plain(&pos.actuator_length));
    all.insert("actuator_velocity", plain(&vel.actuator_velocity));
    all.insert("actuator_force", plain(&force.actuator_force));
    all.insert("qfrc_passive", plain(&force.qfrc_passive));
    all.insert("qfrc_bias", plain(&force.qfrc_bias));
    all.insert("qfrc_actuator", plain(&force.qfrc_actuator));
    all.insert("qfrc_smooth", plain(&force.qfrc_smooth));
    all.insert("qacc_smooth", plain(&ws.problem.qacc_smooth));
    all.insert("qacc", plain(&ws.qacc));
    all.insert("qfrc_constraint", plain(&ws.qfrc_constraint));
    all.insert("contacts", contact_numbers(sim));
    for (name, values) in row_numbers(sim) {
        all.insert(name, values);
    }
    all
}

/// Returns the contacts pair by pair as on the device, without the number of the pair.
fn contact_numbers<S: Precision>(sim: &Sim<S>) -> Vec<f64> {
    let contacts = sim.contacts().iter();
    let numbers = contacts.flat_map(|c| {
        let place = [c.dist].into_iter().chain(c.pos.to_array());
        let axes = c.frame.rows.into_iter().flat_map(|row| row.to_array());
        place.chain(axes).collect::<Vec<_>>()
    });
    numbers.map(first).collect()
}

/// Returns the data of the convex problem for each row, in order.
fn row_numbers<S: Precision>(sim: &Sim<S>) -> Vec<(&'static str, Vec<f64>)> {
    let ws = sim.workspace();
    let nv = ws.problem.nv();
    let (mut aref, mut r, mut jacobian) = (Vec::new(), Vec::new(), Vec::new());
    for block in ws.problem.blocks() {
        aref.extend(block.aref.iter().copied().map(first));
        r.extend(block.r.iter().copied().map(first));
        // A block may have no dofs.
        let width = block.dofs.len();
        for row in 0..block.aref.len() {
            let mut dense = vec![0.0; nv];
            for (&dof, j) in block.dofs.iter().zip(&block.jacobian[row * width..]) {
                dense[dof as usize] = first(*j);
            }
            jacobian.extend(dense);
        }
    }
    // The last rows may be terms of a metric, which are not recorded.
    let recorded = |x: &[S::SingleEnv]| {
        let mut numbers = Vec::from_iter(x.iter().copied().map(first));
        numbers.resize(aref.len(), 0.0);
        numbers
    };
    let (position, velocity) = (recorded(&ws.record.pos), recorded(&ws.record.vel));
    vec![
        ("aref", aref),
        ("r", r),
        ("jacobian", jacobian),
        ("position", position),
        ("velocity", velocity),
    ]
}

/// Returns the number of the single environment of a simulation.
fn first<T: Real>(x: T) -> f64 {
    x.lane(0).to_f64()
}

/// Returns the used part of a row; for contacts, without the number of their pair.
pub fn used(name: &str, mut row: Vec<f64>, solve: &GpuSolve, nv: usize) -> Vec<f64> {
    match name {
        "contacts" => {
            row.truncate(14 * solve.contacts);
            row = row.chunks(14).flat_map(|c| c[1..].to_vec()).collect();
        }
        "jacobian" => row.truncate(solve.rows * nv),
        "aref" | "r" | "position" | "velocity" => row.truncate(solve.rows),
        _ => {}
    }
    row
}
