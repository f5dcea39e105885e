//! Errors of convex hulls.

/// An error in the computation of a convex hull.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HullError {
    /// Fewer than four points.
    #[error("a convex hull needs at least four points, not {0}")]
    TooFew(usize),
    /// Too many points to index.
    #[error("{0} points are too many for a convex hull")]
    TooMany(usize),
    /// A coordinate is not finite or beyond 1e60 m.
    #[error("point {0} has a coordinate that is not a number, or too large")]
    NotFinite(usize),
    /// All points coincide.
    #[error("all points coincide: they have no convex hull (a small sphere may serve instead)")]
    Point,
    /// All points lie on a line.
    #[error(
        "all points lie on a line: they have no convex hull (a thin capsule may serve instead)"
    )]
    Line,
    /// All points lie in a plane.
    #[error(
        "all points lie in a plane: their convex hull has no volume (a plane or a thin box may serve instead)"
    )]
    Plane,
    /// The allowed number of vertices is less than four.
    #[error("a convex hull has at least four vertices, but only {0} are allowed")]
    Bound(usize),
    /// The computed surface is not closed.
    #[error("the convex hull is not closed: please report the points")]
    Broken,
}
