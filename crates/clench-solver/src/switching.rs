//! The distance of constraints from a change of their piece, where the force has no derivative.

use crate::block_index::BlockIndex;
use crate::costs::{Cost, MAX_DIM, Rows};
use crate::problem::Problem;
use clench_math::{Real, Scalar};

impl<T: Real> Problem<T> {
    /// Writes for each row, or edge of a pyramid, the distance of J a − aref from the nearest point at which the cost
    /// of its block changes piece, in the units of the row or of the first row of a contact (m/s², rad/s²); infinite
    /// if none changes. Blocks that do not act, and terms of the metric, have none. Only the first lane is read.
    ///
    /// # Panics
    /// Panics if `qacc` has another length than nv.
    pub fn switching_distances(&self, qacc: &[T], out: &mut Vec<f64>) {
        assert_eq!(qacc.len(), self.nv(), "one acceleration for each dof");
        out.clear();
        let acts = |b: &&BlockIndex| number(self.d[b.row]) > 0.0;
        for b in self.constraints_and_terms().0.iter().filter(acts) {
            let mut y = [0.0; MAX_DIM];
            let (dofs, jacobian) = (self.jacobian.dofs(b), self.jacobian.values(b));
            for (i, y) in y[..b.dim].iter_mut().enumerate() {
                let row = &jacobian[i * dofs.len()..][..dofs.len()];
                let terms = dofs.iter().zip(row);
                let sum: f64 = terms
                    .map(|(&dof, &j)| number(j) * number(qacc[dof as usize]))
                    .sum();
                *y = sum - number(self.aref[b.row + i]);
            }
            self.push_distances(b, &y[..b.dim], out);
        }
    }

    /// Appends the distances of the rows of a block.
    fn push_distances(&self, b: &BlockIndex, y: &[f64], out: &mut Vec<f64>) {
        let Rows { d, r, shape, .. } = self.rows(b);
        let shape = |i: usize| number(shape[i]);
        // T, the slip in coordinates in which the cone is circular.
        let slip = || {
            let squares = (1..y.len()).map(|i| (shape(i) * y[i]).powi(2));
            squares.sum::<f64>().sqrt()
        };
        match b.cost {
            Cost::Quadratic => out.extend(y.iter().map(|_| f64::INFINITY)),
            Cost::OneSided => out.extend(y.iter().map(|y| y.abs())),
            Cost::Huber => {
                let rows = y.iter().zip(r).enumerate();
                out.extend(rows.map(|(i, (y, &r))| (y.abs() - number(r) * shape(i)).abs()));
            }
            Cost::Pyramid => {
                let edges = (1..y.len()).flat_map(|i| [shape(i) * y[i], -shape(i) * y[i]]);
                out.extend(edges.map(|friction| (y[0] + friction).abs()));
            }
            Cost::Elliptic => {
                // N = μT and μN + T = 0 bound the zones.
                let (mu, slip) = (shape(0), slip());
                let normal = mu * y[0];
                let nearest = (normal - mu * slip).abs().min((mu * normal + slip).abs());
                out.extend(y.iter().map(|_| nearest / mu));
            }
            Cost::Coulomb => {
                // Friction reaches its limit μ f at the slip f R.
                let force = number(d[0]) * (-y[0]).max(0.0);
                let limit = force * number(r[1]) * shape(1) * shape(1);
                let nearest = y[0].abs().min((slip() - limit).abs());
                out.extend(y.iter().map(|_| nearest));
            }
        }
    }
}

fn number<T: Real>(x: T) -> f64 {
    x.lane(0).to_f64()
}
