//! Problems copied into 106-bit numbers, with the cost by MuJoCo's definitions.

use crate::number::{Wide, wide};
use clench_solver::{Block, Cost, Problem};
use num_traits::Float;

/// The problem in terms of u = a − a_unc.
pub struct WideProblem {
    pub nv: usize,
    /// nv × nv.
    pub mass: Vec<Wide>,
    pub blocks: Vec<WideBlock>,
    pub qacc_smooth: Vec<Wide>,
}

/// A block with a column for every dof.
pub struct WideBlock {
    pub cost: Cost,
    /// dim × nv row-major.
    pub jacobian: Vec<Wide>,
    /// J a_unc − aref.
    pub offset: Vec<Wide>,
    /// For elliptic blocks D₀ (μ_j / μ)², so that the rounding of the stored D_j does not deform the cone.
    pub d: Vec<Wide>,
    pub shape: Vec<Wide>,
}

impl WideProblem {
    pub fn new(problem: &Problem<f64>) -> Self {
        let mass = problem.mass.to_dense(problem.tree());
        let qacc_smooth = widen(&problem.qacc_smooth);
        WideProblem {
            nv: problem.nv(),
            mass: widen(&mass),
            blocks: problem
                .blocks()
                .map(|block| WideBlock::new(&block, &qacc_smooth))
                .collect(),
            qacc_smooth,
        }
    }

    /// Returns a − a_unc.
    pub fn relative(&self, a: &[f64]) -> Vec<Wide> {
        let pairs = a.iter().zip(&self.qacc_smooth);
        pairs.map(|(&a, &b)| wide(a) - b).collect()
    }

    /// Returns a_unc + u, rounded.
    pub fn acceleration(&self, u: &[Wide]) -> Vec<f64> {
        let pairs = u.iter().zip(&self.qacc_smooth);
        pairs.map(|(&u, &b)| (u + b).to_f64()).collect()
    }

    /// Returns M u.
    pub fn inertial(&self, u: &[Wide]) -> Vec<Wide> {
        let rows = self.mass.chunks_exact(self.nv);
        rows.map(|row| dot(row, u)).collect()
    }

    /// Returns the cost at a_unc + u.
    pub fn cost(&self, u: &[Wide]) -> Wide {
        let constraints = self
            .blocks
            .iter()
            .map(|block| block.cost(&block.residual(u)));
        half(dot(u, &self.inertial(u))) + constraints.sum::<Wide>()
    }
}

impl WideBlock {
    fn new(block: &Block<f64>, qacc_smooth: &[Wide]) -> Self {
        let (nv, ndof) = (qacc_smooth.len(), block.dofs.len());
        let mut jacobian = vec![wide(0.0); block.dim * nv];
        for i in 0..block.dim {
            for (k, &dof) in block.dofs.iter().enumerate() {
                jacobian[i * nv + dof as usize] = wide(block.jacobian[i * ndof + k]);
            }
        }
        let shape = widen(block.shape);
        let mut d = widen(block.d);
        if block.cost == Cost::Elliptic {
            for j in 1..block.dim {
                d[j] = d[0] * square(shape[j] / shape[0]);
            }
        }
        let rows = jacobian.chunks_exact(nv).zip(block.aref);
        WideBlock {
            cost: block.cost,
            offset: rows
                .map(|(row, &aref)| dot(row, qacc_smooth) - wide(aref))
                .collect(),
            jacobian,
            d,
            shape,
        }
    }

    /// Returns y at a_unc + u.
    pub fn residual(&self, u: &[Wide]) -> Vec<Wide> {
        let rows = self.jacobian.chunks_exact(u.len()).zip(&self.offset);
        rows.map(|(row, &offset)| dot(row, u) + offset).collect()
    }

    /// Returns s(y), as defined in MuJoCo's documentation.
    fn cost(&self, y: &[Wide]) -> Wide {
        let zero = wide(0.0);
        let (d, shape) = (&self.d, &self.shape);
        let sum = |term: &dyn Fn(usize) -> Wide| (0..y.len()).map(term).sum::<Wide>();
        match self.cost {
            Cost::Quadratic => half(sum(&|i| d[i] * square(y[i]))),
            Cost::OneSided => half(sum(&|i| d[i] * square(y[i].min(zero)))),
            Cost::Huber => sum(&|i| {
                if y[i].abs() <= shape[i] / d[i] {
                    half(d[i] * square(y[i]))
                } else {
                    shape[i] * y[i].abs() - half(square(shape[i]) / d[i])
                }
            }),
            Cost::Pyramid => {
                let edge = |y: Wide| half(d[0] * square(y.min(zero)));
                let pair = |j: usize| edge(y[0] + shape[j] * y[j]) + edge(y[0] - shape[j] * y[j]);
                (1..y.len()).map(pair).sum()
            }
            Cost::Elliptic => {
                let mu = shape[0];
                let n = mu * y[0];
                let squares = (1..y.len()).map(|j| square(shape[j] * y[j]));
                let t = squares.sum::<Wide>().sqrt();
                if n >= mu * t {
                    zero
                } else if mu * n + t <= zero {
                    half(sum(&|i| d[i] * square(y[i])))
                } else {
                    half(d[0] / (square(mu) * (wide(1.0) + square(mu))) * square(n - mu * t))
                }
            }
            Cost::Coulomb => unreachable!("Coulomb's law is not a convex problem"),
        }
    }
}

pub fn widen(x: &[f64]) -> Vec<Wide> {
    x.iter().map(|&x| wide(x)).collect()
}

pub fn half(x: Wide) -> Wide {
    wide(0.5) * x
}

fn square(x: Wide) -> Wide {
    x * x
}

pub fn dot(x: &[Wide], y: &[Wide]) -> Wide {
    x.iter().zip(y).map(|(&x, &y)| x * y).sum()
}
