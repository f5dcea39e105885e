//! Directional derivatives: products of a vector, or of several, with the Jacobian of a step, without its matrices.

use crate::direction::Direction;
use crate::linearizer::{Linearizer, Request, source};
use crate::matrix::{InputTangent, Matrix, OutputTangent};
use crate::seed::Seed;
use clench_rigid::{Model, Sim, SimError};
use std::ops::Range;

impl Linearizer {
    /// Returns the directional derivatives of the next step of a simulation of the model, whose state does not change:
    /// A dx + B du + E dp and C dx + D du + F dp of its [`Linearization`](crate::Linearization), at the cost of the
    /// passes that the columns of the tangent need. A pass has 8 to 16 columns.
    ///
    /// # Errors
    /// Returns an error if [`Sim::step`] would return one.
    ///
    /// # Panics
    /// Panics if the simulation has another model, if a parameter does not have a requested number, or if a matrix has
    /// another shape.
    pub fn jvp(
        &mut self,
        sim: &Sim<f64>,
        request: &Request,
        tangent: &InputTangent,
    ) -> Result<&OutputTangent, SimError> {
        let columns = tangent.columns(sim.model(), request);
        let model = self.prepare(sim, &request.parameters)?;
        let mut source = source(&model, sim, &request.outputs);
        let mut end = 0;
        let mut reuses = false;
        while end < columns {
            let first = end;
            end = columns.min(first + self.pass.directions());
            self.seeds.clear();
            tangent.push_seeds(&model, request, first..end, &mut self.seeds);
            reuses = self.run_pass(&mut source, columns, first..end, reuses)?;
        }
        let nx = 2 * model.nv + model.na;
        let widths = request.outputs.iter().map(|output| output.width(&model));
        let ny = model.nsensordata() + widths.sum::<usize>();
        let OutputTangent { x, y } = &mut self.along;
        let (by_state, by_output) = self.all.split_at(nx * columns);
        for (matrix, rows, values) in [(x, nx, by_state), (y, ny, by_output)] {
            matrix.reset([rows, columns]);
            matrix.values.copy_from_slice(values);
        }
        Ok(&self.along)
    }
}

impl InputTangent {
    /// Returns the number of columns.
    fn columns(&self, model: &Model, request: &Request) -> usize {
        let columns = self.x.shape[1];
        for (matrix, rows) in [
            (&self.x, 2 * model.nv + model.na),
            (&self.u, model.nu()),
            (&self.p, request.parameters.len()),
        ] {
            assert_eq!(matrix.shape, [rows, columns], "the shape of a tangent");
            assert_eq!(matrix.values.len(), rows * columns, "a complete matrix");
        }
        columns
    }

    /// Appends the seeds of some columns: numbers of one parameter follow each other.
    fn push_seeds(
        &self,
        model: &Model,
        request: &Request,
        columns: Range<usize>,
        seeds: &mut Vec<Seed>,
    ) {
        let nv = model.nv;
        let state = |row: usize| match row {
            row if row < nv => Direction::Position(row),
            row if row < 2 * nv => Direction::Velocity(row - nv),
            row => Direction::Activation(row - 2 * nv),
        };
        let parameter = |row: usize| {
            let (field, index) = request.parameters[row];
            Direction::Parameter(field, index)
        };
        let mut push = |matrix: &Matrix, direction: &dyn Fn(usize) -> Direction| {
            let width = matrix.shape[1].max(1);
            for (row, values) in matrix.values.chunks_exact(width).enumerate() {
                let rates = values[columns.clone()].iter().enumerate();
                seeds.extend(
                    rates
                        .filter(|&(_, &rate)| rate != 0.0)
                        .map(|(slot, &rate)| {
                            let direction = direction(row);
                            Seed {
                                slot,
                                direction,
                                rate,
                            }
                        }),
                );
            }
        };
        push(&self.x, &state);
        push(&self.u, &Direction::Control);
        push(&self.p, &parameter);
    }
}
