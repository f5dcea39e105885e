//! The input values of a query.

use clench_dynamics::check::{check_length, check_values};
use clench_dynamics::error::SimError;
use clench_math::Scalar;

/// Input values of a query.
#[derive(Clone, Copy, Debug)]
pub enum QueryInput<'a, S> {
    /// The same values for all environments.
    Shared(&'a [S]),
    /// Separate values for each environment, one after the other.
    Each(&'a [S]),
}

impl<S: Scalar> QueryInput<'_, S> {
    /// Returns all values.
    pub(crate) fn all(&self) -> &[S] {
        match self {
            QueryInput::Shared(values) | QueryInput::Each(values) => values,
        }
    }

    /// Returns the number of values per environment.
    pub(crate) fn width(&self, count: usize) -> usize {
        match self {
            QueryInput::Shared(values) => values.len(),
            QueryInput::Each(values) => values.len() / count.max(1),
        }
    }

    /// Returns the values of an environment, of which there are `width`.
    pub(crate) fn row(&self, env: usize, width: usize) -> &[S] {
        match self {
            QueryInput::Shared(values) => values,
            QueryInput::Each(values) => &values[env * width..][..width],
        }
    }

    /// Checks for `width` finite values for each of `count` environments.
    pub(crate) fn check(
        &self,
        name: &'static str,
        width: usize,
        count: usize,
    ) -> Result<(), SimError> {
        let total = match self {
            QueryInput::Shared(_) => width,
            QueryInput::Each(_) => width.saturating_mul(count),
        };
        check_values(name, self.all(), total)
    }

    /// Checks that all `count` environments have the same number of values, and returns it.
    pub(crate) fn checked_width(
        &self,
        name: &'static str,
        count: usize,
    ) -> Result<usize, SimError> {
        let width = self.width(count);
        if let QueryInput::Each(values) = self {
            check_length(name, values.len(), width * count)?;
        }
        Ok(width)
    }
}
