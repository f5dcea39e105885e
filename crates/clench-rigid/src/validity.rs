//! The validity of the results in the workspace for the present state.

use clench_dynamics::state::State;
use clench_math::{Quat, Scalar, Vec3};

/// The extent of the results computed from a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Computed {
    /// Nothing is computed.
    Nothing,
    /// The results of the position stage.
    Positions,
    /// All results of a forward pass.
    Everything,
}

/// The extent of the results in the workspace, and the positions and velocities from which they were computed.
///
/// Results of the state at the start of a step are valid at its end, as in MuJoCo. Writing other positions or
/// velocities makes them stale.
#[derive(Clone, Debug)]
pub(crate) struct Validity<T> {
    computed: Computed,
    qpos: Vec<T>,
    qvel: Vec<T>,
    mocap_pos: Vec<Vec3<T>>,
    mocap_quat: Vec<Quat<T>>,
}

impl<T: Scalar> Validity<T> {
    pub(crate) fn new() -> Self {
        Validity {
            computed: Computed::Nothing,
            qpos: Vec::new(),
            qvel: Vec::new(),
            mocap_pos: Vec::new(),
            mocap_quat: Vec::new(),
        }
    }

    /// Marks all results as stale.
    pub(crate) fn invalidate(&mut self) {
        self.computed = Computed::Nothing;
    }

    /// Records the extent of the results. They are valid until this state is modified.
    pub(crate) fn record(&mut self, computed: Computed, state: &State<T>) {
        self.computed = computed;
        self.qpos.clone_from(&state.qpos);
        self.qvel.clone_from(&state.qvel);
        self.mocap_pos.clone_from(&state.mocap_pos);
        self.mocap_quat.clone_from(&state.mocap_quat);
    }

    /// Returns true if all results of the last recorded state are valid.
    pub(crate) fn is_complete(&self) -> bool {
        self.computed == Computed::Everything
    }

    /// Returns the results that are valid for this state.
    pub(crate) fn computed(&self, state: &State<T>) -> Computed {
        let same_positions = self.qpos == state.qpos
            && self.mocap_pos == state.mocap_pos
            && self.mocap_quat == state.mocap_quat;
        match self.computed {
            _ if !same_positions => Computed::Nothing,
            Computed::Everything if self.qvel != state.qvel => Computed::Positions,
            computed => computed,
        }
    }

    /// Returns true if the velocities equal the last recorded ones.
    pub(crate) fn same_velocities(&self, state: &State<T>) -> bool {
        self.qvel == state.qvel
    }
}
