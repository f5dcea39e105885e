//! Coriolis, centrifugal and gravity forces by recursive Newton–Euler (Featherstone 2008, §5.3).
//!
//! Without joint acceleration a body accelerates with a = Σ ċdof q̇ along its chain; gravity is an upward acceleration
//! of the world. The required force I a + v ×* I v is summed down the tree and projected onto each dof.

use crate::dynamics::project::project_forces;
use crate::model::{Model, Params};
use crate::part::Part;
use crate::stages::{Forces, Positions, Velocities};
use clench_math::{Force, Motion, Real, Vec3, kernel};

/// Computes `qfrc_bias` of some parts, on the left side of the equation of motion.
#[kernel]
pub fn bias_forces<T: Real>(
    model: &Model,
    params: &Params<T>,
    parts: &[Part],
    pos: &Positions<T>,
    vel: &Velocities<T>,
    qvel: &[T],
    force: &mut Forces<T>,
) {
    let gravity = if model.flags.gravity {
        params.gravity
    } else {
        Vec3::ZERO
    };
    force.cacc[0] = Motion::new(Vec3::ZERO, -gravity);
    force.cfrc_body[0] = Force::ZERO;
    for part in parts {
        for b in part.bodies.start.max(1)..part.bodies.end {
            let body = &model.bodies[b];
            let mut cacc = force.cacc[body.parent];
            for i in body.dofs.clone() {
                cacc += vel.cdof_dot[i] * qvel[i];
            }
            let (inertia, cvel) = (pos.cinert[b], vel.cvel[b]);
            force.cacc[b] = cacc;
            force.cfrc_body[b] = inertia * cacc + cvel.cross_force(inertia * cvel);
        }
        force.qfrc_bias[part.dofs.clone()].fill(T::ZERO);
    }
    project_forces(
        model,
        parts,
        pos,
        &mut force.cfrc_body,
        &mut force.qfrc_bias,
    );
}
