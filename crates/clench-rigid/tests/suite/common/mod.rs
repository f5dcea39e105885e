//! Helpers of this crate's tests: building simulations, and reproducible numbers.

use clench_rigid::builder::{MeshSpec, ModelBuilder};
use clench_rigid::dynamics::integrate::integrate_positions;
use clench_rigid::{Model, Sim};
use std::sync::Arc;

pub fn model(builder: &ModelBuilder) -> Arc<Model> {
    Arc::new(builder.build().expect("the description is a model"))
}

pub fn sim(builder: &ModelBuilder) -> Sim {
    Sim::new(model(builder)).expect("the model can be simulated")
}

/// Moves every joint by random amounts up to `scale`, rad or m.
pub fn turn(sim: &mut Sim, numbers: &mut Numbers, scale: f64) {
    let mut turn = vec![0.0; sim.model().nv];
    numbers.fill(&mut turn, scale);
    let model = Arc::clone(sim.model());
    integrate_positions(&model, &mut sim.state.qpos, &turn, 1.0);
}

/// Reproducible numbers in (−1, 1).
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f64 {
        self.0 = (self.0)
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    pub fn fill(&mut self, out: &mut [f64], scale: f64) {
        for x in out {
            *x = scale * self.next();
        }
    }
}

/// Returns two tetrahedra that share a corner. They are not convex: the hull contains air between them.
pub fn hourglass() -> MeshSpec {
    let vertices = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 1.0],
        [-1.0, 1.0, 1.0],
        [-1.0, -1.0, 1.0],
        [1.0, 0.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, -1.0],
    ];
    let upper = [[1, 2, 3], [0, 2, 1], [0, 3, 2], [0, 1, 3]];
    let lower = [[4, 6, 5], [0, 4, 5], [0, 5, 6], [0, 6, 4]];
    MeshSpec::triangles("hourglass", &vertices, &[upper, lower].concat())
}
