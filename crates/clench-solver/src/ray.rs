//! A search direction, with its images under M and J.

/// A search direction, and its products for the line search.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ray<T> {
    /// p.
    pub direction: Vec<T>,
    /// M p.
    pub mass_direction: Vec<T>,
    /// J p.
    pub rows: Vec<T>,
    /// The second derivative of the parts that are quadratic everywhere: inertia and equalities.
    pub second: T,
}
