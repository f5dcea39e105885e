//! Random numbers, models and options that tests share.

use clench_rigid::Model;
use clench_rigid::options::{FrictionCone, RigidOptions};
use std::path::Path;

/// Random numbers in [−1, 1].
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = (self.0)
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 33) as f64 / f64::from(1 << 30) - 1.0
    }
}

/// Loads a model of the repository.
pub(crate) fn load(name: &str) -> Model {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    clench_formats::load(models.join(name)).expect("a model of the repository")
}

pub(crate) fn elliptic() -> RigidOptions {
    RigidOptions::new().friction_cone(FrictionCone::Elliptic)
}
