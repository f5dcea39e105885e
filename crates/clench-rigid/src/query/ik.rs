//! Inverse kinematics of a simulation.

use crate::Precision;
use crate::ik::{Ik, IkSolution, Search};
use crate::sim::Sim;
use clench_dynamics::check::check_values;
use clench_dynamics::error::SimError;
use clench_math::{Real, write_lane};

impl<T: Precision> Sim<T> {
    /// Returns joint positions that bring the tasks of `ik` to their goals, task by task, starting from the present
    /// state or from `start` (nq). The state does not change.
    ///
    /// # Errors
    /// Returns an error if the tasks are of a model with other objects, if goals or start have a wrong length or values
    /// that are not finite, or if [`step`](Self::step) would refuse the state.
    pub fn ik(
        &mut self,
        ik: &Ik,
        goals: &[T],
        start: Option<&[T]>,
    ) -> Result<IkSolution<T>, SimError> {
        ik.check_model(self.model())?;
        check_values("goals", goals, ik.goal_len(self.model()))?;
        if let Some(start) = start {
            check_values("start", start, self.model().nq)?;
        }
        self.check_state()?;
        let mut search = Search::new(self.model(), ik);
        search.state.splat_from(&self.state);
        for lane in 0..T::SingleEnv::LANES {
            if let Some(start) = start {
                write_lane(start, lane, &mut search.state.qpos);
            }
            write_lane(goals, lane, &mut search.goals);
        }
        T::ik(self.model(), self.params(), ik, &mut search);
        let mut found = Vec::new();
        search.write(&mut found);
        let found = Vec::from_iter(found.iter().map(|number| number.lane(0)));
        Ok(IkSolution::read(&found, self.model().nq))
    }
}
