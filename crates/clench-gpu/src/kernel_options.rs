//! Options with which the kernels of a batch are compiled.

use clench_rigid::model::Model;
use clench_rigid::options::RigidOptions;
use clench_rigid::{Sim, SimError};
use std::sync::Arc;

/// Options of the kernels, besides the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct KernelOptions {
    /// True if they serve any model: they read the layout for its features.
    pub general: bool,
    /// True if the state has slots for constraints that are added at run time.
    pub slots: bool,
    /// The most contacts in an initial state or keyframe of the model, see [`contacts_at_start`].
    pub contacts: usize,
}

/// Returns the most contacts in the initial state and the keyframes of a model. A state that cannot be simulated has
/// none.
///
/// # Errors
/// Returns an error if an option is out of range.
pub(crate) fn contacts_at_start(
    model: &Arc<Model>,
    options: RigidOptions,
) -> Result<usize, SimError> {
    let mut sim = Sim::<f64>::with_options(model.clone(), options)?;
    let count = |sim: &mut Sim<f64>| match sim.forward() {
        Ok(()) => sim.contacts().len(),
        Err(_) => 0,
    };
    let mut most = count(&mut sim);
    for keyframe in 0..model.keyframes.len() {
        sim.reset_to_keyframe(keyframe)?;
        most = most.max(count(&mut sim));
    }
    Ok(most)
}
