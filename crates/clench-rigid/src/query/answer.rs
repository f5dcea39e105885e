//! The answers of a simulation to the queries of the table.

use super::input::QueryInput;
use super::table::Query;
use crate::Precision;
use crate::sim::Sim;
use clench_dynamics::error::{Fault, SimError};
use clench_dynamics::joint_description::massless;
use clench_math::{Mask, Real, read_lane};

impl<T: Precision> Sim<T> {
    /// Answers a query, in the state of [`refresh`](Self::refresh); inverse dynamics are those of the present state.
    /// The answer replaces the content of `answer`.
    ///
    /// # Errors
    /// Returns an error if there is no such object, if the number of input values is wrong or one is not finite, if the
    /// mass matrix is singular, or as [`refresh`](Self::refresh) does.
    pub fn answer(
        &mut self,
        query: Query<'_>,
        input: &[T],
        answer: &mut Vec<T>,
    ) -> Result<(), SimError> {
        query.check(self.model(), &QueryInput::Shared(input), 1)?;
        self.compute(query, input)?;
        answer.clear();
        answer.extend(self.numbers().iter().map(|number| number.lane(0)));
        Ok(())
    }

    /// Writes the answer to a query whose arguments are checked.
    pub(super) fn write_answer(
        &mut self,
        query: Query<'_>,
        input: &[T],
        answer: &mut [T],
    ) -> Result<(), SimError> {
        self.compute(query, input)?;
        read_lane(self.numbers(), 0, answer);
        Ok(())
    }

    /// Leaves the answer in [`numbers`](Self::numbers).
    fn compute(&mut self, query: Query<'_>, input: &[T]) -> Result<(), SimError> {
        let input = Vec::from_iter(input.iter().copied().map(T::SingleEnv::splat));
        if let Query::Inverse(kind) = query {
            return self.invert(&input, kind);
        }
        self.require(query.requires())?;
        if let Query::Acceleration(..) = query {
            self.update_body_forces();
        }
        if matches!(query, Query::SolveMass) && self.workspace().singular.lane(0) {
            let (time, place) = (self.state.time, massless(self.model(), self.workspace(), 0));
            return Err(Fault::Singular { time, place }.into());
        }
        let mut numbers = std::mem::take(self.numbers());
        numbers.clear();
        let computed = (&**self.model(), self.params(), self.workspace());
        T::answer(query, computed, &input, &mut numbers);
        *self.numbers() = numbers;
        Ok(())
    }
}
