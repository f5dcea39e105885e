//! The answers of a simulation to the queries of the table.

use super::input::QueryInput;
use super::table::Query;
use crate::Precision;
use crate::sim::Sim;
use clench_dynamics::error::{Fault, SimError};
use clench_dynamics::joint_description::massless;
use clench_math::{Mask, Real};

impl<T: Precision> Sim<T> {
    /// Answers a query, in the state of [`refresh`](Self::refresh); inverse dynamics are those of the present state.
    ///
    /// # Errors
    /// Returns an error if there is no such object, if the number of input values is wrong or one is not finite, if the
    /// mass matrix is singular, or as [`refresh`](Self::refresh) does.
    pub fn answer(&mut self, query: Query<'_>, input: &[T]) -> Result<Vec<T>, SimError> {
        let width = query.check(self.model(), &QueryInput::Shared(input), 1)?;
        let mut answer = vec![T::ZERO; width];
        self.write_answer(query, input, &mut answer)?;
        Ok(answer)
    }

    /// Writes the answer to a query whose arguments are checked.
    pub(super) fn write_answer(
        &mut self,
        query: Query<'_>,
        input: &[T],
        answer: &mut [T],
    ) -> Result<(), SimError> {
        if let Query::Inverse(kind) = query {
            return self.invert(input, kind, answer);
        }
        self.require(query.requires())?;
        if let Query::Acceleration(..) = query {
            self.update_body_forces();
        }
        if matches!(query, Query::SolveMass) && self.workspace().singular.lane(0) {
            let (time, place) = (self.state.time, massless(self.model(), self.workspace(), 0));
            return Err(Fault::Singular { time, place }.into());
        }
        let input = Vec::from_iter(input.iter().copied().map(T::SingleEnv::splat));
        self.change(answer, |sim, numbers| {
            numbers.clear();
            let computed = (&**sim.model(), sim.params(), sim.workspace());
            T::answer(query, computed, &input, numbers);
        });
        Ok(())
    }
}
