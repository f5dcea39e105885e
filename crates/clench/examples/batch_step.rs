//! Steps a batch one step a call and prints the time. `bench/calls.py` compares it with the same calls from Python.
//!
//! `cargo run --release -p clench --example batch_step -- MODEL ENVIRONMENTS THREADS STEPS`

use clench::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// The number of steps before the clock starts.
const WARM: usize = 100;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [model, count, threads, steps] = &args[..] else {
        return Err("give MODEL ENVIRONMENTS THREADS STEPS".into());
    };
    let options = BatchOptions {
        threads: Some(threads.parse()?),
        ..BatchOptions::default()
    };
    let mut batch = Batch::<f64>::with_options(Arc::new(load(model)?), count.parse()?, options)?;
    wave(batch.state.qvel.as_mut_slice(), 0.1);
    wave(batch.state.ctrl.as_mut_slice(), 0.5);
    for _ in 0..WARM {
        batch.step()?;
    }
    let start = Instant::now();
    for _ in 0..steps.parse()? {
        batch.step()?;
    }
    let seconds = start.elapsed().as_secs_f64();
    let qpos = batch.state.qpos.as_slice().iter();
    let bits = qpos.fold(0, |bits, x| bits ^ x.to_bits());
    println!("{seconds} {bits}");
    Ok(())
}

/// Fills a slice with reproducible numbers between −`size` and `size`.
fn wave(values: &mut [f64], size: f64) {
    for (i, value) in values.iter_mut().enumerate() {
        *value = size * ((7 * i % 101) as f64 / 50.0 - 1.0);
    }
}
