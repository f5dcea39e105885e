//! Problems with their minimum.

use crate::common::{ALL_COSTS, Rng};
use crate::conic::{self, Optimum};
use crate::exact;
use crate::number::{Wide, wide};
use crate::sample::{self, Recipe};
use crate::wide::{WideProblem, dot, half};
use clench_solver::{Problem, Solver};
use num_traits::Float;

/// Each cost separately, and all together.
pub const CLASSES: [&str; 6] = [
    "quadratic",
    "one-sided",
    "Huber",
    "pyramid",
    "elliptic",
    "mixture",
];

/// A problem with its minimum found by Clarabel.
pub struct Reference {
    /// The index in [`CLASSES`].
    pub class: usize,
    pub problem: Problem<f64>,
    wide: WideProblem,
    optimum: Optimum,
    /// The unit of costs: the minimum or, if that is zero, a tiny part of the energy of a_unc.
    unit: Wide,
}

/// The tolerance of Clarabel's enclosure of each minimum.
const ENCLOSED: f64 = 1e-13;

impl Reference {
    fn new(class: usize, problem: Problem<f64>) -> Self {
        let wide = WideProblem::new(&problem);
        let a = &wide.qacc_smooth;
        let energy = half(dot(a, &wide.inertial(a)));
        // Our cost is accurate enough for a unit; the choice of unit does not affect the result.
        let mut solver = Solver::new(problem.tree());
        solver.solve(&problem, &exact(), None).unwrap();
        let cost = wide.cost(&wide.relative(solver.qacc()));
        let unit = cost.max(crate::number::wide(1e-24) * energy);
        let reference = Reference {
            class,
            optimum: conic::minimise(&wide, unit),
            problem,
            wide,
            unit,
        };
        reference.check();
        reference
    }

    /// Checks that the minimum is enclosed, and that the conic program is equivalent to the problem.
    fn check(&self) {
        let Optimum { u, primal, dual } = &self.optimum;
        let enclosed = self.parts(*primal - *dual);
        assert!(enclosed.abs() < ENCLOSED, "Clarabel's gap is {enclosed:e}");
        let defined = self.parts(self.wide.cost(u) - *primal);
        assert!(
            defined.abs() < ENCLOSED,
            "the program differs from the cost by {defined:e}"
        );
    }

    fn parts(&self, cost: Wide) -> f64 {
        (cost / self.unit).to_f64()
    }

    /// Returns a cost relative to the minimum.
    pub fn relative(&self, cost: f64) -> f64 {
        self.parts(wide(cost))
    }

    /// Returns the cost at `a` above the minimum, relative to the minimum.
    pub fn excess(&self, a: &[f64]) -> f64 {
        self.parts(self.wide.cost(&self.wide.relative(a)) - self.optimum.primal)
    }

    /// Returns the minimiser.
    pub fn qacc(&self) -> Vec<f64> {
        self.wide.acceleration(&self.optimum.u)
    }

    /// Returns the constraint forces at the minimum, as they act on the dofs: M (a − a_unc).
    pub fn qfrc_constraint(&self) -> Vec<f64> {
        let inertial = self.wide.inertial(&self.optimum.u);
        inertial.into_iter().map(Wide::to_f64).collect()
    }
}

/// Returns `count` problems from all classes. `mass` and `stiffness` are the largest condition numbers of M and D: a
/// third of the problems have exactly these, the others random ones up to them.
pub fn references(
    seed: u64,
    count: usize,
    mass: f64,
    stiffness: f64,
) -> impl Iterator<Item = Reference> {
    let mut rng = Rng(seed);
    (0..count).map(move |k| {
        let class = k % CLASSES.len();
        Reference::new(
            class,
            draw(&mut rng, class, k / CLASSES.len(), mass, stiffness),
        )
    })
}

/// Draws problem `k` of a class.
pub fn draw(rng: &mut Rng, class: usize, k: usize, mass: f64, stiffness: f64) -> Problem<f64> {
    let mut up_to = |worst: f64| {
        if k.is_multiple_of(3) {
            worst
        } else {
            rng.scale(1.0, worst)
        }
    };
    let recipe = Recipe {
        mass: up_to(mass),
        stiffness: up_to(stiffness),
        costs: ALL_COSTS
            .get(class)
            .map_or(ALL_COSTS.to_vec(), |&cost| vec![cost]),
        scaled: rng.unit() < 0.5,
    };
    sample::problem(rng, &recipe)
}
