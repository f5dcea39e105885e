//! Inverse kinematics of a simulation.

use crate::Precision;
use crate::check::check_values;
use crate::error::SimError;
use crate::ik::{Ik, IkSolution, Search};
use crate::sim::Sim;

impl<T: Precision> Sim<T> {
    /// Positions of the joints that bring the tasks of `ik` to their goals, task after task, from those of the present state, or
    /// from `start` (nq). The state stays as it is.
    ///
    /// # Errors
    /// Goals or a start of a wrong length or with numbers that are not finite; a state as [`step`](Self::step) refuses it.
    pub fn ik(
        &mut self,
        ik: &Ik,
        goals: &[T],
        start: Option<&[T]>,
    ) -> Result<IkSolution<T>, SimError> {
        check_values("goals", goals, ik.goal_len(self.model()))?;
        if let Some(start) = start {
            check_values("start", start, self.model().nq)?;
        }
        self.check_present()?;
        let mut search = Search::new(self.model(), ik);
        search.state.copy_from(&self.state);
        if let Some(start) = start {
            search.state.qpos.copy_from_slice(start);
        }
        search.goals.copy_from_slice(goals);
        T::ik(self.model(), self.params(), ik, &mut search);
        let mut found = Vec::new();
        search.write(&mut found);
        Ok(IkSolution::read(&found, self.model().nq))
    }
}
