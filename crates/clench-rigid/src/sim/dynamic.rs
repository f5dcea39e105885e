//! Constraints that are added and removed while a simulation runs, and equalities of the model that adopt the present
//! pose.

use super::Sim;
use crate::Precision;
use clench_dynamics::constraint::dynamic::{CONNECT, WELD, tied};
use clench_dynamics::error::{SimError, no_such};
use clench_dynamics::model::{Coupled, Model};
use clench_dynamics::sleep::wake_in_state;
use clench_dynamics::state::State;
use clench_math::{Quat, Vec3};

/// Serial numbers stay below this, so that single precision is exact.
const SERIALS: u32 = 1 << 24;

/// A handle of a constraint that was added at run time, valid until its removal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct DynamicConstraint {
    slot: u32,
    serial: u32,
}

impl DynamicConstraint {
    /// Returns the handle as a number, unique among the present constraints of a simulation.
    pub fn to_code(self) -> u64 {
        u64::from(self.serial) << 32 | u64::from(self.slot)
    }

    /// Returns the constraint of a number from [`to_code`](Self::to_code).
    pub fn from_code(code: u64) -> Self {
        DynamicConstraint {
            slot: code as u32,
            serial: (code >> 32) as u32,
        }
    }

    /// Returns the constraint in a slot of a state, if there is one.
    fn in_slot<T: Precision>(model: &Model, state: &State<T>, slot: usize) -> Option<Self> {
        tied(model, state, slot, 0)?;
        Some(DynamicConstraint {
            slot: slot as u32,
            serial: state.dynamic_serial[slot].to_f64() as u32,
        })
    }
}

impl<T: Precision> Sim<T> {
    /// Welds two bodies in their present relative pose, as a suction gripper does. The constraint is part of the state:
    /// it is saved and restored with it, and a reset removes it. It has the default softness of MuJoCo's welds.
    ///
    /// # Errors
    /// Returns an error if there is no such body, if the bodies are the same or neither can move, if no slot is free
    /// (see [`Model::max_dynamic_constraints`]), or if [`step`](Self::step) would refuse the state.
    pub fn add_weld(&mut self, body1: usize, body2: usize) -> Result<DynamicConstraint, SimError> {
        self.refresh_positions()?;
        let slot = self.free_slot([body1, body2])?;
        let (anchor1, quat) = self.present_pose([body1, body2], Vec3::ZERO, Quat::IDENTITY);
        let state = &mut self.state;
        (state.dynamic_anchor1[slot], state.dynamic_anchor2[slot]) = (anchor1, Vec3::ZERO);
        state.dynamic_quat[slot] = quat;
        Ok(self.occupy(slot, WELD, [body1, body2]))
    }

    /// Connects two points like a ball joint: `anchor` in the frame of the first body, and the point of the second body
    /// that is there now. Otherwise as [`add_weld`](Self::add_weld).
    ///
    /// # Errors
    /// Returns an error as [`add_weld`](Self::add_weld) does, or if the anchor is not finite.
    pub fn add_connect(
        &mut self,
        body1: usize,
        body2: usize,
        anchor: Vec3<T>,
    ) -> Result<DynamicConstraint, SimError> {
        if !anchor.to_array().iter().all(|x| x.is_finite()) {
            let what = "a point that is not finite".to_owned();
            let reason = "an anchor is a point";
            return Err(SimError::CannotHold { what, reason });
        }
        self.refresh_positions()?;
        let slot = self.free_slot([body1, body2])?;
        let anchor2 = self.carry([body1, body2], anchor);
        let state = &mut self.state;
        (state.dynamic_anchor1[slot], state.dynamic_anchor2[slot]) = (anchor, anchor2);
        state.dynamic_quat[slot] = Quat::IDENTITY;
        Ok(self.occupy(slot, CONNECT, [body1, body2]))
    }

    /// Removes a constraint that was added at run time.
    ///
    /// # Errors
    /// Returns an error if the constraint no longer exists.
    pub fn remove(&mut self, constraint: DynamicConstraint) -> Result<(), SimError> {
        let slot = constraint.slot as usize;
        let there = slot < self.state.dynamic_kind.len()
            && DynamicConstraint::in_slot(&self.model, &self.state, slot) == Some(constraint);
        if !there {
            return Err(SimError::StaleConstraint);
        }
        if let Some((_, bodies)) = tied(&self.model, &self.state, slot, 0) {
            wake_in_state(&self.model, &mut self.state, bodies);
        }
        let state = &mut self.state;
        state.dynamic_kind[slot] = T::ZERO;
        state.dynamic_serial[slot] = T::ZERO;
        (state.dynamic_body1[slot], state.dynamic_body2[slot]) = (T::ZERO, T::ZERO);
        (state.dynamic_anchor1[slot], state.dynamic_anchor2[slot]) = (Vec3::ZERO, Vec3::ZERO);
        state.dynamic_quat[slot] = Quat::new(T::ZERO, T::ZERO, T::ZERO, T::ZERO);
        self.invalidate();
        Ok(())
    }

    /// Returns the serial number of the last constraint that was added at run time. It is not part of the state, so
    /// that no number is reused after a restore. A copy of the whole simulation must copy it.
    pub fn last_serial(&self) -> u32 {
        self.last_serial
    }

    /// Sets the last serial number, for a simulation that is a copy of another.
    pub fn set_last_serial(&mut self, serial: u32) {
        self.last_serial = serial;
    }

    /// Returns the present constraints that were added at run time, in the order of their slots.
    pub fn dynamic_constraints(&self) -> impl Iterator<Item = DynamicConstraint> {
        let slots = 0..self.state.dynamic_kind.len();
        slots.filter_map(|slot| DynamicConstraint::in_slot(&self.model, &self.state, slot))
    }

    /// Activates a weld or connect of the model at the present pose of its bodies. The pose is written to the
    /// parameters of this simulation (`eq_anchor1` and `eq_quat1` of a weld, `eq_anchor2` of a connect), the activation
    /// to the state.
    ///
    /// # Errors
    /// Returns an error if there is no such equality, if it is of another kind, or if [`step`](Self::step) would refuse
    /// the state.
    pub fn weld_here(&mut self, equality: usize) -> Result<(), SimError> {
        let Some(found) = self.model.equalities.get(equality) else {
            return Err(no_such("equality", equality, self.model.equalities.len()));
        };
        let coupled = found.target.coupled();
        self.refresh_positions()?;
        let [anchor1, anchor2] = [&self.params.eq_anchor1, &self.params.eq_anchor2]
            .map(|anchors| anchors[equality].lane(0));
        match coupled {
            Coupled::Frames(bodies) => {
                let quat2 = self.params.eq_quat2[equality].lane(0);
                let (anchor, quat) = self.present_pose(bodies, anchor2, quat2);
                self.params.eq_anchor1[equality] = Vec3::splat(anchor);
                self.params.eq_quat1[equality] = Quat::splat(quat);
            }
            Coupled::Points(bodies) => {
                let anchor2 = self.carry(bodies, anchor1);
                self.params.eq_anchor2[equality] = Vec3::splat(anchor2);
            }
            Coupled::Joints(..) | Coupled::Tendons(..) => {
                return Err(SimError::CannotHold {
                    what: format!("equality \"{}\"", self.model.equalities[equality].name),
                    reason: "only welds and connects constrain a pose",
                });
            }
        }
        self.state.eq_active[equality] = true;
        self.invalidate();
        Ok(())
    }

    /// Returns a free slot for a constraint between these bodies.
    fn free_slot(&self, bodies: [usize; 2]) -> Result<usize, SimError> {
        let count = self.model.nbody();
        if let Some(&body) = bodies.iter().find(|&&body| body >= count) {
            return Err(no_such("body", body, count));
        }
        let reason = match bodies.map(|body| self.model.bodies[body].last_dof) {
            _ if bodies[0] == bodies[1] => Some("they are the same body"),
            [None, None] => Some("both are static"),
            _ => None,
        };
        if let Some(reason) = reason {
            let [one, other] = bodies.map(|body| &*self.model.bodies[body].name);
            let what = format!("body \"{one}\" and body \"{other}\"");
            return Err(SimError::CannotHold { what, reason });
        }
        let mut slots = 0..self.state.dynamic_kind.len();
        let free = slots.find(|&slot| tied(&self.model, &self.state, slot, 0).is_none());
        let max = self.state.dynamic_kind.len();
        free.ok_or(SimError::NoFreeSlot { max })
    }

    /// Assigns a slot to a constraint whose frames are already stored there.
    fn occupy(&mut self, slot: usize, kind: f64, bodies: [usize; 2]) -> DynamicConstraint {
        // The state may contain serial numbers of another simulation, which counted further.
        let serials = self.state.dynamic_serial.iter();
        let last = serials.fold(self.last_serial, |last, serial| {
            last.max(serial.to_f64() as u32)
        });
        self.last_serial = last % (SERIALS - 1) + 1;
        let state = &mut self.state;
        state.dynamic_kind[slot] = T::new(kind);
        state.dynamic_serial[slot] = T::new(f64::from(self.last_serial));
        state.dynamic_body1[slot] = T::new(bodies[0] as f64);
        state.dynamic_body2[slot] = T::new(bodies[1] as f64);
        wake_in_state(&self.model, state, bodies);
        self.invalidate();
        DynamicConstraint {
            slot: slot as u32,
            serial: self.last_serial,
        }
    }

    /// Returns the present pose, in the frame of the first body, of a point and a rotation of the second.
    fn present_pose(
        &self,
        [body1, body2]: [usize; 2],
        point: Vec3<T>,
        turn: Quat<T>,
    ) -> (Vec3<T>, Quat<T>) {
        let xquat = &self.ws.position.xquat;
        let quat = xquat[body1].conjugate() * xquat[body2] * Quat::splat(turn);
        (self.carry([body2, body1], point), quat.lane(0))
    }

    /// Transforms a point of one body to the frame of another, at their present poses.
    fn carry(&self, [from, to]: [usize; 2], point: Vec3<T>) -> Vec3<T> {
        let pos = &self.ws.position;
        let world = pos.xpos[from] + pos.xmat[from] * Vec3::splat(point);
        pos.xmat[to].transpose_mul(world - pos.xpos[to]).lane(0)
    }
}
