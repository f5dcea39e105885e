//! Directional derivatives: products of a vector, or of several, with the Jacobian of a step, without its matrices.

use crate::direction::{self, Direction};
use crate::linearizer::{Linearization, Linearizer, source};
use crate::matrix::{InputTangent, OutputTangent, split_index};
use crate::request::Request;
use crate::seed::Seed;
use clench_rigid::{Model, Sim, SimError};
use std::ops::Range;

impl Linearizer {
    /// Returns the directional derivatives of the next step of a simulation of the model, whose state does not change:
    /// A dx + B du + E dp and C dx + D du + F dp of its [`Linearization`](crate::Linearization), at the cost of A and
    /// B if recursions give them, else of the passes that the columns of the tangent need. A pass has 8 to 16 columns.
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
        let mut source = source(&model, sim, request);
        let (nx, ny) = (request.x_len(&model), request.y_len(&model));
        self.along.x.reset([nx, columns]);
        self.along.y.reset([ny, columns]);
        // The matrices are found in less time than a pass needs, but sensors need a pass.
        let permitted = ny == 0 && request.reads(&model).is_some();
        let recursed = permitted && self.recurse(source)?;
        direction::list(&model, &sim.state, request, &mut self.directions);
        if recursed {
            let Linearization { a, b, .. } = &self.result;
            self.along.x.add_product(a, &tangent.x);
            self.along.x.add_product(b, &tangent.u);
            let others = nx + model.nu();
            self.directions.retain(|&(_, row)| row >= others);
            if self.directions.is_empty() {
                return Ok(&self.along);
            }
        }
        self.all.clear();
        let mut end = 0;
        let mut reuses = false;
        while end < columns {
            let first = end;
            end = columns.min(first + self.pass.directions());
            self.seeds.clear();
            tangent.push_seeds(&self.directions, first..end, &mut self.seeds);
            reuses = self.run_pass(&mut source, columns, first..end, reuses)?;
        }
        let (by_state, by_output) = self.all.split_at(nx * columns);
        for (x, rate) in self.along.x.values.iter_mut().zip(by_state) {
            *x += rate;
        }
        self.along.y.values.copy_from_slice(by_output);
        Ok(&self.along)
    }
}

impl InputTangent {
    /// Returns the number of columns.
    fn columns(&self, model: &Model, request: &Request) -> usize {
        let columns = self.x.shape[1];
        for (matrix, rows) in [
            (&self.x, request.x_len(model)),
            (&self.u, model.nu()),
            (&self.p, request.p_len()),
        ] {
            assert_eq!(matrix.shape, [rows, columns], "the shape of a tangent");
            assert_eq!(matrix.values.len(), rows * columns, "a complete matrix");
        }
        columns
    }

    /// Appends the seeds of some columns, by the directions of the rows of x, u and p.
    fn push_seeds(
        &self,
        directions: &[(Direction, usize)],
        columns: Range<usize>,
        seeds: &mut Vec<Seed>,
    ) {
        for &(direction, row) in directions {
            let (part, row) = split_index(row, [&self.x, &self.u].map(|matrix| matrix.shape[0]));
            let matrix = [&self.x, &self.u, &self.p][part];
            let rates = &matrix.values[row * matrix.shape[1]..][columns.clone()];
            let rates = rates.iter().enumerate().filter(|&(_, &rate)| rate != 0.0);
            seeds.extend(rates.map(|(slot, &rate)| Seed {
                slot,
                direction,
                rate,
            }));
        }
    }
}
