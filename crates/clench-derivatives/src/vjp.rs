//! Gradients of functions of a step's results: products of a row vector, or of several, with the Jacobian of the step.

use crate::linearizer::{Linearization, Linearizer, source};
use crate::matrix::{InputGradient, OutputGradient};
use crate::request::Request;
use crate::source::Source;
use clench_rigid::{Sim, SimError};

impl Linearizer {
    /// Returns the gradients of functions of the next state and y by the input of the step: gₓ A + g_y C, gₓ B + g_y D
    /// and gₓ E + g_y F for gradients gₓ by x⁺ and g_y by y, with the matrices of the
    /// [`Linearization`](crate::Linearization). The state of the simulation does not change.
    ///
    /// # Errors
    /// Returns an error if [`Sim::step`] would return one.
    ///
    /// # Panics
    /// Panics if the simulation has another model, if a parameter does not have a requested number, or if a matrix has
    /// another shape.
    pub fn vjp(
        &mut self,
        sim: &Sim<f64>,
        request: &Request,
        gradient: &OutputGradient,
    ) -> Result<&InputGradient, SimError> {
        let rows = gradient.x.shape[0];
        for (matrix, columns) in [
            (&gradient.x, request.x_len(sim.model())),
            (&gradient.y, request.y_len(sim.model())),
        ] {
            assert_eq!(matrix.shape, [rows, columns], "the shape of a gradient");
            assert_eq!(matrix.values.len(), rows * columns, "a complete matrix");
        }
        let model = self.prepare(sim, &request.parameters)?;
        self.pull_back(source(&model, sim, request), gradient)?;
        Ok(&self.gradient)
    }

    /// Computes the gradients of functions of the next state and y, after [`prepare`](Self::prepare).
    ///
    /// # Errors
    /// Returns an error if the step fails.
    pub(crate) fn pull_back(
        &mut self,
        source: Source<'_>,
        gradient: &OutputGradient,
    ) -> Result<(), SimError> {
        let (model, request) = (source.model, source.request);
        let of_state = request.y_len(model) == 0 && request.p_len() == 0;
        if of_state && request.reads(model).is_some() {
            let result = &mut self.gradient;
            if self.pass.pull_back(source, &gradient.x, result)? {
                return Ok(());
            }
        }
        self.differentiate(source)?;
        let Linearization {
            a, b, c, d, e, f, ..
        } = &self.result;
        let InputGradient { x, u, p } = &mut self.gradient;
        for (product, by_state, by_output) in [(x, a, c), (u, b, d), (p, e, f)] {
            product.reset([gradient.x.shape[0], by_state.shape[1]]);
            product.add_product(&gradient.x, by_state);
            product.add_product(&gradient.y, by_output);
        }
        Ok(())
    }
}
