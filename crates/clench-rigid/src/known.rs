//! Whether what the workspace holds was computed from the present state, or is stale.

use clench_dynamics::state::State;
use clench_math::{Quat, Scalar, Vec3};

/// How far the computation from a state has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Extent {
    /// Nothing is computed.
    Nothing,
    /// What the position stage computes.
    Positions,
    /// All that a forward pass computes.
    Everything,
}

/// How much the workspace holds, and the positions and velocities that it was computed from.
///
/// What a step computed from the state at its start counts as known at its end, as in MuJoCo. Once anyone writes other positions or
/// velocities it is stale.
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

    /// Marks everything as stale.
    pub(crate) fn forget(&mut self) {
        self.extent = Extent::Nothing;
    }

    /// Notes what was computed. It is known as long as nobody writes to this state.
    pub(crate) fn note(&mut self, extent: Extent, state: &State<T>) {
        self.extent = extent;
        self.qpos.clone_from(&state.qpos);
        self.qvel.clone_from(&state.qvel);
        self.mocap_pos.clone_from(&state.mocap_pos);
        self.mocap_quat.clone_from(&state.mocap_quat);
    }

    /// Whether everything is known of the state that was noted last.
    pub(crate) fn holds_everything(&self) -> bool {
        self.extent == Extent::Everything
    }

    /// How much is known of this state.
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
