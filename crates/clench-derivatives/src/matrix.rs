//! Matrices, and the tangents that consist of them.

/// A row-major matrix.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Matrix {
    /// The number of rows and of columns.
    pub shape: [usize; 2],
    /// The numbers, row after row.
    pub values: Vec<f64>,
}

impl Matrix {
    pub(crate) fn reset(&mut self, shape: [usize; 2]) {
        self.shape = shape;
        self.values.clear();
        self.values.resize(shape[0] * shape[1], 0.0);
    }
}

/// Changes dx, du and dp of the input of a step, one column for each direction; see
/// [`Linearization`](crate::Linearization).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InputTangent {
    /// dx, 2 nv + na rows.
    pub x: Matrix,
    /// du, nu rows.
    pub u: Matrix,
    /// dp, one row for each requested parameter.
    pub p: Matrix,
}

/// Changes dx⁺ and dy of the results of a step, one column for each direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutputTangent {
    /// dx⁺, 2 nv + na rows.
    pub x: Matrix,
    /// dy, nsensordata rows, then those of the requested outputs.
    pub y: Matrix,
}
