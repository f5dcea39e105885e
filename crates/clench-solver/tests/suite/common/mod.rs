//! Random problems, and a second implementation of the costs, as simple as possible.

use clench_solver::{Block, Cost, Problem, Tree, TreeMatrix};
use std::sync::Arc;

/// A small seeded generator (SplitMix64) with the same output on every machine.
pub struct Rng(pub u64);

impl Rng {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    /// Returns a uniform number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }
    /// Returns a log-uniform number.
    pub fn scale(&mut self, low: f64, high: f64) -> f64 {
        (self.range(low.ln(), high.ln())).exp()
    }
}

/// The parameters of a random problem.
#[derive(Clone)]
pub struct Shape {
    /// The parent of each dof.
    pub parents: Vec<Option<usize>>,
    pub blocks: usize,
    pub costs: Vec<Cost>,
    /// The range of D.
    pub stiffness: (f64, f64),
    /// The fraction of blocks that couple two branches.
    pub cross: f64,
}

/// The costs whose problem is convex: all except Coulomb's law.
pub const ALL_COSTS: [Cost; 5] = [
    Cost::Quadratic,
    Cost::OneSided,
    Cost::Huber,
    Cost::Pyramid,
    Cost::Elliptic,
];

impl Shape {
    pub fn new(parents: Vec<Option<usize>>, blocks: usize) -> Self {
        Shape {
            parents,
            blocks,
            costs: ALL_COSTS.to_vec(),
            stiffness: (1.0, 1e4),
            cross: 0.2,
        }
    }

    /// A heap of free bodies, most of which touch; with few contacts it splits into several heaps.
    pub fn heap(bodies: usize, contacts: usize) -> Self {
        let parent = |i: usize| (!i.is_multiple_of(6)).then(|| i - 1);
        Shape {
            cross: 0.9,
            ..Shape::new((0..6 * bodies).map(parent).collect(), contacts)
        }
    }
}

/// Returns a free root of six dofs, a spine of three, and four limbs: 23 dofs numbered depth first.
pub fn humanoid() -> Vec<Option<usize>> {
    let mut parents: Vec<Option<usize>> = (0..9).map(|i: usize| i.checked_sub(1)).collect();
    for (root, length) in [(8, 4), (8, 4), (6, 3), (6, 3)] {
        for k in 0..length {
            let next = parents.len();
            parents.push(Some(if k == 0 { root } else { next - 1 }));
        }
    }
    parents
}

/// Returns a forest with random branching.
pub fn random_forest(rng: &mut Rng, nv: usize) -> Vec<Option<usize>> {
    (0..nv)
        .map(|i| match i {
            0 => None,
            _ if rng.unit() < 0.1 => None,
            _ if rng.unit() < 0.7 => Some(i - 1),
            _ => Some(rng.below(i)),
        })
        .collect()
}

pub fn random_problem(rng: &mut Rng, shape: &Shape) -> Problem<f64> {
    let tree = Arc::new(Tree::new(&shape.parents).unwrap());
    let mut problem = Problem::new(tree.clone());
    problem.mass = random_mass(rng, &tree);
    assert!(problem.factor_mass());
    for a in &mut problem.qacc_smooth {
        *a = rng.range(-10.0, 10.0);
    }
    for _ in 0..shape.blocks {
        push_random_block(rng, shape, &tree, &mut problem);
    }
    problem.check().unwrap();
    problem
}

/// Returns M = LᵀDL with L and D random: positive definite, with the sparsity pattern of the tree.
fn random_mass(rng: &mut Rng, tree: &Tree) -> TreeMatrix<f64> {
    let nv = tree.nv();
    let mut mass = TreeMatrix::zeros(tree);
    for k in 0..nv {
        let d = rng.scale(0.05, 5.0);
        let row = tree.row(k);
        let l: Vec<f64> = row
            .iter()
            .map(|&c| {
                if c as usize == k {
                    1.0
                } else {
                    rng.range(-0.6, 0.6)
                }
            })
            .collect();
        for (j, &i) in row.iter().enumerate() {
            for (c, value) in mass.row_mut(tree, i as usize).iter_mut().enumerate() {
                *value += d * l[j] * l[c];
            }
        }
    }
    mass
}

fn push_random_block(rng: &mut Rng, shape: &Shape, tree: &Tree, problem: &mut Problem<f64>) {
    let cost = shape.costs[rng.below(shape.costs.len())];
    let dim = match cost {
        Cost::Quadratic => [1, 3, 6][rng.below(3)],
        Cost::OneSided | Cost::Huber => 1,
        Cost::Pyramid | Cost::Elliptic | Cost::Coulomb => [2, 3, 4, 6][rng.below(4)],
    };
    push_block(rng, shape, tree, problem, cost, dim);
}

/// Adds contacts of one kind, like those of a standing robot.
pub fn push_contacts(
    rng: &mut Rng,
    shape: &Shape,
    problem: &mut Problem<f64>,
    cost: Cost,
    dim: usize,
    count: usize,
) {
    let tree = problem.tree().clone();
    for _ in 0..count {
        push_block(rng, shape, &tree, problem, cost, dim);
    }
}

fn push_block(
    rng: &mut Rng,
    shape: &Shape,
    tree: &Tree,
    problem: &mut Problem<f64>,
    cost: Cost,
    dim: usize,
) {
    let nv = tree.nv();
    let mut dofs = tree.row(rng.below(nv)).to_vec();
    if rng.unit() < shape.cross {
        dofs.extend_from_slice(tree.row(rng.below(nv)));
        dofs.sort_unstable();
        dofs.dedup();
    }
    let block = problem.push(cost, dim, &dofs);
    for j in block.jacobian {
        *j = rng.range(-1.0, 1.0);
    }
    for aref in block.aref {
        *aref = rng.range(-20.0, 20.0);
    }
    let d0 = rng.scale(shape.stiffness.0, shape.stiffness.1);
    block.d.fill(d0);
    match cost {
        Cost::Huber => block
            .shape
            .iter_mut()
            .for_each(|eta| *eta = rng.scale(0.1, 10.0)),
        Cost::Pyramid => block.shape[1..]
            .iter_mut()
            .for_each(|mu| *mu = rng.range(0.2, 1.5)),
        Cost::Elliptic => {
            block.shape[1..]
                .iter_mut()
                .for_each(|mu| *mu = rng.range(0.2, 1.5));
            block.shape[0] = block.shape[1] * rng.scale(0.3, 1.5);
            for j in 1..dim {
                block.d[j] = d0 * (block.shape[j] / block.shape[0]).powi(2);
            }
        }
        Cost::Coulomb => {
            block.shape[1..]
                .iter_mut()
                .for_each(|mu| *mu = rng.range(0.2, 1.5));
            block.d[1..].fill(d0 * rng.scale(1.0, 10.0));
            for j in 2..dim {
                block.d[j] = block.d[1] * (block.shape[j] / block.shape[1]).powi(2);
            }
        }
        Cost::Quadratic | Cost::OneSided => {}
    }
    for (r, d) in block.r.iter_mut().zip(&*block.d) {
        *r = 1.0 / d;
    }
}

/// Returns y = J a − aref of one block.
pub fn residual(block: &Block<f64>, a: &[f64]) -> Vec<f64> {
    let n = block.dofs.len();
    (0..block.dim)
        .map(|i| {
            let row = &block.jacobian[i * n..(i + 1) * n];
            row.iter()
                .zip(block.dofs)
                .map(|(j, &dof)| j * a[dof as usize])
                .sum::<f64>()
                - block.aref[i]
        })
        .collect()
}

/// Returns the cost and force of one block, by the definitions in MuJoCo's documentation.
pub fn cost_and_force(block: &Block<f64>, y: &[f64]) -> (f64, Vec<f64>) {
    let one_sided = |d: f64, y: f64| {
        if y < 0.0 {
            (0.5 * d * y * y, -d * y)
        } else {
            (0.0, 0.0)
        }
    };
    let mut force = vec![0.0; block.dim];
    let mut cost = 0.0;
    match block.cost {
        Cost::Quadratic => {
            for i in 0..block.dim {
                cost += 0.5 * block.d[i] * y[i] * y[i];
                force[i] = -block.d[i] * y[i];
            }
        }
        Cost::OneSided => {
            for i in 0..block.dim {
                let (s, f) = one_sided(block.d[i], y[i]);
                cost += s;
                force[i] = f;
            }
        }
        Cost::Huber => {
            for i in 0..block.dim {
                let (eta, r, y) = (block.shape[i], block.r[i], y[i]);
                if y.abs() < r * eta {
                    cost += 0.5 * y * y / r;
                    force[i] = -y / r;
                } else {
                    cost += eta * y.abs() - 0.5 * r * eta * eta;
                    force[i] = -eta * y.signum();
                }
            }
        }
        Cost::Pyramid => {
            for j in 1..block.dim {
                for sign in [1.0, -1.0] {
                    let mu = sign * block.shape[j];
                    let (s, f) = one_sided(block.d[0], y[0] + mu * y[j]);
                    cost += s;
                    force[0] += f;
                    force[j] += mu * f;
                }
            }
        }
        Cost::Elliptic => {
            let mu = block.shape[0];
            let n = mu * y[0];
            let t = (1..block.dim)
                .map(|j| (block.shape[j] * y[j]).powi(2))
                .sum::<f64>()
                .sqrt();
            if n >= mu * t {
            } else if mu * n + t <= 0.0 {
                for i in 0..block.dim {
                    cost += 0.5 * block.d[i] * y[i] * y[i];
                    force[i] = -block.d[i] * y[i];
                }
            } else {
                let dm = block.d[0] / (mu * mu * (1.0 + mu * mu));
                cost = 0.5 * dm * (n - mu * t).powi(2);
                force[0] = -dm * (n - mu * t) * mu;
                for j in 1..block.dim {
                    force[j] = -force[0] / t * block.shape[j] * y[j] * block.shape[j];
                }
            }
        }
        // Coulomb's law has a force but no cost.
        Cost::Coulomb => {
            force[0] = one_sided(block.d[0], y[0]).1;
            let share = |j: usize| block.d[j] * y[j] / block.shape[j];
            let size = norm(&(1..block.dim).map(share).collect::<Vec<_>>());
            for j in 1..block.dim {
                force[j] = -block.d[j] * y[j] * (force[0] / size).min(1.0);
            }
        }
    }
    (cost, force)
}

/// Returns the total cost at `a` and its gradient, by the definitions.
pub fn cost_and_gradient(problem: &Problem<f64>, a: &[f64]) -> (f64, Vec<f64>) {
    let nv = problem.nv();
    let difference: Vec<f64> = a
        .iter()
        .zip(&problem.qacc_smooth)
        .map(|(a, b)| a - b)
        .collect();
    let mass = problem.mass.to_dense(problem.tree());
    let mut gradient: Vec<f64> = (0..nv)
        .map(|i| (0..nv).map(|j| mass[i * nv + j] * difference[j]).sum())
        .collect();
    let mut cost = 0.5
        * difference
            .iter()
            .zip(&gradient)
            .map(|(a, b)| a * b)
            .sum::<f64>();
    for block in problem.blocks() {
        let y = residual(&block, a);
        let (s, force) = cost_and_force(&block, &y);
        cost += s;
        for (i, f) in force.iter().enumerate() {
            for (k, &dof) in block.dofs.iter().enumerate() {
                gradient[dof as usize] -= f * block.jacobian[i * block.dofs.len() + k];
            }
        }
    }
    (cost, gradient)
}

pub fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Returns |x − y| / max(|x|, |y|).
pub fn difference(x: &[f64], y: &[f64]) -> f64 {
    let d: Vec<f64> = x.iter().zip(y).map(|(x, y)| x - y).collect();
    norm(&d) / norm(x).max(norm(y)).max(f64::MIN_POSITIVE)
}

/// Asserts that the constraint can exert the force.
pub fn assert_in_cone(block: &Block<f64>, f: &[f64]) {
    let slack = 1e-12 * norm(f);
    let along = |j: usize| f[j].abs() / block.shape[j];
    let inside = match block.cost {
        Cost::Quadratic => true,
        Cost::OneSided => f.iter().all(|&f| f >= 0.0),
        Cost::Huber => f
            .iter()
            .zip(block.shape)
            .all(|(f, eta)| f.abs() <= eta + slack),
        Cost::Pyramid => (1..block.dim).map(along).sum::<f64>() <= f[0] + slack,
        Cost::Elliptic | Cost::Coulomb => {
            let squares: f64 = (1..block.dim).map(|j| along(j).powi(2)).sum();
            squares.sqrt() <= f[0] + slack
        }
    };
    assert!(inside, "{:?} {f:?}", block.cost);
}
