//! Whether what was computed from a state still holds.

use crate::state::State;
use clench_math::{Quat, Scalar, Vec3};

/// How much of what follows from a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Extent {
    /// The state itself.
    Nothing,
    /// What the position stage computes.
    Positions,
    /// All that a forward pass computes.
    Everything,
}

/// How much of the workspace holds, and for which positions and velocities.
///
/// A step moves the state on, and what it computed on the way counts as known all the same, as in MuJoCo; positions or
/// velocities that anyone writes afterwards do not.
#[derive(Clone, Debug)]
pub(crate) struct Known<T> {
    extent: Extent,
    qpos: Vec<T>,
    qvel: Vec<T>,
    mocap_pos: Vec<Vec3<T>>,
    mocap_quat: Vec<Quat<T>>,
}

impl<T: Scalar> Known<T> {
    /// Nothing is known.
    pub(crate) fn new() -> Self {
        Known {
            extent: Extent::Nothing,
            qpos: Vec::new(),
            qvel: Vec::new(),
            mocap_pos: Vec::new(),
            mocap_quat: Vec::new(),
        }
    }

    /// What is known holds no longer.
    pub(crate) fn forget(&mut self) {
        self.extent = Extent::Nothing;
    }

    /// So much is known as long as nobody writes this state.
    pub(crate) fn note(&mut self, extent: Extent, state: &State<T>) {
        self.extent = extent;
        self.qpos.clone_from(&state.qpos);
        self.qvel.clone_from(&state.qvel);
        self.mocap_pos.clone_from(&state.mocap_pos);
        self.mocap_quat.clone_from(&state.mocap_quat);
    }

    /// How much holds for this state.
    pub(crate) fn extent(&self, state: &State<T>) -> Extent {
        let placed = self.qpos == state.qpos
            && self.mocap_pos == state.mocap_pos
            && self.mocap_quat == state.mocap_quat;
        match self.extent {
            _ if !placed => Extent::Nothing,
            Extent::Everything if self.qvel != state.qvel => Extent::Positions,
            extent => extent,
        }
    }

    /// Whether the velocities are those for which anything was last noted.
    pub(crate) fn same_velocities(&self, state: &State<T>) -> bool {
        self.qvel == state.qvel
    }
}
