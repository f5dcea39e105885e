//! External forces on bodies: applied forces, contacts, connects, welds and spatial tendons.
//!
//! A force F at a point p with a couple Q has the moment Q + (p − o) × F about o. A contact force acts on the second
//! body, and its negative on the first. A connect or weld pulls its first body along its rows, and the second against
//! them.

use super::source::Source;
use super::tendon_forces::each_pull;
use clench_dynamics::constraint::{AnchorFrames, ConstraintSource, weld_torque};
use clench_dynamics::contact::Contact;
use clench_dynamics::model::Coupled;
use clench_dynamics::workspace::Workspace;
use clench_math::{Force, Real, Vec3, kernel};

/// A force and a couple in world axes, and the point of action of the force.
pub(crate) struct Wrench<T> {
    pub force: Vec3<T>,
    pub couple: Vec3<T>,
    pub at: Vec3<T>,
}

impl<T: Real> Wrench<T> {
    /// Returns the spatial force about `origin`.
    #[kernel]
    fn about(&self, origin: Vec3<T>) -> Force<T> {
        let moment = self.couple + (self.at - origin).cross(self.force);
        Force::new(moment, self.force)
    }
}

/// Appends the external torque and force on each body, about the centre of mass of its tree.
#[kernel]
pub(crate) fn external_forces<T: Real>(s: &Source<T>, out: &mut Vec<T>) {
    let start = out.len();
    let pos = &s.ws.position;
    let com = |body: usize| pos.subtree_com[s.model.bodies[body].root];
    for (b, applied) in s.state.xfrc_applied.iter().enumerate() {
        let wrench = Wrench {
            force: applied.linear,
            couple: applied.angular,
            at: pos.xipos[b],
        };
        // The sum starts from 0, which no force of −0 turns into −0, so that contacts of other lanes, which add 0,
        // change nothing.
        let mut force = Force::ZERO;
        if b != 0 {
            force += wrench.about(com(b));
        }
        out.extend(force.to_array());
    }
    let mut add = |body: usize, sign: T, wrench: &Wrench<T>| {
        if body != 0 {
            add_wrench(&mut out[start + 6 * body..], wrench, com(body), sign);
        }
    };
    each_contact(
        s,
        #[inline(always)]
        |bodies, wrench| {
            for (body, sign) in [(bodies[0], -T::ONE), (bodies[1], T::ONE)] {
                add(body, sign, &wrench);
            }
        },
    );
    each_joint_of_bodies(s, |_, bodies, wrenches| {
        add(bodies[0], T::ONE, &wrenches[0]);
        add(bodies[1], -T::ONE, &wrenches[1]);
    });
    each_pull(s, |span, force| {
        for (end, sign) in [(0, -T::ONE), (1, T::ONE)] {
            let wrench = Wrench {
                force: span.pull * force,
                couple: Vec3::ZERO,
                at: span.points[end],
            };
            add(span.bodies[end], sign, &wrench);
        }
    });
}

/// Appends the contact force and torque on each body, at its centre of mass.
#[kernel]
pub(super) fn of_contacts<T: Real>(s: &Source<T>, out: &mut Vec<T>) {
    let start = out.len();
    out.resize(start + 6 * s.model.nbody(), T::ZERO);
    each_contact(s, |bodies, wrench| {
        for (body, sign) in [(bodies[0], -T::ONE), (bodies[1], T::ONE)] {
            let force = wrench.about(s.ws.position.xipos[body]) * sign;
            let row = &mut out[start + 6 * body..];
            accumulate(row, force.linear.to_array());
            accumulate(&mut row[3..], force.angular.to_array());
        }
    });
}

/// Adds the torque and force of a wrench about `origin`, times a sign.
#[kernel]
fn add_wrench<T: Real>(out: &mut [T], wrench: &Wrench<T>, origin: Vec3<T>, sign: T) {
    let force = wrench.about(origin) * sign;
    accumulate(out, force.to_array());
}

#[inline(always)]
fn accumulate<T: Real, const N: usize>(row: &mut [T], values: [T; N]) {
    for (sum, value) in row.iter_mut().zip(values) {
        *sum += value;
    }
}

/// Returns the forces of a block's rows, zero in the lanes that do not have it.
#[kernel]
fn rows<T: Real>(ws: &Workspace<T>, block: usize) -> [T; 6] {
    let active = ws.record.blocks[block].active;
    let mut forces = [T::ZERO; 6];
    let found = &ws.solver.force()[ws.problem.block(block).rows()];
    for (force, &found) in forces.iter_mut().zip(found) {
        *force = T::select(active, found, T::ZERO);
    }
    forces
}

/// Returns the force of a contact with a constraint on its second body, in the contact frame: its rows minus its
/// adhesion, which pulls as a passive force. Zero in the lanes without it.
#[inline(always)]
pub(crate) fn of_contact<T: Real>(ws: &Workspace<T>, contact: &Contact<T>) -> Option<[T; 6]> {
    let block = contact.block?;
    let mut force = rows(ws, block);
    let active = ws.record.blocks[block].active;
    force[0] -= T::select(active, contact.adhesion, T::ZERO);
    Some(force)
}

/// Calls `show` for every contact with a constraint: its bodies and the force on the second.
#[kernel]
fn each_contact<T: Real>(s: &Source<T>, mut show: impl FnMut([usize; 2], Wrench<T>)) {
    for contact in &s.ws.contacts {
        let Some([n, t1, t2, spin, roll1, roll2]) = of_contact(s.ws, contact) else {
            continue;
        };
        let wrench = Wrench {
            force: contact.frame.transpose_mul(Vec3::new(n, t1, t2)),
            couple: contact.frame.transpose_mul(Vec3::new(spin, roll1, roll2)),
            at: contact.pos,
        };
        show(contact.geoms.map(|g| s.model.geoms[g].body), wrench);
    }
}

/// Calls `show` for every connect and weld: its source, its bodies, and the force on the first at each anchor.
#[kernel]
pub(crate) fn each_joint_of_bodies<T: Real>(
    s: &Source<T>,
    mut show: impl FnMut(ConstraintSource, [usize; 2], [Wrench<T>; 2]),
) {
    let pos = &s.ws.position;
    for (block, record) in s.ws.record.blocks.iter().enumerate() {
        let Some((frames, weld)) = frames(s, record.source) else {
            continue;
        };
        let [x, y, z, turn_x, turn_y, turn_z] = rows(s.ws, block);
        let rotation = Vec3::new(turn_x, turn_y, turn_z);
        let couple = match weld {
            true => weld_torque(pos, &frames, rotation),
            false => Vec3::ZERO,
        };
        let wrenches = frames.points(pos).map(|at| Wrench {
            force: Vec3::new(x, y, z),
            couple,
            at,
        });
        show(record.source, frames.bodies, wrenches);
    }
}

/// Returns the anchor frames of a connect or weld, and true if it is a weld.
fn frames<T: Real>(s: &Source<T>, source: ConstraintSource) -> Option<(AnchorFrames<T>, bool)> {
    match source {
        ConstraintSource::Dynamic { slot, bodies, weld } => {
            Some((AnchorFrames::of_slot(s.state, slot, bodies), weld))
        }
        ConstraintSource::Equality(e) => {
            let (bodies, weld) = match s.model.equalities[e].target.coupled() {
                Coupled::Points(bodies) => (bodies, false),
                Coupled::Frames(bodies) => (bodies, true),
                Coupled::Joints(..) | Coupled::Tendons(..) => return None,
            };
            Some((AnchorFrames::of_equality(s.params, e, bodies), weld))
        }
        ConstraintSource::DofFriction(_)
        | ConstraintSource::TendonFriction(_)
        | ConstraintSource::JointLimit(_)
        | ConstraintSource::TendonLimit(_)
        | ConstraintSource::Contact(_) => None,
    }
}
