//! The return mapping: after a solve, stick references are dragged along by contacts that slide or roll.
//!
//! With s = k d, the spring of a contact with the displacement φ requires friction of the size
//!
//! ```text
//! elliptic, Coulomb:  e = ‖ s φ_j / (R_j μ_j) ‖        pyramid:  e = Σ_j μ_j s |φ_j| / R        in units of normal force
//! ```
//!
//! and the contact carries at most e = f_n. (At the limit, a pyramid has a single loaded edge, whose force is
//! μ_j s φ_j / R.) With the stiffness κ of its first slide, f_n / κ is the displacement that it can store. The contacts
//! of a pair store at most the largest of these, so that a pair sticks while any of its contacts does: those with less
//! load slide at zero velocity, and the others carry what remains of the load.
//!
//! The reduced displacements φ' and the velocities of the surfaces themselves (`surfacevel`) change the reference by
//! the rigid motion that fits φ' − φ best, weighted by normal forces. A reference that has rotated by more than
//! [`MAX_ROTATION`] is replaced by the present pose with displacements φ' alone: a contact that rolls moves no material
//! point, but over a finite angle, slides computed from poses differ from zero by R θ³ / 6.

use super::displacement::present_pose;
use super::pairs::{LoadedContact, RelativePose, StickPair, Stiction};
use crate::contact::Contact;
use crate::contact::collision::Excess;
use crate::model::{Model, Params};
use crate::stages::Positions;
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::{Mask, Quat, Real, Vec3, kernel};

/// The rotation from which a reference is replaced, rad.
pub(super) const MAX_ROTATION: f64 = 0.01;
/// The minimum of squared lengths that determine a rotation, m².
pub(super) const MIN_SQUARED_ARM: f64 = 1e-12;

/// A rigid motion: displacement at a centre, and rotation, in world axes.
struct Twist<T> {
    centre: Vec3<T>,
    translation: Vec3<T>,
    rotation: Vec3<T>,
}

/// Drags the stick references and the displacements of dry friction along, after a solve.
#[kernel]
pub(crate) fn drag<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &mut State<T>,
    ws: &mut Workspace<T>,
) {
    let mut stiction = std::mem::take(&mut ws.stiction);
    let Stiction {
        pairs,
        slopes,
        loaded,
        ..
    } = &mut stiction;
    for pair in pairs {
        loaded.clear();
        pair.active = T::Mask::splat(false);
        for i in pair.contacts() {
            if let Some(contact) = LoadedContact::new(ws, slopes, i) {
                pair.active |= contact.force.gt(T::ZERO);
                loaded.push(contact);
            }
        }
        pair.map(params, &ws.position, &ws.contacts, loaded);
    }
    let full = stiction.store(model, &ws.sleep, &mut state.stick_references);
    ws.collision.record_excess(full, Excess::StickPairs);
    stiction.drag_friction(model, ws, &mut state.stick_friction);
    ws.stiction = stiction;
}

impl<T: Real> LoadedContact<T> {
    /// Reads the solution of the `index`-th contact of the workspace. `None` if it has no friction.
    #[inline(always)]
    fn new(ws: &Workspace<T>, slopes: &[T], index: usize) -> Option<Self> {
        let contact = &ws.contacts[index];
        let block_index = contact.block.filter(|_| contact.dim > 1)?;
        let block = ws.problem.block(block_index);
        let first = block.rows().start;
        let active = ws.record.blocks[block_index].active;
        let force = ws.solver.force()[first];
        let pyramid = block.cost.has_edges();
        let mut displacement = [T::ZERO; 5];
        let mut demand = T::ZERO;
        let mut stiffness = T::ZERO;
        for j in 1..contact.dim {
            let mu = contact.friction[j - 1];
            let per_row = slopes[first + j] * block.d[j];
            let stiff = match pyramid {
                true => mu * per_row,
                false => per_row / mu,
            };
            let phi = ws.record.pos[first + j];
            let e = stiff * phi;
            demand += if pyramid { e.abs() } else { e * e };
            displacement[j - 1] = phi;
            if j == 1 {
                stiffness = stiff;
            }
        }
        Some(LoadedContact {
            index,
            force: T::select(active, force.max(T::ZERO), T::ZERO),
            demand: if pyramid { demand } else { demand.sqrt() },
            stiffness,
            displacement,
        })
    }

    /// Returns the factor of the displacements of a pair whose contacts store at most `limit`, m.
    #[inline(always)]
    fn factor(&self, limit: T) -> T {
        let max_demand = limit * self.stiffness;
        let beyond = self.demand.gt(max_demand) & self.force.gt(T::ZERO);
        if !beyond.any() {
            return T::ONE;
        }
        T::select(
            beyond,
            max_demand / T::select(beyond, self.demand, T::ONE),
            T::ONE,
        )
    }

    /// Replaces the displacements by their change, or in the lanes of `replaced` by their new values; the surfaces
    /// themselves have moved by `drift`.
    #[inline(always)]
    fn change(&mut self, limit: T, replaced: T::Mask, drift: [T; 3]) {
        let factor = self.factor(limit) - T::select(replaced, T::ZERO, T::ONE);
        for phi in &mut self.displacement {
            *phi *= factor;
        }
        for (phi, drift) in self.displacement.iter_mut().zip(drift) {
            *phi += drift;
        }
    }
}

impl<T: Real> StickPair<T> {
    /// Changes the reference so that no contact stores more than it can carry.
    #[inline(always)]
    fn map(
        &mut self,
        params: &Params<T>,
        pos: &Positions<T>,
        contacts: &[Contact<T>],
        loaded: &mut [LoadedContact<T>],
    ) {
        let mut limit = T::ZERO;
        for contact in &*loaded {
            let stiff = contact.stiffness.gt(T::ZERO);
            let stores = contact.force / T::select(stiff, contact.stiffness, T::ONE);
            limit = limit.max(T::select(stiff, stores, T::ZERO));
        }
        let too_far = T::new(MAX_ROTATION * MAX_ROTATION);
        let rolls = self.rotation.norm_squared().gt(too_far);
        let mut moves = rolls;
        for contact in &*loaded {
            moves |= contact.factor(limit).lt(T::ONE);
            for drift in contacts[contact.index].surfacevel {
                moves |= !drift.eq(T::ZERO);
            }
        }
        if !(moves & self.active).any() {
            return;
        }
        for contact in &mut *loaded {
            let drift = contacts[contact.index].surfacevel;
            contact.change(limit, rolls, drift.map(|v| v * params.timestep));
        }
        let twist = fit(contacts, loaded);
        let start = RelativePose::select(rolls, present_pose(pos, self.bodies), self.reference);
        let moved = start.displaced(pos, self.bodies[0], &twist);
        self.reference = RelativePose::select(moves, moved, self.reference);
    }
}

/// Returns the rigid motion that fits the displacements of loaded contacts best.
#[inline(always)]
fn fit<T: Real>(contacts: &[Contact<T>], loaded: &[LoadedContact<T>]) -> Twist<T> {
    let mut weight = T::ZERO;
    let mut sums = [Vec3::ZERO; 4];
    for one in loaded {
        let (contact, force, phi) = (&contacts[one.index], one.force, &one.displacement);
        let [normal, t1, t2] = contact.frame.rows;
        let slide = t1 * phi[0] + t2 * phi[1];
        let roll = match contact.dim {
            6 => t1 * phi[3] + t2 * phi[4],
            _ => Vec3::ZERO,
        };
        weight += force;
        for (sum, x) in sums.iter_mut().zip([contact.pos, normal, slide, roll]) {
            *sum += x * force;
        }
    }
    let inverse = T::ONE / T::select(weight.gt(T::ZERO), weight, T::ONE);
    let [centre, normal, translation, rolls] = sums.map(|sum| sum * inverse);
    let (normal, _) = normal.normalize();
    let (mut moment, mut squared) = (T::ZERO, T::ZERO);
    for one in loaded {
        let (contact, force, phi) = (&contacts[one.index], one.force, &one.displacement);
        let [_, t1, t2] = contact.frame.rows;
        let arm = contact.pos - centre;
        let arm = arm - normal * normal.dot(arm);
        let slide = t1 * phi[0] + t2 * phi[1] - translation;
        moment += force * normal.dot(arm.cross(slide));
        squared += force * arm.norm_squared();
        if contact.dim >= 4 {
            // The squared ratio of spin to slide friction, m².
            let ratio = contact.friction[2] / contact.friction[0];
            moment += force * (ratio * ratio) * phi[2];
            squared += force * (ratio * ratio);
        }
    }
    let determined = squared.gt(weight * T::new(MIN_SQUARED_ARM));
    let spin = T::select(
        determined,
        moment / T::select(determined, squared, T::ONE),
        T::ZERO,
    );
    Twist {
        centre,
        translation,
        rotation: normal * spin + rolls,
    }
}

impl<T: Real> RelativePose<T> {
    /// Returns the reference whose displacements are larger by those of a twist. The quaternion of the rotation, which
    /// is small, is exact to second order.
    #[inline(always)]
    fn displaced(&self, pos: &Positions<T>, first: usize, twist: &Twist<T>) -> Self {
        let frame = &pos.xmat[first];
        let local = |v: Vec3<T>| frame.transpose_mul(v);
        let half = local(twist.rotation) * T::new(-0.5);
        let back = Quat::new(T::ONE, half.x, half.y, half.z).normalize();
        let centre = local(twist.centre - pos.xpos[first]);
        RelativePose {
            position: centre + back.rotate(self.position - centre) - local(twist.translation),
            rotation: (back * self.rotation).normalize(),
        }
    }
}
