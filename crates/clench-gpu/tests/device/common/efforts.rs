//! The number of iterations that solves take on the device and on the processor.

use super::{Random, convert, general_batch, random_state, text, upload};
use clench_gpu::GpuReal;
use clench_rigid::Sim;

/// The iterations and the evaluations of line searches of some solves.
#[derive(Clone, Copy, Debug, Default)]
pub struct Effort {
    pub iterations: usize,
    pub evaluations: usize,
}

/// Asserts that the solves of random states of a model take as many iterations and evaluations as on the processor,
/// within two and a fraction of their sums; returns the latter. The kernels are a second text of the solver: a change
/// of one alone shows here.
pub fn efforts_agree<S: GpuReal>(file: &str, option: &str, fraction: f64) -> Option<Effort> {
    // The processor counts the iterations of islands separately.
    let flag = "<option><flag island='disable'/></option>\n<worldbody>";
    let file = file.replace("<option ", &format!("<option {option} "));
    let model = text(&file.replace("<worldbody>", flag));
    let mut random = Random::new(7);
    let states = Vec::from_iter((0..40).map(|_| random_state(&model, &mut random, 0.7)));
    let mut batch = general_batch::<S>(&model, states.len())?;
    upload(&mut batch, &states);
    batch.forward().expect("a device");
    let mut sim = Sim::<S>::new(model.clone()).expect("a good model");
    let [mut found, mut expected] = [Effort::default(); 2];
    for (state, solve) in states.iter().zip(batch.solves().expect("a device")) {
        sim.state = convert(&model, state);
        sim.forward().expect("a good state");
        let stats = sim.stats();
        found.iterations += solve.iterations;
        found.evaluations += solve.ls_evaluations;
        expected.iterations += stats.iterations;
        expected.evaluations += stats.ls_evaluations;
    }
    let near = |found: usize, expected: usize| {
        (found as f64 - expected as f64).abs() <= fraction * expected as f64 + 2.0
    };
    assert!(
        near(found.iterations, expected.iterations)
            && near(found.evaluations, expected.evaluations),
        "{} with {option}: {found:?} on the device, {expected:?} on the processor",
        model.name
    );
    Some(expected)
}
