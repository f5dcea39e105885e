//! Matrices, and the tangents and gradients that consist of them.

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

    /// Adds the product of two matrices.
    pub(crate) fn add_product(&mut self, a: &Matrix, b: &Matrix) {
        let ([_, inner], [_, columns]) = (a.shape, b.shape);
        let rows = self.values.chunks_exact_mut(columns.max(1));
        for (out, factors) in rows.zip(a.values.chunks_exact(inner.max(1))) {
            b.add_row_product(factors, out);
        }
    }

    /// Adds the product of a row vector and this matrix to `out`.
    pub(crate) fn add_row_product(&self, factors: &[f64], out: &mut [f64]) {
        let rows = self.values.chunks_exact(self.shape[1].max(1));
        for (&factor, row) in factors.iter().zip(rows) {
            for (out, &x) in out.iter_mut().zip(row) {
                *out += factor * x;
            }
        }
    }
}

/// Changes dx, du and dp of the input of a step, one column for each direction; see
/// [`Linearization`](crate::Linearization).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InputTangent {
    /// dx, 2 nv + na rows, more with [`Request::memory`](crate::Request::memory).
    pub x: Matrix,
    /// du, nu rows.
    pub u: Matrix,
    /// dp, one row for each requested number of parameters, then of inputs.
    pub p: Matrix,
}

/// Changes dx⁺ and dy of the results of a step, one column for each direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutputTangent {
    /// dx⁺, as many rows as dx.
    pub x: Matrix,
    /// dy, nsensordata rows, then those of the requested outputs.
    pub y: Matrix,
}

/// The derivatives of functions by the results of a step, one row for each function.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutputGradient {
    /// By x⁺, 2 nv + na columns, more with [`Request::memory`](crate::Request::memory).
    pub x: Matrix,
    /// By y, nsensordata columns, then those of the requested outputs.
    pub y: Matrix,
}

/// The derivatives of functions by the input of a step, one row for each function.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InputGradient {
    /// By x, as many columns as by x⁺.
    pub x: Matrix,
    /// By u, nu columns.
    pub u: Matrix,
    /// By p, one column for each requested number of parameters, then of inputs.
    pub p: Matrix,
}

/// The gradient of a function of the states after each step of a rollout.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RolloutGradient {
    /// By the first x, with one row.
    pub x: Matrix,
    /// By the controls, one row for each step.
    pub u: Matrix,
}

/// Returns the part of (x, u, p) to which an index of all their numbers belongs, and its index there.
pub(crate) fn split_index(index: usize, [nx, nu]: [usize; 2]) -> (usize, usize) {
    match index.checked_sub(nx) {
        None => (0, index),
        Some(index) if index < nu => (1, index),
        Some(index) => (2, index - nu),
    }
}
